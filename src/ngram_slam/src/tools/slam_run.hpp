// One recording through SLAM, from the first scan to the last loop.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/robot_log.hpp"
#include "ngram_slam/slam/laser_mount.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "slam_offline_options.hpp"

namespace ngram_slam {

/// What SLAM made of a recording, and what is not of the recording in it.
struct SlamRun {
  std::unique_ptr<SlamEngine> engine;
  std::size_t saved_scans = 0, saved_keyframes = 0;  ///< of the map that it goes on with
  std::uint64_t saved_counts = 0;                    ///< scans that it has counted
  std::size_t without_odometry = 0, refused = 0;     ///< scans
  double cpu = 0.0;                                  ///< [s]
};

/// The engine that goes on with the map of --state, if there is one.
/// @throws hyselam::InputError
std::unique_ptr<SlamEngine> makeEngine(const SlamOfflineOptions& o, const SlamParams& params);

/// `label`: of the line that tells the progress.
SlamRun runSlam(const hyselam::RobotLog& log, std::unique_ptr<SlamEngine> engine,
                const std::string& label);

/// @throws hyselam::InputError if there is no map in it.
void checkMapped(const SlamRun& run, const std::string& name, std::size_t scans);

/// The poses of the recording's own scans; those of the saved map come before them.
std::vector<hyselam::StampedPose2> ownTrajectory(const SlamRun& run);

/// Where the laser is mounted, by the keyframes of the recording itself.
std::optional<LaserMount> mountOf(const SlamRun& run);

/// The map that the last pose refers to, as it is now.
PresentMap mapOf(const SlamEngine& engine, const SlamOfflineOptions& o);

}  // namespace ngram_slam
