// Bags written, read, compared byte by byte, and damaged.
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <zlib.h>

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/testing/files.hpp"

namespace hyselam {
namespace {

using testing::fileBytes;
using testing::messageOf;
using testing::TemporaryDirectory;
using testing::writeFile;

RobotLog someLog(int scans = 20) {
  RobotLog log;
  Rng rng(6);
  for (int i = 0; i < scans; ++i) {
    LaserScan s;
    s.stamp = 0.1 * i;
    s.angle_min = -kPi / 2;
    s.angle_increment = radians(1.0);
    s.range_min = 0.1;
    s.range_max = 8.0;
    for (int k = 0; k < 181; ++k) s.ranges.push_back(static_cast<float>(rng.uniform(0.0, 9.0)));
    s.laser_in_base = {0.2, 0.01, 0.1};
    log.scans.push_back(s);
    log.odometry.push_back({0.1 * i, {0.05 * i, 0.01 * i, 0.1 * i}});
    log.ground_truth.push_back({0.1 * i + 0.02, {1 + 0.05 * i, 0.0, 0.1 * i}});
  }
  return log;
}

void expectNear(const std::vector<StampedPose2>& a, const std::vector<StampedPose2>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i].stamp, b[i].stamp, 1.5e-9);
    EXPECT_NEAR(a[i].pose.x, b[i].pose.x, 1e-12);
    EXPECT_NEAR(a[i].pose.y, b[i].pose.y, 1e-12);
    EXPECT_NEAR(normalizeAngle(a[i].pose.theta - b[i].pose.theta), 0.0, 1e-12);
  }
}

std::string gzipFile(const std::string& path, const std::string& bytes) {
  gzFile file = gzopen(path.c_str(), "wb");
  gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(file);
  return path;
}

TEST(BagIo, RoundTrip) {
  TemporaryDirectory d;
  const RobotLog log = someLog();
  writeBag(d / "a.bag", log);
  const RobotLog back = readBag(d / "a.bag");
  ASSERT_EQ(back.scans.size(), log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    EXPECT_EQ(back.scans[i].ranges, log.scans[i].ranges);
    EXPECT_NEAR(back.scans[i].laser_in_base.x, 0.2, 1e-12);
    EXPECT_NEAR(back.scans[i].laser_in_base.theta, 0.1, 1e-12);
    EXPECT_NEAR(back.scans[i].angle_increment, radians(1.0), 1e-8);
  }
  EXPECT_EQ(back.scans[0].stamp, 1e-9);  // 0 cannot be held
  expectNear(back.odometry, log.odometry);
  expectNear(back.ground_truth, log.ground_truth);
  EXPECT_EQ(d.fileCount(), 1U);
}

TEST(BagIo, PackedBagsAreReadAlike) {
  TemporaryDirectory d;
  writeBag(d / "a.bag", someLog());
  gzipFile(d / "a.bag.gz", fileBytes(d / "a.bag"));
  EXPECT_EQ(readBag(d / "a.bag.gz").scans.size(), 20U);
}

TEST(BagIo, TheSameLogGivesTheSameBytes) {
  TemporaryDirectory d;
  writeBag(d / "a.bag", someLog(500));
  writeBag(d / "b.bag", someLog(500));
  EXPECT_GT(fileBytes(d / "a.bag").size(), 400000U);
  EXPECT_TRUE(fileBytes(d / "a.bag") == fileBytes(d / "b.bag"));
  RobotLog other = someLog(500);
  other.scans[250].ranges[3] += 1.0F;
  writeBag(d / "b.bag", other);
  EXPECT_FALSE(fileBytes(d / "a.bag") == fileBytes(d / "b.bag"));
}

