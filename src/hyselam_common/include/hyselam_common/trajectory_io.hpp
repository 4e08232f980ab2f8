// Trajectories as text: the TUM format and the reference tables of published laser logs.
#pragma once

#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"

namespace hyselam {

/// Reads `stamp x y z qx qy qz qw` per line; '#' starts a comment; plain or gzip. z, roll and pitch
/// are dropped. @throws InputError, naming the line, for anything else, for a quaternion that is
/// far from unit length (more than 1 %), and for a file without poses.
std::vector<StampedPose2> readTum(const std::string& path);

/// Writes the TUM format (z, roll and pitch 0; stamps with 9, values with 9 digits after the
/// point), replacing the file at once. @throws InputError if it cannot be written.
void writeTum(const std::string& path, const std::vector<StampedPose2>& trajectory);

/// Reads a table `scan_index ipc_timestamp monotone_timestamp x y theta ...`, one line per scan of
/// a log, indices 0, 1, 2, ...; stamps are the monotone ones. Plain or gzip. @throws InputError,
/// naming the line.
std::vector<StampedPose2> readReferenceTable(const std::string& path);

/// Reads either format; a comment that names the column `scan_index` marks a reference table.
struct PoseFile {
  std::vector<StampedPose2> poses;
  bool one_per_scan = false;  ///< a reference table: pose i belongs to scan i
  /// By pose, of a table with the column `is_rbpf_update`: whether it was estimated. Between these
  /// lie poses of raw odometry, whose headings may be off by tens of degrees. Empty: all were.
  std::vector<bool> estimated;
};
PoseFile readPoses(const std::string& path);

}  // namespace hyselam
