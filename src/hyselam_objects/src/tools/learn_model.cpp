// learn_model VIEW.pcd ... --poses POSES.tum --out MODEL.pcd: a model for find_model from views of
// a thing that stands alone.
#include "hyselam_objects/segmentation/learn_model.hpp"

#include <array>
#include <cmath>
#include <iostream>
#include <string>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"

namespace {

using namespace hyselam_objects;  // NOLINT: a program, not a header

/// Poses of the TUM format, with all six degrees of freedom.
std::vector<Eigen::Isometry3f> readCameraPoses(const std::string& path) {
  std::vector<Eigen::Isometry3f> out;
  const std::string text = hyselam::readTextFile(path);
  hyselam::forEachLine(text, [&](std::size_t number, std::string_view line) {
    std::vector<std::string_view> fields;
    hyselam::splitFields(line, &fields);
    if (fields.empty() || fields[0].front() == '#') return;
    const std::string place = "line " + std::to_string(number);
    std::array<double, 8> values{};
    if (fields.size() != values.size()) {
      throw hyselam::InputError(path, place, "has not the 8 numbers: stamp x y z qx qy qz qw");
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto value = hyselam::parseNumber(fields[i]);
      if (!value) throw hyselam::InputError(path, place, "has no number in each field");
      values[i] = *value;
    }
    const Eigen::Quaterniond turn(values[7], values[4], values[5], values[6]);
    if (!(std::abs(turn.norm() - 1.0) < 0.01)) {
      throw hyselam::InputError(path, place, "has no quaternion of length 1");
    }
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = turn.normalized().toRotationMatrix();
    pose.translation() = Eigen::Vector3d(values[1], values[2], values[3]);
    out.push_back(pose.cast<float>());
  });
  return out;
}

}  // namespace

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
    const std::vector<Eigen::Isometry3f> poses = readCameraPoses(poses_file);
    if (poses.size() != files.size()) {
      throw hyselam::InputError(poses_file, "",
                                "has " + std::to_string(poses.size()) + " poses for " +
                                    std::to_string(files.size()) + " views");
    }
    std::vector<ModelView> views;
    for (std::size_t i = 0; i < files.size(); ++i) {
      views.push_back({readPcd(files[i]).cloud, poses[i]});
    }
    const SurfaceModel model = learnModel(views);
    writePcd(out, model.cloud, std::vector<std::uint32_t>(model.cloud.size(), 2), model.seen_from);
    std::cout << model.cloud.size() << " points of " << views.size() << " views -> " << out << "\n";
    return nlohmann::json{{"points", model.cloud.size()}, {"views", views.size()}};
  });
}
