// CloudSegmentation of simulated tables, files, and clouds that cannot be used.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "../src/train/segmentation_score.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/pcl/segment_unorganized.hpp"
#include "hyselam_objects/segmentation/segment_cloud.hpp"
#include "hyselam_sim/camera.hpp"

namespace hyselam_objects {
namespace {

using hyselam::testing::fileBytes;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;
using hyselam_sim::Thing;

Thing thing(const std::string& name, Thing::Shape shape, hyselam::Pose2 pose, double z,
            std::array<double, 3> size) {
  Thing out;
  out.name = name;
  out.shape = shape;
  out.pose = pose;
  out.z = z;
  out.size = size;
  return out;
}

/// A wide table in front of a camera, with things on it, and the truth as mOSD has it.
CloudFile table(const std::vector<Thing>& things) {
  hyselam_sim::FloorPlan plan = hyselam_sim::parseFloorPlan(R"(
plan: table
origin: [-1, -1]
size: [8, 8]
walls: [{points: [[0, 0], [6, 0], [6, 6], [0, 6]], closed: true}]
furniture: [{name: plateau, box: [2.4, 3, 1.6, 2.4], height: 0.5}]
places: [{name: room, at: [1, 1]}]
)",
                                                            "table");
  hyselam_sim::SceneParams look;
  look.things = things;
  const hyselam_sim::Scene scene(plan, look);
  hyselam_sim::CameraParams camera;
  camera.above_floor = 0.95;
  camera.depth_sigma = 0.0008;
  camera.view = hyselam::radians(60.0);
  hyselam::Rng rng(3);
  const hyselam_sim::CameraFrame frame =
      hyselam_sim::takePicture(camera, scene, {}, {}, {0.45, 3.0, 0.0}, 0.0, rng);
  CloudFile out;
  out.cloud.width = camera.width;
  out.cloud.height = camera.height;
  const auto f = static_cast<float>(camera.focalLength());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const float z = 0.001f * frame.depth.at<std::uint16_t>(v, u);
      const auto owner = static_cast<std::uint32_t>(frame.owner.at<std::int32_t>(v, u));
      if (z == 0.0f || owner == 0) {
        out.cloud.points.emplace_back(nan, nan, nan);
        out.labels.push_back(0);
        continue;
      }
      out.cloud.points.emplace_back(
          (static_cast<float>(u) + 0.5f - 0.5f * static_cast<float>(camera.width)) * z / f,
          (static_cast<float>(v) + 0.5f - 0.5f * static_cast<float>(camera.height)) * z / f, z);
      out.labels.push_back(owner == 1 ? 1 : 10 * owner);
    }
  }
  return out;
}

constexpr auto kBox = Thing::Shape::kBox;
constexpr auto kCylinder = Thing::Shape::kCylinder;

SegmentationScore scoreOf(const CloudFile& file) {
  SegmentationScore score;
  addScore(segmentCloud(file.cloud).labels, file.labels, score);
  return score;
}

TEST(SegmentCloud, FindsSeparateObjects) {
  const SegmentationScore score =
      scoreOf(table({thing("a", kBox, {1.9, 2.7, 0.5}, 0.5, {0.2, 0.1, 0.25}),
                     thing("b", kCylinder, {2.1, 3.3, 0.0}, 0.5, {0.09, 0.09, 0.12}),
                     thing("c", kBox, {2.3, 3.0, 1.0}, 0.5, {0.15, 0.15, 0.15})}));
  EXPECT_EQ(score.objects, 3);
  EXPECT_GT(score.meanIou(), 0.9);
  EXPECT_EQ(score.over, 0);
  EXPECT_EQ(score.under, 0);
}

TEST(SegmentCloud, SplitsObjectsInContact) {
  const SegmentationScore score =
      scoreOf(table({thing("lower", kBox, {2.0, 3.0, 0.3}, 0.5, {0.3, 0.3, 0.12}),
                     thing("upper", kBox, {2.03, 3.02, 0.9}, 0.62, {0.14, 0.14, 0.14}),
                     thing("beside", kBox, {1.83, 3.3, 0.3}, 0.5, {0.1, 0.12, 0.2})}));
  EXPECT_EQ(score.objects, 3);
  EXPECT_GT(score.meanIou(), 0.85);
  EXPECT_EQ(score.under, 0);
}

