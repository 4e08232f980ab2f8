#include "hyselam_common/ros/scan_input_params.hpp"

namespace hyselam {

void describeFrame(ParameterVisitor& visit, const std::string& name, std::string& frame,
                   const std::string& meaning) {
  visit(name, frame, meaning);
  if (!frame.empty() && frame[0] == '/') frame.erase(0, 1);
}

void checkFrame(const std::string& name, const std::string& frame) {
  if (frame.empty()) throw ParameterError(name, "''", "the name of a frame");
}

void ScanInputParams::describe(ParameterVisitor& visit) {
  describeFrame(visit, "odom_frame_id", odom_frame_id, "frame in which the robot moves smoothly");
  describeFrame(visit, "base_frame_id", base_frame_id, "frame of the robot");
  visit("transform_wait", transform_wait, Range::between(0.0, 60.0), "s",
        "a scan waits this long for its odometry, in wall time and in simulated time");
  visit("scan_queue_size", queue_size, Range::between(1, 100000), "",
        "scans that may wait; the oldest is dropped first");
}

void ScanInputParams::validate() const {
  checkParameters(*this);
  checkFrame("odom_frame_id", odom_frame_id);
  checkFrame("base_frame_id", base_frame_id);
  if (odom_frame_id == base_frame_id) {
    throw ParameterError("base_frame_id", base_frame_id, "another frame than odom_frame_id");
  }
}

void loadScanInputParams(ParamLoader& loader, ScanInputParams& params) {
  loader.group("", params);
  params.validate();
}

}  // namespace hyselam
