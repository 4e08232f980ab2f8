# HySeLAM on Ubuntu 20.04 with ROS Noetic. NOT RUN YET: written from the names of the packages. From the top of the checkout:
#   docker build --pull -f docker/noetic.Dockerfile -t hyselam:noetic .
#   docker run --rm hyselam:noetic            # make test
#   docker run --rm -it hyselam:noetic bash
# --pull: an image of before June 2025 has a key for ROS's packages that has expired.
FROM ros:noetic-ros-base-focal
SHELL ["/bin/bash", "-c"]
ENV DEBIAN_FRONTEND=noninteractive LANG=C.UTF-8

WORKDIR /opt/hyselam
# The packages by themselves, so that a changed source does not install them again.
COPY scripts/deps scripts/env.sh scripts/
RUN apt-get update && apt-get install -y --no-install-recommends git make && scripts/deps && rm -rf /var/lib/apt/lists/*

COPY . .
RUN SKIP_DEPS=1 scripts/build all tests benchmarks
CMD ["env", "SKIP_DEPS=1", "make", "test"]
