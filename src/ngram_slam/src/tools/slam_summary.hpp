// What slam_offline tells of a run: the parts of summary.json.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/carmen_log.hpp"
#include "hyselam_common/pose2.hpp"
#include "ngram_slam/slam/laser_mount.hpp"
#include "slam_run.hpp"

namespace ngram_slam {

/// What there is, what it cost, how the places were seen again. `log_seconds`: as long as the
/// recording is [s].
nlohmann::json summaryOf(const SlamRun& run, double log_seconds);

/// Errors of the recording's own poses, and of the loops and matches that are false.
nlohmann::json errorOf(const SlamRun& run, const std::vector<hyselam::StampedPose2>& reference);

/// `corrected`: the recording was mapped again with the laser where it is.
nlohmann::json toJson(const std::optional<LaserMount>& mount, bool corrected);

/// What makes the map doubtful, in sentences; none for a run that went well.
nlohmann::json troubleOf(const SlamRun& run, const std::optional<LaserMount>& mount,
                         bool corrected);

/// What could not be taken of the log, in a sentence; empty if all could.
std::string troubleOf(const std::vector<hyselam::CarmenIssue>& issues);

}  // namespace ngram_slam
