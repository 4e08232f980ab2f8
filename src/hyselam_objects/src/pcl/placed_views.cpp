#include "hyselam_objects/pcl/placed_views.hpp"

#include <array>
#include <cmath>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"

namespace hyselam_objects {
namespace {

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

std::vector<PlacedView> readPlacedViews(const std::vector<std::string>& files,
                                        const std::string& poses_file) {
  const std::vector<Eigen::Isometry3f> poses = readCameraPoses(poses_file);
  if (poses.size() != files.size()) {
    throw hyselam::InputError(poses_file, "",
                              "has " + std::to_string(poses.size()) + " poses for " +
                                  std::to_string(files.size()) + " views");
  }
  std::vector<PlacedView> out;
  for (std::size_t i = 0; i < files.size(); ++i) {
    out.push_back({readPcd(files[i]).cloud, poses[i]});
  }
  return out;
}

}  // namespace hyselam_objects
