// A robot that is carried off and left standing, and people who stand around one that is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "drawn_room.hpp"
#include "fsd_localization/localizer.hpp"
#include "fsd_localization/search/place_search.hpp"
#include "fsd_localization/search/standing_watch.hpp"
#include "fsd_localization/search/submap.hpp"

using namespace fsd_localization;  // NOLINT: a test, not a header
using hyselam::Pose2;

namespace {

constexpr double kLow = 0.45, kFits = 0.75;

using Hidden = std::vector<float>;

/// Tracks the robot from a pose that is told, over two metres.
struct Tracked {
  hyselam::OccupancyGrid map = room();
  GridRayCaster rays{map};
  Localizer localizer{map, LocalizerParams{}};
  Pose2 at{2.0, 2.0, 0.0}, wheels = at;
  double now = 0.0;
  std::optional<LocalizationResult> last;
  bool was_lost = false;

  explicit Tracked(int scans = 100) {
    localizer.setInitialPose(at, {0.2, 0.2, 0.1});
    drive(scans);
    was_lost = false;
  }
  /// @param hidden beams of the scan that end 0.4 m before the laser.
  void look(const Pose2& step, std::size_t hidden = 0) { look(step, Hidden(hidden, 0.4F)); }
  /// @param hidden ranges of the first beams [m], where they are not shorter anyway.
  void look(const Pose2& step, const Hidden& hidden) {
    at = at * step;
    wheels = wheels * step;
    hyselam::LaserScan scan = ::look(rays, at, now += 0.1);
    for (std::size_t b = 0; b < hidden.size(); ++b) {
      scan.ranges[b] = std::min(scan.ranges[b], hidden[b]);
    }
    const auto result = localizer.update(scan, wheels);
    if (!result) return;
    last = result;
    was_lost = was_lost || result->phase != Phase::kTracking;
  }
  void drive(int scans) {
    for (int i = 0; i < scans; ++i) look({0.02, 0.0, 0.02});
  }
  void stand(double seconds, std::size_t hidden = 0) { stand(seconds, Hidden(hidden, 0.4F)); }
  void stand(double seconds, const Hidden& hidden) {
    for (int i = 0; i < 10 * seconds; ++i) look({}, hidden);
  }
};

/// Something that hides most of the map: boards of 10 to 40 beams at 0.4 to 1.5 m, side by side.
Hidden boards(std::mt19937& random, double share) {
  std::uniform_int_distribution<int> wide(10, 40);
  std::uniform_real_distribution<float> far(0.4F, 1.5F);
  Hidden hidden;
  while (static_cast<double>(hidden.size()) < share * 181.0) {
    hidden.insert(hidden.end(), static_cast<std::size_t>(wide(random)), far(random));
  }
  hidden.resize(static_cast<std::size_t>(share * 181.0));
  return hidden;
}

/// Carries the robot to a place that explains so much of what it should see, if chance finds one.
/// @param far from the tracked pose: at most so far along each axis [m], and turned [rad].
bool carry(Tracked& robot, std::mt19937& random, const Pose2& far, double from, double to) {
  const LikelihoodFieldModel field(robot.map);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  const Pose2 tracked = robot.last->base_in_map;
  for (int i = 0; i < 1000; ++i) {
    const Pose2 at{tracked.x + far.x * share(random), tracked.y + far.y * share(random),
                   tracked.theta + far.theta * share(random)};
    const bool inside = at.x > 0.5 && at.x < 11.5 && at.y > 0.5 && at.y < 7.5;
    if (!inside || distance(at, tracked) < 1.5) continue;
    if (robot.rays.range(at.x, at.y, at.theta, 1.0) < 0.5) continue;
    const auto fits = field.inlierRatio(look(robot.rays, at, 0.0), tracked, 0.3);
    if (!fits || *fits < from || *fits > to) continue;
    robot.at = at;
    return true;
  }
  return false;
}

}  // namespace

TEST(StandingWatch, takesSecondsWithoutException) {
  StandingWatch watch;
  double t = 0.0;
  for (; t < 4.9; t += 0.1) EXPECT_FALSE(watch.add(t, 0.3, kLow, kFits));
  EXPECT_FALSE(watch.add(t, 0.5, kLow, kFits));  // somebody stepped aside
  for (double end = t + 4.9; t < end; t += 0.1) EXPECT_FALSE(watch.add(t, 0.3, kLow, kFits));
  EXPECT_FALSE(watch.isLow());
  EXPECT_FALSE(watch.add(t + 0.3, {}, kLow, kFits)) << "a scan without returns says nothing";
  EXPECT_TRUE(watch.add(t + 0.3, 0.3, kLow, kFits));
  EXPECT_TRUE(watch.isLow());
}

TEST(StandingWatch, twoScansFarApartAreTooFew) {
  StandingWatch watch;
  EXPECT_FALSE(watch.add(0.0, 0.3, kLow, kFits));
  EXPECT_FALSE(watch.add(60.0, 0.3, kLow, kFits));
  EXPECT_FALSE(watch.isLow());
}

