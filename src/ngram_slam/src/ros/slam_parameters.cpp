#include "ngram_slam/ros/slam_parameters.hpp"

#include "drawn_map.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::ParameterError;
using hyselam::Range;

SlamServerParams::SlamServerParams() {
  map.max_cells = kMostMapCells;
}

void SlamServerParams::describe(hyselam::ParameterVisitor& visit) {
  visit("global_frame_id", global_frame_id, "frame of the map");
  visit.group("", slam);
  visit("loop_wait", loop_wait, Range::between(0.0, 3600.0), "s",
        "wall time that scans wait for loops and optimizations that count (loop_latency); what "
        "takes longer counts when it is done");
  describeDrawnMap(map, visit);
  visit("map_update_interval", map_update_interval, Range::atLeast(0.0), "s",
        "of the data between maps; 0: none is drawn");
  visit("tf_broadcast", tf_broadcast, "map -> odom to tf");
  visit("transform_publish_period", transform_publish_period, Range::between(0.0, 10.0), "s",
        "of wall time between transforms; 0: at scans only");
  visit("transform_tolerance", transform_tolerance, Range::between(0.0, 10.0), "s",
        "map -> odom is dated into the future");
  visit("state", state, "file gone on with at the start and saved; empty: none");
  visit("save_period", save_period, Range::between(0.0, 1e6), "s",
        "of wall time between savings; 0: only at the end and when asked");
  visit("session_path", session_path, Range::atLeast(0.0), "m",
        "driven, after which what the session adds nothing by is dropped and another one goes on: "
        "the map becomes as large as the building; 0: only when it is loaded");
  visit("start_window", start_window, Range::aboveUpTo(0.0, SlamEngine::kMaxStartWindow), "m",
        "searched around the pose where a run starts in a known map");
  visit.renamed("start_turn", "start_angle");
  visit("start_angle", start_angle, Range::between(0.0, hyselam::kPi), "rad",
        "searched around its heading");
  visit("initial_pose_x", initial_pose_x, Range::between(-1e6, 1e6), "m",
        "where the robot starts in a known map");
  visit("initial_pose_y", initial_pose_y, Range::between(-1e6, 1e6), "m", "the same");
  visit("initial_pose_a", initial_pose_a, Range::between(-1e3, 1e3), "rad", "its heading there");
  visit("diagnostic_period", diagnostic_period, Range::between(0.05, 60.0), "s",
        "of wall time between diagnostics");
}

void SlamServerParams::validate() const {
  hyselam::checkParameters(*this);
  slam.validate();
  semantic.validate();
  if (global_frame_id.empty() || global_frame_id == input.odom_frame_id) {
    throw ParameterError("global_frame_id", "'" + global_frame_id + "'",
                         "a name other than odom_frame_id");
  }
  hyselam::checkFolderOfState("state", state);
}

std::optional<hyselam::InitialPose> SlamServerParams::initialPose() const {
  if (!initial_pose_x && !initial_pose_y && !initial_pose_a) return std::nullopt;
  const hyselam::Pose2 pose{initial_pose_x.value_or(0.0), initial_pose_y.value_or(0.0),
                            hyselam::normalizeAngle(initial_pose_a.value_or(0.0))};
  return hyselam::InitialPose{pose, {start_window / 2.0, start_window / 2.0, start_angle / 2.0}};
}

SlamServerParams loadSlamParams(hyselam::ParamLoader& loader) {
  SlamServerParams p;
  hyselam::loadScanInputParams(loader, p.input);
  p.describe(loader);
  p.slam.consolidation.map = p.map;
  p.validate();
  return p;
}

}  // namespace ngram_slam
