// Made-up robots in made-up buildings, and what SLAM makes of them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "hyselam_common/robot_log.hpp"
#include "looped_corridors.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

/// A robot's round through corridors; its odometry begins somewhere.
inline hyselam::RobotLog visit(std::uint64_t building, std::uint64_t seed,
                               const hyselam::Pose2& begin) {
  const auto made = loopedCorridors(building, 3, 9);
  auto params = atScanRate(4.0);
  params.odometry.sigma = 0.02;
  hyselam::RobotLog log = hyselam_sim::simulate(made.plan, made.route, seed, params).log;
  for (hyselam::StampedPose2& p : log.odometry) p.pose = begin * p.pose;
  return log;
}

/// Two robots in one building, one in another.
struct ThreeVisits {
  hyselam::RobotLog first = visit(5, 3, {}), second = visit(5, 4, {30.0, -7.0, 2.5}),
                    other = visit(11, 5, {5.0, 5.0, 1.0});
};

/// Adds the scans [begin, end) of the log.
inline void feed(SlamEngine* engine, const hyselam::RobotLog& log, std::size_t begin,
                 std::size_t end) {
  for (std::size_t i = begin; i < std::min(end, log.scans.size()); ++i) {
    engine->add(log.scans[i], *hyselam::poseAt(log.odometry, log.scans[i].stamp, 1.0));
    while (const auto job = engine->takeJob()) engine->apply(runJob(*job));
  }
}

/// Adds the scans of a part of the log, 0..1.
inline void drive(const hyselam::RobotLog& log, double from, double to, SlamEngine* engine) {
  const auto n = static_cast<double>(log.scans.size());
  feed(engine, log, static_cast<std::size_t>(from * n), static_cast<std::size_t>(to * n));
}

inline void finish(SlamEngine* engine) {
  engine->endRun();
  while (const auto job = engine->takeFinalJob()) engine->apply(runJob(*job));
}

inline SlamState mapOf(const hyselam::RobotLog& log, double from, double to) {
  SlamEngine engine;
  drive(log, from, to, &engine);
  finish(&engine);
  return engine.state();
}

}  // namespace ngram_slam
