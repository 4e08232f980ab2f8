// Parameters that every server with a laser has, and their reading from the parameter server.
#pragma once

#include <string>

#include "hyselam_common/ros/params.hpp"

namespace hyselam {

/// Frames of the robot, and how scans wait for their transforms (see ScanInput).
struct ScanInputParams {
  std::string odom_frame_id = "odom";       ///< frame in which the robot moves smoothly
  std::string base_frame_id = "base_link";  ///< frame of the robot
  double transform_wait = 0.5;              ///< a scan waits at most this long for its odometry [s]
  int queue_size = 100;                     ///< scans that may wait; the oldest is dropped first

  /// odom_frame_id, base_frame_id, transform_wait and scan_queue_size.
  void describe(ParameterVisitor& visit);
  /// @throws ParameterError naming the first value out of range; the frames must differ.
  void validate() const;
};

/// Reads and checks them. @throws ParameterError. Nothing is logged.
void loadScanInputParams(ParamLoader& loader, ScanInputParams& params);

/// The name of a frame; a leading slash is taken away, as tf2 wants it.
void describeFrame(ParameterVisitor& visit, const std::string& name, std::string& frame,
                   const std::string& meaning);
/// @throws ParameterError for an empty name.
void checkFrame(const std::string& name, const std::string& frame);

}  // namespace hyselam
