// What peers of word matching compare: places along the way with the scan made there and the points
// of the local map around them.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>
#include <utility>
#include <vector>

#include "hyselam_common/robot_log.hpp"
#include "polar_context.hpp"

namespace ngram_slam_peers {

struct Station {
  double stamp = 0.0;
  hyselam::LaserScan scan;
  std::vector<hyselam::Point2> points;  ///< in the robot's frame there
};

constexpr double kContextRange = 10.0;  ///< of the polar context of a station [m]

struct StationParams {
  double stride = 2.0;       ///< of way between stations [m]: 20 steps of 0.1 m (5.3.2)
  double radius = 4.0;       ///< of the local map [m]
  double memory = 4.0;       ///< way that the local map remembers [m]
  std::size_t points = 150;  ///< of a station (5.3.2)
};

/// A scan of the local map, and the pose at which it was made.
struct Seen {
  double way;
  hyselam::Pose2 pose;
  const hyselam::LaserScan* scan;
};

/// What the scans of the local map saw around `pose`, in its frame.
template <typename Scans>
std::vector<hyselam::Point2> pointsAround(const hyselam::Pose2& pose, const Scans& scans,
                                          const StationParams& params) {
  std::vector<hyselam::Point2> points;
  std::set<std::pair<int, int>> cells;  // of 0.1 m, so that near walls do not count more
  for (const Seen& seen : scans) {
    const hyselam::Pose2 relative = hyselam::between(pose, seen.pose);
    for (const hyselam::Point2& p : returnsOf(*seen.scan)) {
      const hyselam::Point2 q = relative * p;
      if (std::hypot(q.x, q.y) > params.radius) continue;
      if (cells.emplace(std::lround(q.x * 10), std::lround(q.y * 10)).second) points.push_back(q);
    }
  }
  // Evenly from all of them.
  const std::size_t all = points.size();
  if (all > params.points) {
    for (std::size_t i = 0; i < params.points; ++i) points[i] = points[i * all / params.points];
    points.resize(params.points);
  }
  return points;
}

inline std::vector<Station> stationsOf(const hyselam::RobotLog& log, const StationParams& params) {
  std::deque<Seen> recent;
  std::vector<Station> stations;
  double way = 0.0, due = 0.0;
  for (const hyselam::LaserScan& scan : log.scans) {
    const auto pose = hyselam::poseAt(log.odometry, scan.stamp, 0.2);
    if (!pose) continue;
    if (!recent.empty()) way += hyselam::distance(recent.back().pose, *pose);
    recent.push_back({way, *pose, &scan});
    while (way - recent.front().way > params.memory) recent.pop_front();
    if (way < due) continue;
    due = way + params.stride;
    stations.push_back({scan.stamp, scan, pointsAround(*pose, recent, params)});
  }
  return stations;
}

}  // namespace ngram_slam_peers
