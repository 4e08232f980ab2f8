# HySeLAM on Ubuntu 20.04 with ROS Noetic. NOT RUN YET: written from the names of the packages. From the top of the checkout:
#   docker build --pull -f docker/noetic.Dockerfile -t hyselam:noetic .
#   docker run --rm hyselam:noetic            # make test
#   docker run --rm -it hyselam:noetic bash
# --pull: an image of before June 2025 has a key for ROS's packages that has expired.
FROM ros:noetic-ros-base-focal
SHELL ["/bin/bash", "-c"]
ENV DEBIAN_FRONTEND=noninteractive LANG=C.UTF-8

WORKDIR /opt/hyselam
# Focal has no package of CLI11, and scripts/deps asks for it: headers only.
RUN apt-get update && apt-get install -y --no-install-recommends build-essential cmake curl git make && rm -rf /var/lib/apt/lists/* && \
    curl -fsSL https://github.com/CLIUtils/CLI11/archive/refs/tags/v2.1.2.tar.gz | tar -xz -C /tmp && \
    cmake -S /tmp/CLI11-2.1.2 -B /tmp/cli11 -DCLI11_BUILD_TESTS=OFF -DCLI11_BUILD_EXAMPLES=OFF && cmake --install /tmp/cli11
# The packages by themselves, so that a changed source does not install them again.
COPY scripts/deps scripts/env.sh scripts/
RUN apt-get update && scripts/deps && rm -rf /var/lib/apt/lists/*

COPY . .
RUN SKIP_DEPS=1 scripts/build all tests benchmarks
CMD ["env", "SKIP_DEPS=1", "make", "test"]
