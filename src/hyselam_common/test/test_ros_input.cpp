// What servers do with messages before they use them: waiting for transforms, dropping, limiting
// rates, checking poses that people give.
#include <gtest/gtest.h>
#include <tf2/buffer_core.h>

#include <limits>
#include <map>
#include <stdexcept>
#include <vector>

#include "hyselam_common/ros/drop_counter.hpp"
#include "hyselam_common/ros/initial_pose.hpp"
#include "hyselam_common/ros/rate_limit.hpp"
#include "hyselam_common/ros/result_wait.hpp"
#include "hyselam_common/ros/scan_input_params.hpp"
#include "hyselam_common/ros/wait_for_transform.hpp"
#include "hyselam_common/testing/files.hpp"

namespace hyselam {
namespace {

using testing::messageOf;
using Queue = WaitingQueue<int>;

/// A queue of three numbers with a patience of one second, and what became of them.
class WaitingQueueTest : public ::testing::Test {
 protected:
  static Queue::Now at(double wall, double ros) {
    return {ros::WallTime(100.0 + wall), ros::Time(1000.0 + ros)};
  }
  Queue queue(WaitParams::Clock clock = WaitParams::Clock::kWallAndRos) {
    return Queue(
        {3, 1.0, clock},
        [this](const int& number) {
          return ready_ >= number ? std::string() : "waits for " + std::to_string(number);
        },
        [this](const int& number) {
          used_.push_back(number);
          if (number == refused_) throw std::runtime_error("refused");
        },
        [this](const int& number, Queue::GivenUp why, const std::string& missing) {
          (why == Queue::GivenUp::kQueueFull ? overflowed_ : timed_out_)[number] = missing;
        });
  }

