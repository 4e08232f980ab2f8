// One program for each target: -DHYSELAM_FUZZ_TARGET=NAME.
#include "targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ngram_slam::fuzz::HYSELAM_FUZZ_TARGET(data, size);
  return 0;
}
