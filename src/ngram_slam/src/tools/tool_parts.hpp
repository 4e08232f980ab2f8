// What the offline tools have in common.
#pragma once

#include <sys/resource.h>

#include "hyselam_common/occupancy_mapper.hpp"
#include "ngram_slam/slam/present_map.hpp"

namespace ngram_slam {

/// Of this process and its threads, since it began [s].
inline double cpuSeconds() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(use.ru_utime) + seconds(use.ru_stime);
}

/// @throws hyselam::ParameterError
inline PresentMap emptyMap(double resolution, const PresentMapParams& params = {}) {
  hyselam::OccupancyMapperParams p;
  p.resolution = resolution;
  return PresentMap(p, params);
}

}  // namespace ngram_slam
