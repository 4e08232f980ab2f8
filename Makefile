# Thin: each target calls one script, which explains itself at its top.
.DEFAULT_GOAL := build
.PHONY: deps build deb demo demo-localization docs test bench lint sanitize install clean

deps:     ; @scripts/deps
build:    ; @scripts/build
deb:      ; @scripts/deb
demo:     ; @scripts/demo
demo-localization: ; @scripts/demo_localization
test:     ; @scripts/test
docs:     ; @scripts/docs
bench:    ; @scripts/build benchmarks && bench/run --json out/bench.json
lint:     ; @scripts/lint
sanitize: ; @scripts/sanitize address
install:  ; @scripts/build install
clean:    ; rm -rf build build_address build_thread build_fuzz build_docs build_deb devel install out