TEST(StandingWatch, endsWhenTheScansFitAgainOrTheRobotMoves) {
  StandingWatch watch;
  double t = 0.0;
  for (; t < 6.0; t += 0.1) watch.add(t, 0.3, kLow, kFits);
  ASSERT_TRUE(watch.isLow());
  for (double end = t + 20.0; t < end; t += 0.1) {
    EXPECT_FALSE(watch.add(t, 0.6, kLow, kFits)) << "neither low nor good";
  }
  ASSERT_TRUE(watch.isLow());
  int changes = 0;
  for (double end = t + 6.0; t < end; t += 0.1) changes += watch.add(t, 0.9, kLow, kFits);
  EXPECT_EQ(changes, 1);
  EXPECT_FALSE(watch.isLow());
  for (double end = t + 6.0; t < end; t += 0.1) watch.add(t, 0.3, kLow, kFits);
  watch.reset();
  EXPECT_FALSE(watch.isLow());
}

TEST(Localizer, carriedOffAndLeftStandingIsNotRelied) {
  Tracked robot;
  ASSERT_TRUE(robot.last && robot.last->converged);
  robot.at = {9.0, 6.0, -2.0};
  robot.stand(StandingWatch::kSeconds - 1.0);
  EXPECT_FALSE(robot.last->misfits_standing);
  robot.stand(3.0);
  ASSERT_LT(*robot.last->inlier_ratio, kLow) << "the place is too alike to tell anything";
  EXPECT_FALSE(robot.last->converged);
  EXPECT_TRUE(robot.last->misfits_standing);
  const Eigen::Matrix3d& covariance = robot.last->covariance;
  EXPECT_GE(covariance(0, 0), 1.0) << "nor does it look certain";
  EXPECT_GE(covariance(1, 1), 1.0);
  EXPECT_GT(3.0 * std::sqrt(covariance(0, 0) + covariance(1, 1)),
            distance(robot.last->base_in_map, robot.at))
      << "the search has found where it is, too";
  robot.drive(150);
  EXPECT_TRUE(robot.last->converged);
  EXPECT_FALSE(robot.last->misfits_standing);
  EXPECT_LT(distance(robot.last->base_in_map, robot.at), 0.2);
}

TEST(Localizer, peopleAroundAStandingRobotRaiseNoDoubtWhileWallsAreSeen) {
  Tracked robot;
  robot.stand(30.0, 90);  // half of what it sees
  EXPECT_TRUE(robot.last->converged);
  EXPECT_FALSE(robot.last->misfits_standing);
  EXPECT_LT(distance(robot.last->base_in_map, robot.at), 0.1);
}

TEST(Localizer, aStandingRobotIsSureAgainWhenPeopleHaveGone) {
  Tracked robot;
  robot.stand(10.0, 150);
  EXPECT_TRUE(robot.last->misfits_standing);
  robot.stand(10.0);
  EXPECT_FALSE(robot.last->misfits_standing);
  EXPECT_TRUE(robot.last->converged);
  EXPECT_LT(distance(robot.last->base_in_map, robot.at), 0.1);
}

// No place explains boards; one scan of what is left is no reason to give up the pose.
TEST(Localizer, aPoseIsKeptHoweverLongBoardsHideTheMap) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Tracked robot(100 + 20 * static_cast<int>(seed));
    ASSERT_TRUE(robot.last->converged);
    const Hidden hidden = boards(random, 0.6 + 0.05 * seed);
    robot.stand(30.0, hidden);
    EXPECT_FALSE(robot.was_lost);
    EXPECT_LT(distance(robot.last->base_in_map, robot.at), 0.2);
    robot.stand(10.0);
    EXPECT_TRUE(robot.last->converged) << "they have gone";
    robot.stand(20.0, hidden);
    robot.drive(150);
    EXPECT_TRUE(robot.last->converged) << "it drove on";
    EXPECT_FALSE(robot.was_lost);
    EXPECT_LT(distance(robot.last->base_in_map, robot.at), 0.2);
  }
}

TEST(Localizer, carriedAnywhereAndLeftStandingIsNotRelied) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Tracked robot(100 + 10 * static_cast<int>(seed));
    ASSERT_TRUE(carry(robot, random, {10.0, 7.0, 3.0}, 0.0, kLow - 0.05));
    robot.stand(8.0);
    EXPECT_TRUE(distance(robot.last->base_in_map, robot.at) < 0.2 || !robot.last->converged);
  }
}

// As much could be hidden by people; but nobody sees through walls.
TEST(Localizer, carriedWhereHalfLooksAlikeAndLeftStandingIsNotRelied) {
  int told = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Tracked robot(100 + 10 * static_cast<int>(seed));
    ASSERT_TRUE(carry(robot, random, {2.5, 2.5, 0.3}, kLow + 0.05, 0.65));
    robot.stand(8.0);
    told += distance(robot.last->base_in_map, robot.at) < 0.2 || !robot.last->converged;
  }
  EXPECT_GE(told, 7) << "one may see walls where it should see boards";
}

TEST(PlaceSearch, boardsAreBeforeWallsAndBeamsOfAnotherPlaceGoThroughThem) {
  const hyselam::OccupancyGrid map = room();
  const GridRayCaster rays(map);
  const PlaceSearch places(map);
  const Pose2 here{3.0, 2.5, 0.4}, elsewhere{9.0, 6.0, -2.0};
  hyselam::LaserScan scan = ::look(rays, here, 0.0);
  const auto blocked = [&](const Pose2& at) {
    SubmapBuilder submap;
    submap.add(scan, {});
    return places.blockedShare(submap.build(), at);
  };
  EXPECT_EQ(blocked(here), 0.0);
  EXPECT_GT(blocked(elsewhere), 0.2);
  for (std::size_t b = 0; b < 120; ++b) scan.ranges[b] = std::min(scan.ranges[b], 0.4F);
  EXPECT_EQ(blocked(here), 0.0);
}
