#include "ngram_slam/ros/slam_parameters.hpp"

#include <sys/stat.h>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::ParameterError;
using hyselam::ParamLoader;
using hyselam::Range;

namespace {

void loadSlam(ParamLoader& loader, SlamParams& p) {
  loader.getEnum<SlamLoops>("loops", p.loops,
                            {{"none", SlamLoops::kNone},
                             {"proximity", SlamLoops::kProximity},
                             {"ngrams", SlamLoops::kNgrams},
                             {"all", SlamLoops::kAll},
                             {"thesis", SlamLoops::kThesis}},
                            "which places are taken to be places seen before");
  loader.get("refine_odometry", p.refine_odometry, "scans against what was seen last");
  loader.get("max_range", p.surface.max_range, Range::above(0.0),
             "[m] farther returns do not count");
  loader.get("keyframe_step", p.keyframe_step, Range::above(0.0), "[m] between keyframes");
  loader.get("keyframe_turn", p.keyframe_turn, Range::above(0.0), "[rad] between keyframes");
  loader.get("odometry_noise", p.odometry.per_metre, Range::atLeast(0.0),
             "deviation of the position [m per m driven]");
  loader.get("odometry_turn_noise", p.odometry.turn_per_turn, Range::atLeast(0.0),
             "deviation of the heading [rad per rad turned]");
  loader.get("longest_step", p.longest_step, Range::above(0.0),
             "[m] between two scans; more is a leap of the odometry");
  loader.get("optimise_every", p.optimise_every, Range::between(1, 1e6),
             "keyframes between optimisations when there are new loops");
  p.validate();
}

void loadMap(ParamLoader& loader, SlamServerParams& p) {
  loader.get("resolution", p.map.resolution, Range::between(0.01, 1.0), "[m/cell] of the map");
  loader.get("usable_range", p.map.usable_range, Range::above(0.0),
             "[m] farther returns clear the beam up to here only");
  loader.get("occupied_ratio", p.map.occupied_ratio, {0.0, 1.0, true, true},
             "hits / (hits + misses) of an occupied cell");
  int cells = 50000000;
  loader.get("max_map_cells", cells, Range::between(1, 1e9), "growth beyond is refused");
  p.map.max_cells = static_cast<std::size_t>(cells);
  loader.get("map_update_interval", p.map_update_interval, Range::atLeast(0.0),
             "[s] of the data between maps; 0: none is drawn");
}

void loadState(ParamLoader& loader, SlamServerParams& p) {
  loader.get("state", p.state, "file gone on with at the start and saved; empty: none");
  struct stat info {};
  const auto slash = p.state.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : p.state.substr(0, slash + 1);
  if (!p.state.empty() && (::stat(folder.c_str(), &info) != 0 || !S_ISDIR(info.st_mode)))
    throw ParameterError("state", p.state, "a file in an existing folder");
  loader.get("save_period", p.save_period, Range::between(0.0, 1e6),
             "[s] of wall time between savings; 0: only at the end and when asked");
  loader.get("start_window", p.start_window, {0.0, SlamEngine::kMaxStartWindow, true, false},
             "[m] searched around the pose where a run starts in a known map");
  loader.get("start_turn", p.start_turn, Range::between(0.0, hyselam::kPi), "[rad]");
  const bool given = loader.isSet("initial_pose_x") || loader.isSet("initial_pose_y") ||
                     loader.isSet("initial_pose_a");
  hyselam::Pose2 pose;
  for (const char* name : {"initial_pose_x", "initial_pose_y", "initial_pose_a"}) loader.know(name);
  if (!given) return;
  loader.get("initial_pose_x", pose.x, Range::between(-1e6, 1e6), "[m]");
  loader.get("initial_pose_y", pose.y, Range::between(-1e6, 1e6), "[m]");
  loader.get("initial_pose_a", pose.theta, Range::between(-1e3, 1e3), "[rad]");
  pose.theta = hyselam::normalizeAngle(pose.theta);
  p.initial_pose = {pose, {p.start_window / 2.0, p.start_window / 2.0, p.start_turn / 2.0}};
}

}  // namespace

SlamServerParams loadSlamParams(ParamLoader& loader) {
  SlamServerParams p;
  hyselam::loadScanInputParams(loader, p.input);
  loader.get("global_frame_id", p.global_frame_id, "frame of the map");
  if (p.global_frame_id.empty() || p.global_frame_id == p.input.odom_frame_id)
    throw ParameterError("global_frame_id", "'" + p.global_frame_id + "'",
                         "a name other than odom_frame_id");
  loadSlam(loader, p.slam);
  loadMap(loader, p);
  loader.get("tf_broadcast", p.tf_broadcast, "map -> odom to tf");
  loader.get("transform_publish_period", p.transform_publish_period, Range::between(0.0, 10.0),
             "[s] of wall time between transforms; 0: at scans only");
  loader.get("transform_tolerance", p.transform_tolerance, Range::between(0.0, 10.0),
             "[s] map -> odom is dated into the future");
  loadState(loader, p);
  p.semantic.validate();
  loader.get("diagnostic_period", p.diagnostic_period, Range::between(0.05, 60.0), "[s]");
  return p;
}

}  // namespace ngram_slam
