// True poses for tools that compare with them.
#pragma once

#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"

namespace ngram_slam {

constexpr const char* kNoTruth = "has no ground truth: give --reference";

/// The reference poses of a log: of a TUM file, a table with one pose for each scan, or a corrected
/// log (".log", ".log.gz"); without a file the log's own truth, which may be empty.
/// @throws hyselam::InputError
inline std::vector<hyselam::StampedPose2> referenceOf(const std::string& path,
                                                      const hyselam::RobotLog& log) {
  if (path.empty()) return log.ground_truth;
  if (path.find(".log") != std::string::npos) return hyselam::readRobotLog(path).odometry;
  hyselam::PoseFile file = hyselam::readPoses(path);
  for (std::size_t i = 0; file.one_per_scan && i < file.poses.size() && i < log.scans.size(); ++i) {
    file.poses[i].stamp = log.scans[i].stamp;  // its times may be another clock's
  }
  return file.poses;
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
  /// referenceOf() the `i`-th log.
  std::vector<hyselam::StampedPose2> of(std::size_t i, const hyselam::RobotLog& log) const {
    return referenceOf(paths.empty() ? "" : paths[i], log);
  }
};

}  // namespace ngram_slam
