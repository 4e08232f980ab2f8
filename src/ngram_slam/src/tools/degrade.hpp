// What makes a recording worse, on purpose: odometry with errors, wheels that stand still in it,
// scans that are missing, a laser that tf has in the wrong place.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/robot_log.hpp"

namespace ngram_slam {

/// Options of a program, as text; empty: nothing is changed.
struct Degradation {
  std::string freeze, gap, laser_error;
  int every = 1;
};

inline void addDegradationOptions(CLI::App& app, Degradation* d) {
  app.add_option("--freeze-odometry", d->freeze,
                 "EVERY,FOR: every EVERY seconds the odometry tells no motion for FOR seconds, and "
                 "goes on from there");
  app.add_option("--gap", d->gap,
                 "EVERY,FOR: every EVERY seconds scans and odometry are missing for FOR seconds");
  app.add_option("--every", d->every, "only every so many-th scan");
  app.add_option("--laser-error", d->laser_error,
                 "X,Y,DEGREES: where the laser is said to be mounted is wrong by this [m, deg]");
}

/// Numbers between commas. @throws hyselam::InputError unless there are `count` finite ones.
inline std::vector<double> numbersOf(const std::string& option, const std::string& text,
                                     std::size_t count) {
  std::vector<double> numbers;
  std::istringstream in(text);
  double number = 0.0;
  char comma = ',';
  while (comma == ',' && in >> number) {
    numbers.push_back(number);
    comma = 0;
    in >> comma;
  }
  const bool finite =
      std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
  if (numbers.size() != count || !finite || comma != 0) {
    throw hyselam::InputError(option, text,
                              "is not " + std::to_string(count) + " numbers between commas");
  }
  return numbers;
}

/// Seconds of trouble that come again and again.
class Again {
 public:
  /// `begin`: of the recording. @throws hyselam::InputError
  Again(const std::string& option, const std::string& text, double begin) : begin_(begin) {
    const std::vector<double> n = numbersOf(option, text, 2);
    every_ = n[0];
    for_ = n[1];
    if (!(for_ > 0.0 && every_ > for_)) {
      throw hyselam::InputError(option, text, "needs EVERY above FOR above 0");
    }
  }
  /// The first of them begins after `every`.
  bool covers(double stamp) const {
    const double t = stamp - begin_;
    return t >= every_ && std::fmod(t, every_) < for_;
  }

 private:
  double begin_, every_, for_;
};

inline void freezeOdometry(const Again& trouble, std::vector<hyselam::StampedPose2>* odometry) {
  hyselam::Pose2 last, told;
  for (std::size_t i = 0; i < odometry->size(); ++i) {
    hyselam::StampedPose2& o = (*odometry)[i];
    const hyselam::Pose2 pose = o.pose;
    if (i == 0) {
      told = pose;
    } else if (!trouble.covers(o.stamp)) {
      told = told * between(last, pose);
    }
    last = pose;
    o.pose = told;
  }
}

/// Adds errors to each motion: standard deviations of `factor` times 1 % of the distance in both
/// directions, and of 1 % of the rotation and 0.01 rad a meter in heading.
inline void addOdometryNoise(double factor, std::uint64_t seed,
                             std::vector<hyselam::StampedPose2>* odometry) {
  hyselam::Rng rng(seed);
  hyselam::Pose2 last, noisy;
  for (std::size_t i = 0; i < odometry->size(); ++i) {
    hyselam::Pose2& pose = (*odometry)[i].pose;
    if (i == 0) {
      last = noisy = pose;
      continue;
    }
    hyselam::Pose2 step = between(last, pose);
    last = pose;
    const double distance = std::hypot(step.x, step.y), angle = std::abs(step.theta);
    // White along the path: variances of steps add up to that of a meter.
    const double stddev = 0.01 * factor * std::sqrt(distance);
    step.x += rng.gaussian(0.0, stddev);
    step.y += rng.gaussian(0.0, stddev);
    step.theta += rng.gaussian(0.0, stddev + 0.01 * factor * angle);
    noisy = noisy * step;
    pose = noisy;
  }
}

/// @throws hyselam::InputError for options that cannot be used.
inline void degrade(const Degradation& d, hyselam::RobotLog* log) {
  if (d.every < 1) {
    throw hyselam::InputError("--every", std::to_string(d.every), "is not 1 or more");
  }
  const auto span = hyselam::timeSpan(*log);
  const double begin = span ? span->begin : 0.0;
  if (!d.freeze.empty())
    freezeOdometry(Again("--freeze-odometry", d.freeze, begin), &log->odometry);
  if (!d.gap.empty()) {
    const Again missing("--gap", d.gap, begin);
    const auto remove = [&](auto* items) {
      items->erase(std::remove_if(items->begin(), items->end(),
                                  [&](const auto& item) { return missing.covers(item.stamp); }),
                   items->end());
    };
    remove(&log->scans);
    remove(&log->odometry);
  }
  if (d.every > 1) {
    std::vector<hyselam::LaserScan> kept;
    for (std::size_t i = 0; i < log->scans.size(); i += static_cast<std::size_t>(d.every)) {
      kept.push_back(log->scans[i]);
    }
    log->scans = std::move(kept);
  }
  if (!d.laser_error.empty()) {
    const std::vector<double> n = numbersOf("--laser-error", d.laser_error, 3);
    for (hyselam::LaserScan& scan : log->scans) {
      hyselam::Pose2& mount = scan.laser_in_base;
      mount = {mount.x + n[0], mount.y + n[1],
               hyselam::normalizeAngle(mount.theta + n[2] * hyselam::kPi / 180.0)};
    }
  }
}

}  // namespace ngram_slam