  int ready_ = 0;  // numbers up to this one lack nothing
  int refused_ = -1;
  std::vector<int> used_;
  std::map<int, std::string> overflowed_, timed_out_;
};

TEST_F(WaitingQueueTest, MessagesAreUsedInOrderOnceNothingIsMissing) {
  Queue waiting = queue();
  for (int number : {1, 2, 3}) waiting.add(number, at(0.0, 0.0));
  waiting.serve(at(0.1, 0.1));
  EXPECT_TRUE(used_.empty());
  ready_ = 2;
  waiting.serve(at(0.2, 0.2));
  EXPECT_EQ(used_, (std::vector<int>{1, 2}));
  EXPECT_EQ(waiting.size(), 1u);
  ready_ = 3;
  waiting.serve(at(0.3, 0.3));
  EXPECT_EQ(used_, (std::vector<int>{1, 2, 3}));
  EXPECT_TRUE(waiting.empty());
  EXPECT_TRUE(overflowed_.empty() && timed_out_.empty());
}

TEST_F(WaitingQueueTest, NoMessageOvertakesOneThatWaits) {
  Queue waiting = queue();
  ready_ = 5;
  waiting.add(9, at(0.0, 0.0));
  waiting.add(4, at(0.0, 0.0));
  waiting.serve(at(0.5, 0.5));
  EXPECT_TRUE(used_.empty());
  waiting.serve(at(1.0, 1.0));
  EXPECT_EQ(used_, (std::vector<int>{4}));
  EXPECT_EQ(timed_out_, (std::map<int, std::string>{{9, "waits for 9"}}));
}

TEST_F(WaitingQueueTest, MessagesThatAreHeldAreNotGivenUp) {
  Queue waiting = queue();
  bool busy = true;
  waiting.holdWhile([&](const int& number) { return busy && number == 2; });
  ready_ = 5;
  for (int number : {1, 2, 3}) waiting.add(number, at(0.0, 0.0));
  waiting.serve(at(9.0, 9.0));
  EXPECT_EQ(used_, (std::vector<int>{1}));
  EXPECT_TRUE(timed_out_.empty()) << "nothing is missing";
  busy = false;
  waiting.serve(at(9.1, 9.1));
  EXPECT_EQ(used_, (std::vector<int>{1, 2, 3}));
}

TEST_F(WaitingQueueTest, OldestIsGivenUpWhereTheQueueIsFull) {
  Queue waiting = queue();
  for (int number : {1, 2, 3, 4}) waiting.add(number, at(0.0, 0.0));
  EXPECT_EQ(waiting.size(), 3u);
  EXPECT_EQ(overflowed_, (std::map<int, std::string>{{1, ""}}));
  ready_ = 4;
  waiting.serve(at(0.0, 0.0));
  EXPECT_EQ(used_, (std::vector<int>{2, 3, 4}));
}

TEST_F(WaitingQueueTest, NeitherAPausedNorAFastBagExhaustsThePatienceOfBothClocks) {
  Queue waiting = queue();
  waiting.add(1, at(0.0, 0.0));
  waiting.serve(at(100.0, 0.9));  // the bag stands
  waiting.serve(at(0.9, 100.0));  // the bag is played fast
  EXPECT_TRUE(timed_out_.empty());
  waiting.serve(at(1.0, 1.0));
  EXPECT_EQ(timed_out_.count(1), 1u);
}

TEST_F(WaitingQueueTest, WallTimeAloneGivesUpWhileTheClockStands) {
  Queue waiting = queue(WaitParams::Clock::kWall);
  waiting.add(1, at(0.0, 0.0));
  waiting.serve(at(0.9, 0.0));
  EXPECT_TRUE(timed_out_.empty());
  waiting.serve(at(1.0, 0.0));
  EXPECT_EQ(timed_out_.count(1), 1u);
}

TEST_F(WaitingQueueTest, MessageThatThrowsIsNotTriedAgain) {
  Queue waiting = queue();
  ready_ = 2;
  refused_ = 1;
  waiting.add(1, at(0.0, 0.0));
  waiting.add(2, at(0.0, 0.0));
  EXPECT_THROW(waiting.serve(at(0.0, 0.0)), std::runtime_error);
  waiting.serve(at(0.0, 0.0));
  EXPECT_EQ(used_, (std::vector<int>{1, 2}));
}

TEST_F(WaitingQueueTest, ForgottenMessagesAreNeitherUsedNorGivenUp) {
  Queue waiting = queue();
  waiting.add(1, at(0.0, 0.0));
  waiting.clear();
  ready_ = 1;
  waiting.serve(at(5.0, 5.0));
  EXPECT_TRUE(waiting.empty() && used_.empty() && overflowed_.empty() && timed_out_.empty());
}

TEST(MissingTransform, NamesFramesTimeAndReason) {
  tf2::BufferCore tf;
  EXPECT_EQ(
      missingTransform(tf, "odom", "base", ros::Time(12.0)).find("odom -> base at 12.000 s: "), 0u);
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "odom";
  transform.child_frame_id = "base";
  transform.transform.rotation.w = 1.0;
  for (const double stamp : {11.0, 13.0}) {
    transform.header.stamp = ros::Time(stamp);
    tf.setTransform(transform, "test");
  }
  EXPECT_EQ(missingTransform(tf, "odom", "base", ros::Time(12.0)), "");
  EXPECT_EQ(missingTransform(tf, "odom", "base", ros::Time(0)), "");
  EXPECT_EQ(
      missingTransform(tf, "odom", "base", ros::Time(14.0)).find("odom -> base at 14.000 s: "), 0u);
  EXPECT_EQ(missingTransform(tf, "base", "laser", ros::Time(0)).find("base -> laser: "), 0u);
}

TEST(DropCounter, CountsByReasonAndRemembersTheLast) {
  DropCounter drops("[/test]", "image");
  drops.drop("no transform", "odom -> base");
  drops.drop("queue full", "3 wait");
  drops.drop("no transform", "odom -> camera");
  EXPECT_EQ(drops.total(), 3u);
  EXPECT_EQ(drops.count("no transform"), 2u);
  EXPECT_EQ(drops.count("refused"), 0u);
  EXPECT_EQ(drops.last(), "no transform: odom -> camera");
  diagnostic_msgs::DiagnosticStatus status;
  drops.report(status);
  std::map<std::string, std::string> values;
  for (const auto& value : status.values) values[value.key] = value.value;
  EXPECT_EQ(values,
            (std::map<std::string, std::string>{{"images dropped", "3"},
                                                {"dropped: no transform", "2"},
                                                {"dropped: queue full", "1"},
                                                {"last dropped", "no transform: odom -> camera"}}));
}

TEST(ResultWait, MessagesWaitForAResultThatIsLateButNotForEver) {
  using Verdict = ResultWait::Verdict;
  ResultWait wait(2.0);
  const auto ask = [&](bool is_there, double now) {
    return wait.ask(is_there, ros::WallTime(now));
  };
  EXPECT_EQ(ask(true, 10.0), Verdict::kGo);
  EXPECT_EQ(ask(false, 11.0), Verdict::kWait);
  EXPECT_EQ(ask(false, 12.9), Verdict::kWait);
  EXPECT_EQ(ask(true, 12.95), Verdict::kGo) << "it came while it was waited for";
  EXPECT_EQ(ask(false, 20.0), Verdict::kWait) << "the next one has the whole time again";
  EXPECT_EQ(ask(false, 22.0), Verdict::kGivenUp);
  EXPECT_EQ(ask(false, 22.1), Verdict::kGo) << "said once, and not waited for again";
  EXPECT_EQ(wait.givenUp(), 1u);
  wait.forget();
  EXPECT_EQ(ask(false, 30.0), Verdict::kWait) << "another map";
  EXPECT_EQ(wait.givenUp(), 1u);
}

TEST(ResultWait, NothingIsWaitedForWhereTheLimitIsZero) {
  ResultWait wait(0.0);
  EXPECT_EQ(wait.ask(false, ros::WallTime(5.0)), ResultWait::Verdict::kGivenUp);
}

TEST(RateLimit, LetsPassInTheTimeOfTheData) {
  RateLimit limit(2.0);
  EXPECT_TRUE(limit.pass(ros::Time(10.0)));
  EXPECT_FALSE(limit.pass(ros::Time(10.4)));
  EXPECT_TRUE(limit.pass(ros::Time(10.5)));
  EXPECT_TRUE(limit.pass(ros::Time(3.0)));  // the bag began again
  RateLimit none(-1.0);
  EXPECT_TRUE(none.pass(ros::Time(1.0)));
  EXPECT_TRUE(none.pass(ros::Time(1.0)));
}

ParamLoader loader(std::map<std::string, XmlRpc::XmlRpcValue> values) {
  return ParamLoader(std::make_shared<MapParamSource>(std::move(values)));
}

TEST(RateLimit, RateIsPositiveOrMinusOne) {
  const auto rate = [](double value) {
    ParamLoader parameters = loader({{"rate", value}});
    double out = 5.0;
    loadRate(parameters, "rate", out, "[Hz]");
    return out;
  };
  EXPECT_EQ(rate(-1.0), -1.0);
  EXPECT_EQ(rate(0.5), 0.5);
  for (const double wrong : {0.0, -0.5, 1001.0}) EXPECT_THROW(rate(wrong), ParameterError) << wrong;
}

TEST(ScanInputParams, FramesLoseTheirSlashAndMustDiffer) {
  const auto load = [](std::map<std::string, XmlRpc::XmlRpcValue> values) {
    ParamLoader parameters = loader(std::move(values));
    ScanInputParams params;
    loadScanInputParams(parameters, params);
    return params;
  };
  const ScanInputParams params = load({{"odom_frame_id", "/odometry"}, {"scan_queue_size", 5}});
  EXPECT_EQ(params.odom_frame_id, "odometry");
  EXPECT_EQ(params.base_frame_id, "base_link");
  EXPECT_EQ(params.queue_size, 5);
  EXPECT_THROW(load({{"base_frame_id", "odom"}}), ParameterError);
  EXPECT_THROW(load({{"base_frame_id", "/"}}), ParameterError);
  EXPECT_THROW(load({{"transform_wait", -1.0}}), ParameterError);
  EXPECT_THROW(load({{"scan_queue_size", 0}}), ParameterError);
}

geometry_msgs::PoseWithCovarianceStamped guess() {
  geometry_msgs::PoseWithCovarianceStamped msg;
  msg.header.frame_id = "/map";
  msg.pose.pose.position.x = 2.0;
  msg.pose.pose.orientation.w = 1.0;
  msg.pose.covariance[0] = 0.25;
  msg.pose.covariance[7] = 0.04;
  msg.pose.covariance[35] = 0.01;
  return msg;
}

TEST(InitialPose, HasTheDeviationsOfTheMessage) {
  const InitialPose pose = initialPoseFromMsg(guess(), "map", "initialpose");
  EXPECT_EQ(pose.base_in_map.x, 2.0);
  EXPECT_DOUBLE_EQ(pose.stddev.x, 0.5);
  EXPECT_DOUBLE_EQ(pose.stddev.y, 0.2);
  EXPECT_DOUBLE_EQ(pose.stddev.theta, 0.1);
}

TEST(InitialPose, RefusalsNameTheSourceAndWhatIsWrong) {
  const auto refusal = [](const geometry_msgs::PoseWithCovarianceStamped& msg) {
    return messageOf<InputError>([&] { initialPoseFromMsg(msg, "map", "initialpose"); });
  };
  auto msg = guess();
  msg.header.frame_id = "odom";
  EXPECT_NE(refusal(msg).find("initialpose: frame_id"), std::string::npos) << refusal(msg);
  msg = guess();
  msg.pose.covariance[35] = 0.0;
  EXPECT_NE(refusal(msg).find("covariance of yaw"), std::string::npos) << refusal(msg);
  msg = guess();
  msg.pose.pose.position.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(msg), "");
}

}  // namespace
}  // namespace hyselam