TEST(SegmentCloud, MergesPartsBehindAnOccluder) {
  const SegmentationScore score =
      scoreOf(table({thing("behind", kBox, {2.2, 3.0, 1.5708}, 0.5, {0.5, 0.1, 0.2}),
                     thing("before", kBox, {1.9, 3.0, 0.0}, 0.5, {0.08, 0.08, 0.4})}));
  EXPECT_EQ(score.objects, 2);
  EXPECT_EQ(score.over, 0);
  EXPECT_GT(score.meanIou(), 0.85);
}

TEST(SegmentCloud, SortsLabelsByDistanceDeterministically) {
  const CloudFile file = table({thing("far", kBox, {2.5, 3.1, 0.2}, 0.5, {0.15, 0.15, 0.15}),
                                thing("near", kBox, {1.85, 2.8, 0.2}, 0.5, {0.15, 0.15, 0.15})});
  const CloudSegmentation a = segmentCloud(file.cloud), b = segmentCloud(file.cloud);
  EXPECT_EQ(a.labels, b.labels);
  ASSERT_EQ(a.objects, 2u);
  float depth[2] = {0.0f, 0.0f};
  int count[2] = {0, 0};
  for (std::size_t i = 0; i < a.labels.size(); ++i) {
    EXPECT_EQ(a.labels[i] == 0, !file.cloud.isValid(i));
    if (a.labels[i] < 2) continue;
    ASSERT_LE(a.labels[i], 3u);
    depth[a.labels[i] - 2] += file.cloud.points[i].z();
    ++count[a.labels[i] - 2];
  }
  EXPECT_LT(depth[0] / static_cast<float>(count[0]), depth[1] / static_cast<float>(count[1]));
}

TEST(SegmentCloud, FindsNoObjectsInEmptyAndInvalidClouds) {
  EXPECT_EQ(segmentCloud({}).objects, 0u);
  OrganizedCloud blind;
  blind.width = 20;
  blind.height = 10;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  blind.points.assign(200, Point(nan, nan, nan));
  const CloudSegmentation found = segmentCloud(blind);
  EXPECT_EQ(found.objects, 0u);
  EXPECT_FALSE(found.support);
  EXPECT_EQ(found.labels, std::vector<std::uint32_t>(200, 0));
  blind.points.assign(200, Point(0.0f, 0.0f, 0.0f));  // all in one point, behind the lens
  EXPECT_EQ(segmentCloud(blind).objects, 0u);
}

TEST(SegmentCloud, RefusesInvalidSizesAndParameters) {
  OrganizedCloud cloud;
  cloud.width = 3;
  cloud.height = 3;
  cloud.points.resize(8);
  EXPECT_THROW(segmentCloud(cloud), hyselam::InputError);
  cloud.points.resize(9, Point(0, 0, 1));
  cloud.colors.resize(2);
  EXPECT_THROW(segmentCloud(cloud), hyselam::InputError);
  cloud.colors.clear();
  const auto refused = [&](auto change) {
    SegmentParams params;
    change(params);
    EXPECT_THROW(segmentCloud(cloud, params), hyselam::ParameterError);
  };
  refused([](SegmentParams& p) { p.downsampling = 0; });
  refused([](SegmentParams& p) { p.normal_window = 0; });
  refused([](SegmentParams& p) { p.min_object_pixels = 0; });
  refused([](SegmentParams& p) { p.max_step = std::nan(""); });
  refused([](SegmentParams& p) { p.max_object_height = -1.0; });
}

TEST(SegmentUnorganized, FindsSeparateObjects) {
  CloudFile file = table({thing("a", kBox, {1.9, 2.7, 0.5}, 0.5, {0.2, 0.1, 0.25}),
                          thing("b", kCylinder, {2.0, 3.3, 0.0}, 0.5, {0.1, 0.1, 0.15})});
  file.cloud.width *= file.cloud.height;
  file.cloud.height = 1;
  SegmentationScore score;
  const CloudSegmentation found = segmentUnorganized(file.cloud, {0.0f, 0.0f, 0.0f});
  addScore(found.labels, file.labels, score);
  EXPECT_EQ(found.objects, 2u);
  EXPECT_GT(score.meanIou(), 0.8);
  UnorganizedParams params;
  params.voxel_size = 0.0;
  EXPECT_THROW(segmentUnorganized(file.cloud, {0.0f, 0.0f, 0.0f}, params), hyselam::ParameterError);
}

