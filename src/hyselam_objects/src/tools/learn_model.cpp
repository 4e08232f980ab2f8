// learn_model VIEW.pcd ... --poses POSES.tum --out MODEL.pcd: a model for find_model from views of
// a thing that stands alone.
#include "hyselam_objects/segmentation/learn_model.hpp"

#include <iostream>
#include <string>

#include "hyselam_common/tool.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/pcl/placed_views.hpp"

using namespace hyselam_objects;  // NOLINT: a program, not a header

int main(int argc, char** argv) {
  CLI::App app(
      "Joins views of a thing that stands alone on a level surface into a model for find_model, by "
      "where the camera was in each: from one view it knows one side only.",
      "learn_model");
  std::vector<std::string> files;
  std::string poses_file, out;
  app.add_option("VIEW", files, "PCD files; z forward, x right, y down as cameras have it [m]")
      ->required();
  app.add_option("--poses", poses_file,
                 "TUM file: of each view, in their order, the camera's pose; z is up [m]")
      ->required();
  app.add_option("--out", out, "PCD file to write, in the frame of the poses")->required();

  return hyselam::runTool(argc, argv, app, [&] {
    const std::vector<PlacedView> views = readPlacedViews(files, poses_file);
    const SurfaceModel model = learnModel(views);
    writePcd(out, model.cloud, std::vector<std::uint32_t>(model.cloud.size(), 2), model.seen_from);
    std::cout << model.cloud.size() << " points of " << views.size() << " views -> " << out << "\n";
    return nlohmann::json{{"points", model.cloud.size()}, {"views", views.size()}};
  });
}
