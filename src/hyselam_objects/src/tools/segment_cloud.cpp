// segment_cloud IN.pcd --labels OUT.pcd [--objects FOLDER]: which points of a cloud belong to one
// object.
#include "hyselam_objects/segmentation/segment_cloud.hpp"

#include <algorithm>
#include <ctime>
#include <iostream>
#include <map>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/pcl/segment_unorganized.hpp"

namespace {

using namespace hyselam_objects;  // NOLINT: a program, not a header

/// What was done to the cloud before it could be segmented, and by which method.
struct Outcome {
  CloudSegmentation found;
  bool organized = true;  ///< segmented as an image
  bool rows_made = false;
  std::string without_effect;  ///< options
};

/// Half a turn about x.
Eigen::Vector3f halfTurned(const Eigen::Vector3f& v) {
  return {v.x(), -v.y(), -v.z()};
}

Outcome segment(const OrganizedCloud& cloud, const SegmentParams& params,
                const UnorganizedParams& loose, const std::optional<Intrinsics>& camera,
                const std::optional<Eigen::Vector3f>& up) {
  Outcome out;
  if (cloud.width > 1 && cloud.height > 1) {
    out.found = segmentCloud(cloud, params, up);
    if (camera) out.without_effect = "--camera";
    return out;
  }
  const bool behind = liesBehind(cloud);
  OrganizedCloud front = cloud;
  if (behind) turnToFront(front);
  const std::optional<OrganizedView> view = organizeCloud(front, camera);
  if (!view) {
    out.organized = false;
    out.found = segmentUnorganized(cloud, {0.0f, 0.0f, 0.0f}, loose);
    if (up) out.without_effect = "--up";
    if (camera) out.without_effect += up ? " and --camera" : "--camera";
    return out;
  }
  out.rows_made = true;
  std::optional<Eigen::Vector3f> up_in_front = up;
  if (up && behind) up_in_front = halfTurned(*up);
  out.found = segmentCloud(view->cloud, params, up_in_front);
  out.found.turn.behind = behind;
  if (behind && out.found.support) {
    out.found.support->normal = halfTurned(out.found.support->normal);
  }
  std::vector<std::uint32_t> labels(cloud.size(), 0);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!cloud.isValid(i)) continue;
    const std::int32_t pixel = view->pixel_of[i];
    labels[i] = pixel < 0 ? 1u : std::max(1u, out.found.labels[static_cast<std::size_t>(pixel)]);
  }
  out.found.labels = std::move(labels);
  return out;
}

std::string remarks(const Outcome& outcome) {
  std::string out;
  if (!outcome.found.support) out += " (no supporting plane found)";
  if (!outcome.organized) out += " (by gaps only: no view from one point)";
  if (outcome.rows_made) out += " (rows were made by projection)";
  if (!outcome.without_effect.empty()) out += " (" + outcome.without_effect + " had no effect)";
  if (outcome.found.turn.behind) out += " (depth is negative: taken for its absolute value)";
  if (outcome.found.turn.mirrored) out += " (the image is mirrored)";
  if (outcome.found.turn.upside_down) out += " (the image is upside down)";
  return out;
}

/// Writes the points of each object, label by label, as a model that find_model looks for.
void writeObjects(const std::string& folder, const OrganizedCloud& cloud,
                  const CloudSegmentation& found) {
  hyselam::makeFolder(folder);
  std::map<std::uint32_t, OrganizedCloud> objects;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (found.labels[i] < 2) continue;
    OrganizedCloud& object = objects[found.labels[i]];
    object.points.push_back(cloud.points[i]);
    if (!cloud.colors.empty()) object.colors.push_back(cloud.colors[i]);
  }
  for (auto& [label, object] : objects) {
    object.width = static_cast<int>(object.size());
    object.height = 1;
    writePcd(folder + "/object_" + std::to_string(label) + ".pcd", object,
             std::vector<std::uint32_t>(object.size(), label));
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Segments a point cloud into support and objects, without models of them. Clouds that were "
      "seen from one point are taken as images (without rows and columns they get them by "
      "projection); others are split where there is a gap.",
      "segment_cloud");
  std::string in, out, objects;
  std::vector<double> up, camera;
  SegmentParams params;
  UnorganizedParams loose;
  app.option_defaults()->always_capture_default();
  app.add_option("CLOUD", in, "PCD file; z forward, x right, y down as cameras have it [m]")
      ->required();
  app.add_option("--labels", out,
                 "PCD file to write, with a label per point: 0 invalid, 1 support, 2 ... objects")
      ->required();
  app.add_option("--objects", objects,
                 "folder to write each object into, object_LABEL.pcd: a model for find_model");
  app.add_option("--downsampling,--reduce", params.downsampling, "use every n-th row and column");
  app.add_option("--max-height,--tallest", params.max_object_height,
                 "highest object above the support [m]");
  app.add_option("--min-pixels,--smallest", params.min_object_pixels,
                 "least number of reduced pixels of an object");
  app.add_option("--gap", loose.cluster_gap, "between objects, for merged views [m]");
  app.add_option("--up", up, "X Y Z against gravity: only a level plane is a support")->expected(3);
  app.add_option("--camera", camera,
                 "FOCAL_X FOCAL_Y CENTER_X CENTER_Y WIDTH HEIGHT [pixel], for clouds without rows "
                 "(otherwise estimated)")
      ->expected(6);

  return hyselam::runTool(argc, argv, app, [&] {
    const CloudFile file = readPcd(in);
    loose.max_object_height = params.max_object_height;
    std::optional<Eigen::Vector3f> upward;
    if (!up.empty()) upward = Eigen::Vector3d(up[0], up[1], up[2]).cast<float>();
    std::optional<Intrinsics> intrinsics;
    if (!camera.empty()) {
      const auto pixels = [](double value) {  // out of range: refused as an image without size
        return value >= 1.0 && value <= 1e5 ? static_cast<int>(value) : 0;
      };
      intrinsics = Intrinsics{camera[0], camera[1],         camera[2],
                              camera[3], pixels(camera[4]), pixels(camera[5])};
    }
    const std::clock_t begin = std::clock();
    const Outcome outcome = segment(file.cloud, params, loose, intrinsics, upward);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    const CloudSegmentation& found = outcome.found;
    writePcd(out, file.cloud, found.labels);
    if (!objects.empty()) writeObjects(objects, file.cloud, found);
    std::cout << found.objects << " objects" << remarks(outcome) << " in " << 1e3 * seconds
              << " ms -> " << out << "\n";
    return nlohmann::json{{"objects", found.objects},
                          {"seconds", seconds},
                          {"organised", outcome.organized},
                          {"rows_made", outcome.rows_made},
                          {"behind", found.turn.behind},
                          {"mirrored", found.turn.mirrored},
                          {"upside_down", found.turn.upside_down},
                          {"support", found.support.has_value()},
                          {"points", file.cloud.size()}};
  });
}
