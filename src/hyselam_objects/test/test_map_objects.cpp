// map_objects: what it says of bags of which it can make no map.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <tf2_msgs/TFMessage.h>

#include "hyselam_common/testing/program_run.hpp"

namespace {

using hyselam::testing::refused;
using hyselam::testing::runProgram;
using hyselam::testing::TemporaryDirectory;

constexpr int kWidth = 64, kHeight = 48;
const ros::Time kStamp(100.0);

sensor_msgs::Image image(const std::string& encoding, std::uint32_t bytes, const ros::Time& stamp) {
  sensor_msgs::Image out;
  out.header.frame_id = "camera";
  out.header.stamp = stamp;
  out.width = kWidth;
  out.height = kHeight;
  out.encoding = encoding;
  out.step = kWidth * bytes;
  out.data.assign(static_cast<std::size_t>(out.step) * kHeight, 0);
  return out;
}

/// One frame (color `later` than depth [s]) of a camera on a base in odom.
std::string bagWith(const TemporaryDirectory& folder, double later) {
  const std::string file = folder / "run.bag";
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  tf2_msgs::TFMessage moved, fixed;
  geometry_msgs::TransformStamped pose;
  pose.transform.rotation.w = 1.0;
  pose.header.frame_id = "base_link";
  pose.child_frame_id = "camera";
  fixed.transforms.push_back(pose);
  pose.header.frame_id = "odom";
  pose.child_frame_id = "base_link";
  for (const double t : {-1.0, 1.0}) {
    pose.header.stamp = kStamp + ros::Duration(t);
    moved.transforms.push_back(pose);
  }
  bag.write("/tf_static", kStamp, fixed);
  bag.write("/tf", kStamp, moved);
  sensor_msgs::CameraInfo info;
  info.header.frame_id = "camera";
  info.width = kWidth;
  info.height = kHeight;
  info.K = {50.0, 0.0, 32.0, 0.0, 50.0, 24.0, 0.0, 0.0, 1.0};
  info.P = {50.0, 0.0, 32.0, 0.0, 0.0, 50.0, 24.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  bag.write("/camera/depth/camera_info", kStamp, info);
  bag.write("/camera/depth/image_raw", kStamp, image("16UC1", 2, kStamp));
  bag.write("/camera/color/image_raw", kStamp, image("rgb8", 3, kStamp + ros::Duration(later)));
  return file;
}

hyselam::testing::ProgramRun mapped(const TemporaryDirectory& folder, const std::string& bag,
                                    const std::string& options = "") {
  return runProgram(
      HYSELAM_TOOLS "/map_objects " + bag + " --map " + (folder / "o.xml") + " " + options, folder);
}

TEST(MapObjectsTool, SaysWhichTransformIsMissing) {
  const TemporaryDirectory folder;
  const std::string bag = bagWith(folder, 0.0);
  EXPECT_TRUE(refused(mapped(folder, bag),
                      "images are there (1 frames), but no transform from map to camera; frames "
                      "of the bag: base_link, camera, odom; use --frame odom, or localize first"));
  // What it proposes helps.
  const auto run = mapped(folder, bag, "--frame odom");
  EXPECT_EQ(run.status, 0) << run.errors;
}

TEST(MapObjectsTool, CountsImagesThatHaveNoPair) {
  const TemporaryDirectory folder;
  EXPECT_TRUE(refused(mapped(folder, bagWith(folder, 0.3)),
                      "has no depth and color images of equal stamps (depth: 1, color: 1, "
                      "camera_info: there)"));
}

}  // namespace