TEST(BagIo, MessagesAreInOrderAndTheLasersPlaceIsLatched) {
  TemporaryDirectory d;
  writeBag(d / "a.bag", someLog());
  rosbag::Bag bag(d / "a.bag");
  rosbag::View view(bag);
  ros::Time last;
  std::vector<std::string> first_topics;
  for (const rosbag::MessageInstance& m : view) {
    EXPECT_GE(m.getTime(), last);
    last = m.getTime();
    if (first_topics.size() < 4) first_topics.push_back(m.getTopic());
    if (m.getTopic() == "/tf_static") {
      EXPECT_TRUE(m.isLatching());
    }
    if (const auto odometry = m.instantiate<nav_msgs::Odometry>()) {
      if (m.getTopic() != "/odom" || odometry->pose.pose.position.x == 0.0) continue;
      if (odometry->pose.pose.position.x > 0.9)
        continue;  // the last has a neighbour on one side only
      EXPECT_NEAR(odometry->twist.twist.angular.z, 1.0, 1e-6);
      EXPECT_NEAR(std::hypot(odometry->twist.twist.linear.x, odometry->twist.twist.linear.y),
                  std::hypot(0.5, 0.1), 1e-6);
      EXPECT_EQ(odometry->header.frame_id, "odom");
      EXPECT_EQ(odometry->child_frame_id, "base_link");
    }
  }
  EXPECT_EQ(first_topics, (std::vector<std::string>{"/tf_static", "/tf", "/odom", "/scan"}));
}

TEST(BagIo, LaserPlaceFromTheOptionWins) {
  TemporaryDirectory d;
  writeBag(d / "a.bag", someLog());
  BagOptions options;
  options.laser_in_base = Pose2{1, 2, 3};
  EXPECT_DOUBLE_EQ(readBag(d / "a.bag", options).scans[0].laser_in_base.y, 2.0);
}

// --- bags of others

geometry_msgs::TransformStamped transform(double stamp, const std::string& parent,
                                          const std::string& child, const Pose2& pose) {
  geometry_msgs::TransformStamped t;
  t.header.stamp = toRosTime(stamp);
  t.header.frame_id = parent;
  t.child_frame_id = child;
  t.transform = toTransformMsg(pose);
  return t;
}

struct Writer {
  explicit Writer(const std::string& path) : bag(path, rosbag::bagmode::Write) {}
  void scan(double stamp, const std::string& topic = "/base_scan",
            const std::string& frame = "/laser") {
    bag.write(topic, toRosTime(stamp), toMsg(withStamp(stamp), frame));
  }
  void tf(const geometry_msgs::TransformStamped& t) {
    tf2_msgs::TFMessage msg;
    msg.transforms.push_back(t);
    bag.write("/tf", t.header.stamp, msg);
  }
  static LaserScan withStamp(double stamp) {
    LaserScan s = someLog(1).scans[0];
    s.stamp = stamp;
    return s;
  }
  rosbag::Bag bag;
};

TEST(BagIo, OdometryFromTfAndLaserThroughAChain) {
  TemporaryDirectory d;
  {
    Writer w(d / "a.bag");
    w.tf(transform(1, "/odom", "/base_link", {1, 0, 0}));
    w.tf(transform(1, "base_link", "plate", {0.1, 0, kPi / 2}));
    w.tf(transform(1, "plate", "laser", {0.2, 0, 0}));
    w.scan(1.0);
    w.tf(transform(2, "odom", "base_link", {3, 0, 0}));
    w.scan(1.5);
  }
  const RobotLog log = readBag(d / "a.bag");
  ASSERT_EQ(log.scans.size(), 2U);
  EXPECT_NEAR(log.scans[0].laser_in_base.x, 0.1, 1e-12);
  EXPECT_NEAR(log.scans[0].laser_in_base.y, 0.2, 1e-12);
  EXPECT_NEAR(poseAt(log.odometry, 1.5)->x, 2.0, 1e-9);
}

TEST(BagIo, LaserUpsideDownTurnsTheOtherWay) {
  TemporaryDirectory d;
  {
    Writer w(d / "a.bag");
    w.tf(transform(1, "odom", "base_link", {}));
    auto t = transform(1, "base_link", "laser", {0.3, 0, 0});
    t.transform.rotation.x = 1.0;  // roll of 180 deg
    t.transform.rotation.w = 0.0;
    w.tf(t);
    w.scan(1.0);
  }
  const LaserScan scan = readBag(d / "a.bag").scans.at(0);
  EXPECT_NEAR(scan.angle_min, kPi / 2, 1e-6);
  EXPECT_NEAR(scan.angle_increment, -radians(1.0), 1e-8);
  EXPECT_NEAR(scan.laser_in_base.theta, 0.0, 1e-9);
}

