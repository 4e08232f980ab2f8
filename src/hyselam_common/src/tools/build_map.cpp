// build_map LOG_OR_BAG OUT.yaml --poses ...: a grid map from scans with known poses.
#include <iostream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/occupancy_mapper.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/report_issues.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"

namespace {

constexpr double kPoseTolerance = 0.05;  // a scan this much outside of the trajectory's time [s]

hyselam::PoseFile findPoses(const std::string& source, const std::string& in,
                            const hyselam::RobotLog& log) {
  if (source == "odometry") return {log.odometry, false, {}};
  if (source == "ground_truth") {
    if (log.ground_truth.empty()) throw hyselam::InputError(in, "", "holds no ground truth");
    return {log.ground_truth, false, {}};
  }
  hyselam::PoseFile poses = hyselam::readPoses(source);
  if (poses.one_per_scan && poses.poses.size() != log.scans.size()) {
    throw hyselam::InputError(source, "",
                              "has " + std::to_string(poses.poses.size()) + " poses for " +
                                  std::to_string(log.scans.size()) + " scans of " + in);
  }
  return poses;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Builds a grid map (map_server's YAML and PGM) from a log whose poses are known.",
               "build_map");
  std::string in, out, pose_source;
  hyselam::OccupancyMapperParams parameters;
  hyselam::BagOptions bag;
  app.option_defaults()->always_capture_default();
  app.add_option("LOG", in, "CARMEN log or bag, plain or gzip")->required();
  app.add_option("OUT", out, "map to write (NAME.yaml; NAME.pgm goes beside it)")->required();
  app.add_option("--poses", pose_source,
                 "odometry, ground_truth (both of the log), a TUM trajectory, or a reference table "
                 "with one pose per scan")
      ->required();
  app.add_option("--resolution", parameters.resolution, "side of a cell [m]");
  app.add_option("--usable-range", parameters.usable_range,
                 "returns farther away only clear the beam up to here [m]");
  app.add_option("--no-return-clears", parameters.no_return_clears,
                 "how far a beam without return clears [m]");
  app.add_option("--occupied-ratio", parameters.occupied_ratio,
                 "share of hits above which a cell is occupied");
  app.add_option("--min-observations", parameters.min_observations,
                 "cells seen less often stay unknown");
  hyselam::addBagOptions(app, &bag);

  return hyselam::runTool(argc, argv, app, [&] {
    hyselam::OccupancyMapper mapper(parameters);
    std::vector<hyselam::CarmenIssue> issues;
    bag.odometry_required = pose_source == "odometry";
    const hyselam::RobotLog log = hyselam::readRobotLog(in, bag, {}, &issues);
    hyselam::reportIssues(in, issues);
    const hyselam::PoseFile poses = findPoses(pose_source, in, log);

    std::size_t without_pose = 0;
    {
      hyselam::Progress progress("mapping", log.scans.size());
      for (std::size_t i = 0; i < log.scans.size(); ++i) {
        progress.update(i);
        const auto pose = poses.one_per_scan
                              ? std::optional<hyselam::Pose2>(poses.poses[i].pose)
                              : hyselam::poseAt(poses.poses, log.scans[i].stamp, kPoseTolerance);
        if (pose) {
          mapper.insert(*pose, log.scans[i]);
        } else {
          ++without_pose;
        }
      }
    }
    if (mapper.scanCount() == 0) {
      throw hyselam::InputError(in, "", "no scan falls into the time of " + pose_source);
    }
    const hyselam::OccupancyGrid grid = mapper.grid();
    hyselam::saveMap(out, grid);
    std::cout << in << ": " << mapper.scanCount() << " scans (" << without_pose
              << " without a pose) -> " << out << ", " << grid.geometry.width << " x "
              << grid.geometry.height << " cells of " << grid.geometry.resolution << " m\n";
    return nlohmann::json{
        {"scans", mapper.scanCount()},    {"without_pose", without_pose},
        {"skipped", issues.size()},       {"width", grid.geometry.width},
        {"height", grid.geometry.height}, {"resolution", grid.geometry.resolution}};
  });
}
