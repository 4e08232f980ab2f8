// find_model MODEL.pcd SCENE.pcd [...]: where in a scene an object is of which a cloud is given, or
// that it is not there.
#include "hyselam_objects/pcl/find_model.hpp"

#include <cstdio>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/pcl/placed_views.hpp"

namespace {

using namespace hyselam_objects;  // NOLINT: a program, not a header

/// Mean of the points of a model.
Eigen::Vector3d centreOf(const OrganizedCloud& model) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (!model.isValid(i)) continue;
    sum += model.points[i].cast<double>();
    ++count;
  }
  return sum / static_cast<double>(count);  // findModel() has refused models without points
}

/// `centre`: of the model, in the scene.
std::string lineOf(const FoundModel& found, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d at = found.model_in_scene.translation();
  const Eigen::AngleAxisd turn(found.model_in_scene.linear());
  char text[300];
  std::snprintf(text, sizeof(text),
                "  probability %.3f: centre at %.3f %.3f %.3f m (origin of the model at %.3f %.3f "
                "%.3f m), turned by %.1f deg; %zu correspondences, %.0f %% visible, %.0f %% of "
                "that covered",
                found.probability, centre.x(), centre.y(), centre.z(), at.x(), at.y(), at.z(),
                hyselam::degrees(turn.angle()), found.correspondences, 100.0 * found.visible,
                100.0 * found.coverage);
  return text;
}

nlohmann::json jsonOf(const FoundModel& found, const Eigen::Vector3d& centre) {
  nlohmann::json rows = nlohmann::json::array();
  for (int row = 0; row < 4; ++row) {
    nlohmann::json values = nlohmann::json::array();
    for (int column = 0; column < 4; ++column) {
      values.push_back(found.model_in_scene.matrix()(row, column));
    }
    rows.push_back(values);
  }
  return {{"model_in_scene", rows},
          {"centre_in_scene", {centre.x(), centre.y(), centre.z()}},
          {"probability", found.probability},
          {"correspondences", found.correspondences},
          {"coverage", found.coverage},
          {"visible", found.visible},
          {"flush", found.flush},
          {"looks", found.looks}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Finds a model, given as a point cloud of its surface, in a scene seen from one point. Tells "
      "nothing where the model is not, and each place where it is once, with a probability: its "
      "centre (mean of the model's points) in the scene, and how the model was moved and turned.",
      "find_model");
  std::string model_file, poses_file;
  std::vector<std::string> scene_files;
  FindModelParams params;
  app.option_defaults()->always_capture_default();
  app.add_option(
         "MODEL", model_file,
         "PCD file of the object, of one view from its origin, or of several by learn_model [m]")
      ->required();
  app.add_option(
         "SCENE", scene_files,
         "PCD file; z forward, x right, y down as cameras have it [m]. Several, with --poses: "
         "one scene from several sides")
      ->required();
  app.add_option(
      "--poses", poses_file,
      "TUM file: of each SCENE, in their order, the camera's pose [m]; what is told is in "
      "the frame of these");
  app.add_option("--min-probability", params.min_probability,
                 "of a pose that is told, 0 .. 1; 0: all that were looked at");
  app.add_option("--surface-sampling", params.surface_sampling,
                 "distance of the points that both clouds are thinned to [m]");
  app.add_option("--model-sampling", params.model_sampling, "distance of keypoints, model [m]");
  app.add_option("--scene-sampling", params.scene_sampling, "distance of keypoints, scene [m]");
  app.add_option("--descriptor-radius", params.descriptor_radius,
                 "of a keypoint's surroundings [m]");

  return hyselam::runTool(argc, argv, app, [&] {
    const CloudFile file = readPcd(model_file);
    const SurfaceModel model{file.cloud, file.seen_from};
    if (poses_file.empty() && scene_files.size() > 1) {
      throw hyselam::InputError("find_model", "--poses", "is needed for several views of a scene");
    }
    const std::vector<PlacedView> scene =
        poses_file.empty() ? std::vector<PlacedView>{{readPcd(scene_files[0]).cloud,
                                                      Eigen::Isometry3f::Identity()}}
                           : readPlacedViews(scene_files, poses_file);
    const std::clock_t begin = std::clock();
    const std::vector<FoundModel> found = findModel(model, scene, params);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    std::cout << (found.empty() ? "not found" : "found " + std::to_string(found.size())) << " in "
              << 1e3 * seconds << " ms\n";
    nlohmann::json poses = nlohmann::json::array();
    const Eigen::Vector3d model_centre = centreOf(model.cloud);
    for (const FoundModel& each : found) {
      const Eigen::Vector3d centre = each.model_in_scene * model_centre;
      std::cout << lineOf(each, centre) << "\n";
      poses.push_back(jsonOf(each, centre));
    }
    return nlohmann::json{{"found", poses}, {"seconds", seconds}};
  });
}
