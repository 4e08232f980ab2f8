// A robot drives 6 m along a hall; its odometry is 5 % too long. SLAM corrects it by the scans.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ngram_slam/slam/slam_engine.hpp"

/// What a laser on the middle line of a hall of 12 m by 6 m sees, x meters from its end.
hyselam::LaserScan scanAt(double x, double stamp) {
  hyselam::LaserScan scan;
  scan.stamp = stamp;
  scan.angle_min = -hyselam::kPi;
  scan.angle_increment = hyselam::radians(1.0);
  scan.range_max = 30.0;
  for (int i = 0; i < 360; ++i) {
    const double angle = scan.angle_min + i * scan.angle_increment;
    const double along = ((std::cos(angle) > 0.0 ? 12.0 : 0.0) - x) / std::cos(angle);
    const double across = 3.0 / std::abs(std::sin(angle));
    scan.ranges.push_back(static_cast<float>(std::min(along, across)));
  }
  return scan;
}

int main() {
  ngram_slam::SlamEngine engine;
  double odometry = 0.0;
  for (int i = 0; i <= 60; ++i) {
    odometry = 1.05 * 0.1 * i;
    engine.add(scanAt(2.0 + 0.1 * i, i), {odometry, 0.0, 0.0});
    while (const auto job = engine.takeJob()) engine.apply(runJob(*job));  // loops, optimization
  }
  std::printf("odometry %.1f m\nSLAM %.1f m\n", odometry, engine.pose().x);
  return 0;
}