TEST(BagIo, TiltedLaserIsRefused) {
  TemporaryDirectory d;
  {
    Writer w(d / "a.bag");
    w.tf(transform(1, "odom", "base_link", {}));
    auto t = transform(1, "base_link", "laser", {});
    t.transform.rotation.y = t.transform.rotation.w = std::sqrt(0.5);  // looks down
    w.tf(t);
    w.scan(1.0);
  }
  EXPECT_THROW(readBag(d / "a.bag"), InputError);
}

TEST(BagIo, GroundTruthAsPoseStamped) {
  TemporaryDirectory d;
  {
    Writer w(d / "a.bag");
    w.tf(transform(1, "odom", "base_link", {}));
    w.scan(1.0);
    geometry_msgs::PoseStamped p;
    p.header.stamp = toRosTime(1.0);
    p.pose = toPoseMsg({5, 6, 0.7});
    w.bag.write("/ground_truth", p.header.stamp, p);
  }
  EXPECT_NEAR(readBag(d / "a.bag").ground_truth.at(0).pose.theta, 0.7, 1e-12);
}

TEST(BagIo, MessagesOutOfOrderAreSorted) {
  TemporaryDirectory d;
  {
    Writer w(d / "a.bag");
    for (const double t : {3.0, 1.0, 2.0}) {
      auto msg = toMsg(Writer::withStamp(t), "laser");
      w.bag.write("/scan", toRosTime(10.0), msg);
      w.tf(transform(t, "odom", "base_link", {t, 0, 0}));
    }
  }
  const RobotLog log = readBag(d / "a.bag");
  EXPECT_EQ(log.scans[0].stamp, 1.0);
  EXPECT_EQ(log.scans[2].stamp, 3.0);
  EXPECT_NEAR(poseAt(log.odometry, 2.5)->x, 2.5, 1e-12);
}

// --- bags that cannot be used

std::string errorOf(const std::string& path, const BagOptions& options = {}) {
  std::string message = messageOf<InputError>([&] { readBag(path, options); });
  EXPECT_EQ(message.find(path), 0U) << message;
  return message;
}

TEST(BagIo, MissingBagAndDirectoryAreErrors) {
  TemporaryDirectory d;
  EXPECT_NE(errorOf(d / "none.bag").find("cannot be read"), std::string::npos);
  errorOf(d.path());
}

TEST(BagIo, NoBagIsAnError) {
  TemporaryDirectory d;
  writeFile(d / "empty.bag", "");
  errorOf(d / "empty.bag");
  writeFile(d / "text.bag", "this is no bag, but a text of some length\n");
  errorOf(d / "text.bag");
  writeFile(d / "head.bag", "#ROSBAG V2.0\n");
  errorOf(d / "head.bag");
  gzipFile(d / "text.bag.gz", "no bag");
  errorOf(d / "text.bag.gz");
}

TEST(BagIo, TruncatedBagIsAnError) {
  TemporaryDirectory d;
  writeBag(d / "a.bag", someLog(100));
  const std::string bytes = fileBytes(d / "a.bag");
  for (int k = 1; k < 40; ++k) {
    writeFile(d / "cut.bag", bytes.substr(0, bytes.size() * static_cast<std::size_t>(k) / 40));
    errorOf(d / "cut.bag");
  }
  const std::string packed = fileBytes(gzipFile(d / "a.bag.gz", bytes));
  writeFile(d / "cut.bag.gz", packed.substr(0, packed.size() / 2));
  EXPECT_NE(errorOf(d / "cut.bag.gz").find("truncated"), std::string::npos);
}

