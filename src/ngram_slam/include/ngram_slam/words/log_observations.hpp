// Observations at equal steps of a recorded path: local map and density kernel over a log.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "hyselam_common/robot_log.hpp"
#include "ngram_slam/words/observation_sensor.hpp"

namespace ngram_slam {

using LogObservationParams = ObservationSensorParams;

/// The observations, and what could not be used.
struct LogObservations {
  std::vector<DensityObservation> observations;
  std::size_t scans_without_odometry = 0;
  std::size_t scans_refused = 0;
};

/// The observations of a log. Where the robot moves further than a step between two scans, stamps,
/// poses and densities in between are interpolated. `progress` gets the number of scans done.
/// @throws hyselam::ParameterError
LogObservations observationsOf(const hyselam::RobotLog& log, const LogObservationParams& params,
                               const std::function<void(std::size_t)>& progress = {});

}  // namespace ngram_slam
