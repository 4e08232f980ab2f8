#include "hyselam_common/ros/scan_input_params.hpp"

namespace hyselam {

void loadFrame(ParamLoader& loader, const std::string& name, std::string& frame,
               const std::string& meaning) {
  loader.get(name, frame, meaning);
  if (!frame.empty() && frame[0] == '/') frame.erase(0, 1);  // as tf2 wants it
  if (frame.empty()) throw ParameterError(name, "''", "the name of a frame");
}

void loadScanInputParams(ParamLoader& loader, ScanInputParams& params) {
  loadFrame(loader, "odom_frame_id", params.odom_frame_id,
            "frame in which the robot moves smoothly");
  loadFrame(loader, "base_frame_id", params.base_frame_id, "frame of the robot");
  if (params.odom_frame_id == params.base_frame_id) {
    throw ParameterError("base_frame_id", params.base_frame_id, "another frame than odom_frame_id");
  }
  loader.get("transform_wait", params.transform_wait, Range::between(0.0, 60.0),
             "[s] a scan waits for its odometry");
  loader.get("scan_queue_size", params.queue_size, Range::between(1, 100000),
             "scans that may wait");
}

}  // namespace hyselam