TEST(BagIo, BagWithoutIndexIsCalledTruncated) {
  TemporaryDirectory d;
  {
    // As a recorder leaves it that was killed: header without index position.
    writeBag(d / "a.bag", someLog(100));
  }
  std::string bytes = fileBytes(d / "a.bag");
  const std::size_t at = bytes.find("index_pos=");
  ASSERT_NE(at, std::string::npos);
  for (std::size_t i = 0; i < 8; ++i) bytes[at + 10 + i] = '\0';
  writeFile(d / "a.bag", bytes);
  EXPECT_NE(errorOf(d / "a.bag").find("truncated"), std::string::npos);
}

TEST(BagIo, DamagedBytesNeverCrash) {
  TemporaryDirectory d;
  writeBag(d / "a.bag", someLog(5));
  const std::string bytes = fileBytes(d / "a.bag");
  Rng rng(8);
  for (int round = 0; round < 300; ++round) {
    std::string damaged = bytes;
    for (int k = 0; k < 4; ++k) {
      damaged[rng.below(static_cast<std::uint32_t>(damaged.size()))] =
          static_cast<char>(rng.below(256));
    }
    writeFile(d / "bad.bag", damaged);
    try {
      readBag(d / "bad.bag");
    } catch (const InputError&) {
    }
  }
}

TEST(BagIo, BagWithoutScansIsAnError) {
  TemporaryDirectory d;
  {
    Writer w(d / "a.bag");
    w.tf(transform(1, "odom", "base_link", {}));
  }
  EXPECT_NE(errorOf(d / "a.bag").find("no laser scans"), std::string::npos);
}

TEST(BagIo, BagWithoutOdometryIsAnErrorUnlessAllowed) {
  TemporaryDirectory d;
  {
    Writer w(d / "a.bag");
    w.scan(1.0);
  }
  EXPECT_NE(errorOf(d / "a.bag").find("no odometry"), std::string::npos);
  BagOptions options;
  options.odometry_required = false;
  EXPECT_EQ(readBag(d / "a.bag", options).scans.size(), 1U);
}

TEST(BagIo, SeveralScanTopicsNeedAChoice) {
  TemporaryDirectory d;
  {
    Writer w(d / "a.bag");
    w.tf(transform(1, "odom", "base_link", {}));
    w.scan(1.0, "/front");
    w.scan(1.5, "/rear");
  }
  const std::string message = errorOf(d / "a.bag");
  EXPECT_NE(message.find("/front /rear"), std::string::npos) << message;
  BagOptions options;
  options.scan_topic = "rear";
  EXPECT_EQ(readBag(d / "a.bag", options).scans.at(0).stamp, 1.5);
}

TEST(BagIo, UnusableMessageIsNamedWithTopicAndTime) {
  TemporaryDirectory d;
  {
    Writer w(d / "a.bag");
    w.tf(transform(1, "odom", "base_link", {}));
    auto msg = toMsg(Writer::withStamp(1.0), "laser");
    msg.ranges.clear();
    w.bag.write("/scan", toRosTime(1.0), msg);
  }
  const std::string message = errorOf(d / "a.bag");
  EXPECT_NE(message.find("/scan at 1.0"), std::string::npos) << message;
}

TEST(BagIo, LogsThatNoBagHoldsAreRefusedAndNothingIsLeft) {
  TemporaryDirectory d;
  EXPECT_THROW(writeBag(d / "a.bag", RobotLog{}), InputError);
  RobotLog log = someLog();
  EXPECT_THROW(writeBag(d / "none/a.bag", log), InputError);
  log.scans.back().stamp = 5e9;
  EXPECT_THROW(writeBag(d / "a.bag", log), InputError);
  log = someLog();
  log.scans[3].laser_in_base.x += 0.1;
  EXPECT_THROW(writeBag(d / "a.bag", log), InputError);
  log = someLog();
  log.odometry[3].pose.x = std::nan("");
  EXPECT_THROW(writeBag(d / "a.bag", log), InputError);
  EXPECT_EQ(d.fileCount(), 0U);
}

}  // namespace
}  // namespace hyselam