TEST(PcdFile, ReadsWhatItWrote) {
  const TemporaryDirectory directory;
  CloudFile file = table({});
  file.cloud.colors.assign(file.cloud.size(), 0x123456u);
  writePcd(directory / "a.pcd", file.cloud, file.labels);
  const CloudFile back = readPcd(directory / "a.pcd");
  EXPECT_EQ(back.labels, file.labels);
  EXPECT_EQ(back.cloud.colors, file.cloud.colors);
  EXPECT_EQ(back.cloud.width, file.cloud.width);
  for (std::size_t i = 0; i < file.cloud.size(); ++i) {
    ASSERT_EQ(back.cloud.isValid(i), file.cloud.isValid(i));
    if (!back.cloud.isValid(i)) continue;
    ASSERT_EQ(back.cloud.points[i], file.cloud.points[i]);
  }
}

TEST(PcdFile, RefusesInvalidFiles) {
  const TemporaryDirectory directory;
  EXPECT_THROW(readPcd(directory / "none.pcd"), hyselam::InputError);
  writeFile(directory / "text.pcd", "this is no cloud\n");
  EXPECT_THROW(readPcd(directory / "text.pcd"), hyselam::InputError);
  const std::string header =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  writeFile(
      directory / "short.pcd",
      header + "WIDTH 100\nHEIGHT 100\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 10000\nDATA binary\nab");
  EXPECT_THROW(readPcd(directory / "short.pcd"), hyselam::InputError);
  writeFile(directory / "huge.pcd", header +
                                        "WIDTH 100000\nHEIGHT 100000\n"
                                        "POINTS 10000000000\nDATA binary\nab");
  EXPECT_THROW(readPcd(directory / "huge.pcd"), hyselam::InputError);
  writeFile(directory / "wide.pcd",
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 40000000\nWIDTH 10000\n"
            "HEIGHT 1\nPOINTS 10000\nDATA binary\nab");
  EXPECT_THROW(readPcd(directory / "wide.pcd"), hyselam::InputError);
  writeFile(directory / "beyond.pcd",
            "VERSION 0.7\nFIELDS x y z\nSIZE 4\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3\n");
  EXPECT_THROW(readPcd(directory / "beyond.pcd"), hyselam::InputError);
  writeFile(directory / "flat.pcd",
            "VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 1\nHEIGHT 1\n"
            "POINTS 1\nDATA ascii\n1 2\n");
  EXPECT_THROW(readPcd(directory / "flat.pcd"), hyselam::InputError);
}

int shell(const std::string& arguments, const TemporaryDirectory& directory) {
  const std::string command = std::string(HYSELAM_SEGMENT_CLOUD) + " " + arguments + " >" +
                              (directory / "stdout") + " 2>" + (directory / "stderr");
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(SegmentCloudTool, WritesLabelsAndJson) {
  const TemporaryDirectory directory;
  const CloudFile file = table({thing("a", kBox, {1.9, 3.0, 0.5}, 0.5, {0.2, 0.1, 0.25})});
  writePcd(directory / "in.pcd", file.cloud, file.labels);
  ASSERT_EQ(shell((directory / "in.pcd") + " --labels " + (directory / "out.pcd") + " --json " +
                      (directory / "j.json"),
                  directory),
            0)
      << fileBytes(directory / "stderr");
  EXPECT_EQ(readPcd(directory / "out.pcd").labels, segmentCloud(file.cloud).labels);
  const auto json = nlohmann::json::parse(fileBytes(directory / "j.json"));
  EXPECT_EQ(json["objects"], 1);
  EXPECT_GE(json["seconds"], 0.0);
}

TEST(SegmentCloudTool, ReportsErrorsInOneLine) {
  const TemporaryDirectory directory;
  writeFile(directory / "bad.pcd", "nothing");
  EXPECT_EQ(shell((directory / "bad.pcd") + " --labels " + (directory / "o.pcd"), directory), 2);
  const std::string error = fileBytes(directory / "stderr");
  EXPECT_EQ(error.rfind("error: ", 0), 0u) << error;
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
  EXPECT_FALSE(std::filesystem::exists(directory / "o.pcd"));
}

TEST(SegmentCloud, AgreesWithHumanLabelsOnRealTables) {
  HYSELAM_NEED_DATA(data);
  SegmentationScore score;
  for (const auto& entry : std::filesystem::directory_iterator(data + "/objects/mosd")) {
    if (entry.path().extension() != ".pcd") continue;
    const CloudFile file = readPcd(entry.path().string());
    addScore(segmentCloud(file.cloud).labels, file.labels, score);
  }
  EXPECT_EQ(score.objects, 23);
  EXPECT_GT(score.meanIou(), 0.94);
  EXPECT_EQ(score.under, 0);
}

}  // namespace
}  // namespace hyselam_objects
