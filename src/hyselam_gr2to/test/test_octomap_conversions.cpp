#include <gtest/gtest.h>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_gr2to/ros/octomap_conversions.hpp"

namespace hyselam_topo {
namespace {

using hyselam::testing::messageOf;

TEST(Conversions, LargeOctomapIsRefusedUnread) {
  octomap_msgs::Octomap msg;
  msg.id = "no tree at all";
  msg.data.resize(11);
  OctoMapLimits limits;
  limits.max_bytes = 10;
  const std::string message =
      messageOf<hyselam::InputError>([&] { fromMsg(msg, "octomap", limits); });
  EXPECT_NE(message.find("11 bytes"), std::string::npos) << message;
}

}  // namespace
}  // namespace hyselam_topo
