// Made-up robots in made-up buildings, and what SLAM makes of them.
#pragma once

#include <cstdint>

#include "hyselam_common/robot_log.hpp"
#include "hyselam_sim/generate_corridors.hpp"
#include "hyselam_sim/simulation.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

/// A robot's round through corridors; its odometry begins somewhere.
inline hyselam::RobotLog visit(std::uint64_t building, std::uint64_t seed,
                               const hyselam::Pose2& begin) {
  hyselam_sim::CorridorParams corridors;
  corridors.lines = 3;
  corridors.loops = 1.0;
  corridors.legs = 9;
  const auto made = hyselam_sim::generateCorridors(building, corridors);
  hyselam_sim::SimulationParams params;
  params.scan_rate = 4.0;
  params.odometry.sigma = 0.02;
  hyselam::RobotLog log = hyselam_sim::simulate(made.plan, made.route, seed, params).log;
  for (hyselam::StampedPose2& p : log.odometry) p.pose = begin * p.pose;
  return log;
}

/// Adds the scans of a part of the log, 0..1.
inline void drive(const hyselam::RobotLog& log, double from, double to, SlamEngine* engine) {
  const auto n = static_cast<double>(log.scans.size());
  for (auto i = static_cast<std::size_t>(from * n); i < static_cast<std::size_t>(to * n); ++i) {
    engine->add(log.scans[i], *hyselam::poseAt(log.odometry, log.scans[i].stamp, 1.0));
    while (const auto job = engine->takeJob()) engine->apply(runJob(*job));
  }
}

inline SlamState mapOf(const hyselam::RobotLog& log, double from, double to) {
  SlamEngine engine;
  drive(log, from, to, &engine);
  engine.endRun();
  while (const auto job = engine.takeFinalJob()) engine.apply(runJob(*job));
  return engine.state();
}

}  // namespace ngram_slam
