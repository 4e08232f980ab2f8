// True poses for tools that compare with them.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"

namespace ngram_slam {

constexpr const char* kNoTruth = "has no ground truth: give --reference";

/// Reference poses, and which of them were estimated (PoseFile::estimated).
struct Reference {
  std::vector<hyselam::StampedPose2> poses;
  std::vector<bool> estimated;  ///< empty: all were
};

/// The reference poses of a log: of a TUM file, a table with one pose for each scan, or a corrected
/// log (".log", ".log.gz"); without a file the log's own truth, which may be empty.
/// @throws hyselam::InputError
inline Reference readReference(const std::string& path, const hyselam::RobotLog& log) {
  if (path.empty()) return {log.ground_truth, {}};
  if (path.find(".log") != std::string::npos) return {hyselam::readRobotLog(path).odometry, {}};
  hyselam::PoseFile file = hyselam::readPoses(path);
  for (std::size_t i = 0; file.one_per_scan && i < file.poses.size() && i < log.scans.size(); ++i) {
    file.poses[i].stamp = log.scans[i].stamp;  // its times may be another clock's
  }
  return {std::move(file.poses), std::move(file.estimated)};
}
inline std::vector<hyselam::StampedPose2> referenceOf(const std::string& path,
                                                      const hyselam::RobotLog& log) {
  return readReference(path, log).poses;
}

/// The reference with the headings between estimates as scans tell them: that of the nearest
/// estimate, turned as much as `path` (of SLAM) turned since. Raw odometry's, which the tables have
/// there, slip by 15 to 27 degrees in a turn. Positions stay, and headings of which `path` tells
/// nothing.
inline std::vector<hyselam::StampedPose2> withTurnsOf(
    const std::vector<hyselam::StampedPose2>& path, const Reference& reference) {
  constexpr double kTolerance = 0.2;  // [s]
  std::vector<hyselam::StampedPose2> poses = reference.poses;
  std::vector<std::size_t> estimates;
  for (std::size_t i = 0; i < reference.estimated.size(); ++i) {
    if (reference.estimated[i]) estimates.push_back(i);
  }
  for (std::size_t i = 0, e = 0; i < reference.estimated.size() && !estimates.empty(); ++i) {
    const auto away = [&](std::size_t n) {
      return std::abs(poses[estimates[n]].stamp - poses[i].stamp);
    };
    while (e + 1 < estimates.size() && away(e + 1) < away(e)) ++e;
    const auto here = hyselam::poseAt(path, poses[i].stamp, kTolerance);
    const auto there = hyselam::poseAt(path, poses[estimates[e]].stamp, kTolerance);
    if (reference.estimated[i] || !here || !there) continue;
    poses[i].pose.theta = hyselam::normalizeAngle(reference.poses[estimates[e]].pose.theta +
                                                  here->theta - there->theta);
  }
  return poses;
}

/// The option --reference of tools that read several logs: a file for each of them, or none at all.
struct ReferenceFiles {
  std::vector<std::string> paths;

  void addTo(CLI::App& app, const std::string& what = "true poses of each log") {
    app.add_option("--reference", paths,
                   what +
                       " (TUM, a table with one pose for each scan, or a corrected log); "
                       "default: the logs' ground truth");
  }
  /// Before any log is read. @throws hyselam::ParameterError
  void check(std::size_t logs) const {
    if (!paths.empty() && paths.size() != logs) {
      throw hyselam::ParameterError("--reference", paths.size(), "one file for each log");
    }
  }
  Reference read(std::size_t i, const hyselam::RobotLog& log) const {
    return readReference(paths.empty() ? "" : paths[i], log);
  }
  /// referenceOf() the `i`-th log.
  std::vector<hyselam::StampedPose2> of(std::size_t i, const hyselam::RobotLog& log) const {
    return read(i, log).poses;
  }
};

}  // namespace ngram_slam
