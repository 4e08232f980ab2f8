// What raises, confirms and ends an alarm about a tracked pose, and what a search that left places
// out says.
#include <gtest/gtest.h>

#include <algorithm>

#include "drawn_room.hpp"
#include "driven_robot.hpp"
#include "fsd_localization/filter/inlier_monitor.hpp"
#include "fsd_localization/localizer.hpp"
#include "fsd_localization/search/alarm_watch.hpp"

using namespace fsd_localization;  // NOLINT: a test, not a header
using hyselam::Pose2;

namespace {

AlarmWatch::Signs strangeSigns() {
  AlarmWatch::Signs signs;
  signs.unmatched = signs.unusual = signs.odd = true;
  return signs;
}

Place placeAt(double x, double seen) {
  Place p;
  p.base = {x, 0.0, 0.0};
  p.seen = seen;
  return p;
}

}  // namespace

TEST(AlarmWatch, aDoubtDoesNotExpireUnconfirmed) {
  AlarmWatch watch;
  EXPECT_TRUE(watch.add(10.0, strangeSigns()));
  EXPECT_TRUE(watch.isDoubtful());
  for (double way = 10.1; way < 40.0; way += 0.1) watch.add(way, {});  // nothing odd any more
  EXPECT_TRUE(watch.isOpen());
  EXPECT_TRUE(watch.isDoubtful()) << "nobody has looked whether another place is better";
  watch.confirm();
  EXPECT_FALSE(watch.isDoubtful());
  watch.add(40.1, {});
  EXPECT_FALSE(watch.isOpen());
}

TEST(AlarmWatch, whatComesAndGoesIsOneAlarm) {
  AlarmWatch watch;
  int new_ones = 0;
  for (int i = 0; i < 40; ++i) {  // each second update is strange
    new_ones += watch.add(10.0 + 0.1 * i, i % 2 == 0 ? strangeSigns() : AlarmWatch::Signs{});
  }
  EXPECT_EQ(new_ones, 1) << "each of them would drop the search that is under way";
  EXPECT_NEAR(*watch.length(13.9), 3.9, 1e-9);
}

TEST(AlarmWatch, scansThatFitTheMapRaiseAQuestionAndNoDoubt) {
  AlarmWatch watch;
  AlarmWatch::Signs unmatched;
  unmatched.unmatched = true;
  EXPECT_TRUE(watch.add(1.0, unmatched));  // a room that the robot has just turned into
  EXPECT_TRUE(watch.isOpen());
  EXPECT_FALSE(watch.isDoubtful());
  EXPECT_FALSE(watch.looksCarried());
  EXPECT_FALSE(watch.isSharp());
  AlarmWatch::Signs low;
  low.low = true;
  EXPECT_TRUE(watch.add(1.5, low)) << "from here on it is the map that does not fit";
  EXPECT_TRUE(watch.isSharp());
  EXPECT_EQ(*watch.length(1.5), 0.0);
}

TEST(AlarmWatch, aConfirmedAlarmThatGoesOnRaisesNoDoubtAgain) {
  AlarmWatch watch;
  AlarmWatch::Signs low;
  low.low = low.very_low = true;
  watch.add(1.0, low);
  EXPECT_TRUE(watch.isDoubtful());
  watch.confirm();
  watch.add(1.1, low);
  EXPECT_TRUE(watch.isOpen());
  EXPECT_FALSE(watch.isDoubtful());
  EXPECT_TRUE(watch.add(1.2, strangeSigns())) << "perhaps elsewhere: a new alarm";
  EXPECT_TRUE(watch.isDoubtful());
}

TEST(AlarmWatch, theSecondScanThatFitsNothingGoesOnWithTheAlarmOfTheFirst) {
  AlarmWatch::Signs first, second;
  first.unmatched = first.odd = true;
  second.odd = second.unusual = true;
  AlarmWatch watch;
  EXPECT_TRUE(watch.add(10.0, first));
  EXPECT_FALSE(watch.looksCarried()) << "one scan is no reason";
  EXPECT_FALSE(watch.add(10.9, second)) << "the search that is under way is about the same place";
  EXPECT_TRUE(watch.looksCarried());
  EXPECT_TRUE(watch.isDoubtful());
  EXPECT_NEAR(*watch.length(10.9), 0.9, 1e-9);
}

TEST(AlarmWatch, whatFitsNothingLaterThanTheAlarmIsAnother) {
  AlarmWatch::Signs odd, jump;
  odd.odd = true;
  jump.unmatched = jump.odd = jump.unusual = true;
  AlarmWatch watch;
  EXPECT_TRUE(watch.add(10.0, odd));
  EXPECT_TRUE(watch.add(10.9, jump)) << "what was asked about may be of the place before";
  EXPECT_EQ(*watch.length(10.9), 0.0);
}

TEST(AlarmWatch, isAskedAboutLessAndLessUnlessAnAnswerSpokeAgainstThePose) {
  AlarmWatch watch;
  AlarmWatch::Signs worse;
  worse.worse = true;
  watch.add(1.0, worse);
  EXPECT_EQ(watch.step(), 0.5);
  watch.answered(false);
  EXPECT_EQ(watch.step(), 1.0);
  watch.answered(true);
  EXPECT_EQ(watch.step(), 1.0) << "two scans more may be enough to tell";
  for (int i = 0; i < 10; ++i) watch.answered(false);
  EXPECT_EQ(watch.step(), AlarmWatch::kLargestStep);
  EXPECT_TRUE(watch.add(9.0, strangeSigns()));
  EXPECT_EQ(watch.step(), 0.5) << "another alarm";
  for (int i = 0; i < 10; ++i) watch.answered(false);
  EXPECT_EQ(watch.step(), AlarmWatch::kLargestDoubtfulStep);
}

TEST(InlierMonitor, oneScanIsOddAndTwoAreUnusualHoweverFarApart) {
  InlierMonitor monitor;
  for (int i = 0; i < 30; ++i) monitor.add(0.95, 1.0);  // each scan a metre after the other
  monitor.add(0.2, 1.0);
  EXPECT_TRUE(monitor.isOdd(0.75));
  EXPECT_TRUE(monitor.isUsual(0.75));
  EXPECT_FALSE(monitor.isBelow(0.45, 0.85));
  monitor.add(0.2, 1.0);
  EXPECT_FALSE(monitor.isUsual(0.75));
  EXPECT_TRUE(monitor.isBelow(0.45, 0.85));
}

TEST(InlierMonitor, whatIsAcceptedIsNormalAndWhatComesAfterIsComparedWithIt) {
  InlierMonitor monitor;
  for (int i = 0; i < 60; ++i) monitor.add(0.95, 0.5);
  for (int i = 0; i < 10; ++i) monitor.add(0.7, 0.5);
  EXPECT_TRUE(monitor.isBelow(0.45, 0.85));
  monitor.accept();
  EXPECT_FALSE(monitor.isBelow(0.45, 0.85));
  monitor.add(0.3, 0.5);
  monitor.add(0.3, 0.5);
  EXPECT_FALSE(monitor.isUsual(0.75)) << "a jump right after it is seen";
}

TEST(PlaceJudge, placesThatASearchLeftOutAreNotTakenForAbsent) {
  SearchAnswer answer;
  answer.length = 2.0;
  answer.places = {placeAt(0, 0.9)};
  const double alone = judge(answer)->probability;
  answer.believed = placeAt(0, 0.9);  // what is 0.1 worse on the lattice was not looked at
  EXPECT_LT(judge(answer)->probability, alone);
  EXPECT_NEAR(judge(answer)->probability, probabilityOfPlace(0.9, 0.8, 2.0), 1e-9);
  EXPECT_GT(judge(answer)->probability, 0.5) << "enough to confirm a pose";
}

TEST(PlaceJudge, turnsCountAsTravel) {
  SearchAnswer answer;
  answer.places = {placeAt(0, 0.8), placeAt(20, 0.75)};
  const double standing = judge(answer)->probability;
  answer.turned = 6.0;
  EXPECT_NEAR(judge(answer)->probability, probabilityOfPlace(0.8, 0.75, 3.0), 1e-9);
  EXPECT_GT(judge(answer)->probability, standing);
}

TEST(PlaceJudge, aBeatenPoseIsToldHowHopelessItIsAndStaysAHypothesis) {
  SearchAnswer answer;
  answer.length = 1.0;
  answer.places = {placeAt(0, 0.94), placeAt(20, 0.93)};
  answer.believed = placeAt(60, 0.4);
  const auto v = judge(answer);
  ASSERT_TRUE(v);
  EXPECT_FALSE(v->best_is_believed);
  EXPECT_LT(v->probability, 0.95) << "nobody knows which of the two it is";
  EXPECT_LT(v->believed_probability, 1e-6) << "but not the believed one";
  ASSERT_EQ(v->hypotheses.size(), 3U);
  EXPECT_EQ(v->hypotheses.back().base.x, 60.0);
}

TEST(Localizer, aRobotThatIsCarriedOffAndOnlyTurnsIsFound) {
  DrivenRobot robot;
  std::optional<LocalizationResult> last;
  for (int i = 0; i < 300; ++i) {
    robot.drive(i < 150 ? Pose2{0.02, 0.0, 0.02} : Pose2{0.0, 0.0, 0.05});
    if (i == 150) robot.carryOff();
    if (const auto r = robot.see(0.1 * i)) last = r;
  }
  ASSERT_TRUE(last);
  EXPECT_TRUE(last->converged);
  EXPECT_LT(distance(last->base_in_map, robot.at), 0.2);
}

// The answer that gives up the old pose is sure enough of another one: no update is lost between.
TEST(Localizer, isFoundByTheAnswerThatSaysItWasCarriedOff) {
  DrivenRobot robot;
  int lost = 0, wrong = 0;
  bool found = false;
  std::optional<LocalizationResult> last;
  for (int i = 0; i < 40; ++i) {  // half a metre between scans
    robot.drive({0.5, 0.0, 0.5});
    if (i == 25) robot.carryOff();
    last = robot.see(1.0 * i);
    ASSERT_TRUE(last);
    lost += last->phase == Phase::kLost;
    const bool is_wrong = distance(last->base_in_map, robot.at) > 0.5;
    if (i >= 25 && wrong > 0 && !is_wrong && !found) {
      found = true;
      EXPECT_TRUE(robot.localizer.shortTermPoints(last->base_in_map).empty())
          << "seen from the old pose";
    }
    wrong += is_wrong;
  }
  EXPECT_TRUE(found);
  EXPECT_GT(wrong, 0) << "the jump was seen";
  EXPECT_EQ(lost, 0);
  EXPECT_TRUE(last->converged);
  EXPECT_LT(distance(last->base_in_map, robot.at), 0.2);
}

namespace {

/// Two rooms and a wall between them; the second one with a pillar.
hyselam::OccupancyGrid twoRooms() {
  return hyselam::testing::drawnGrid({"#########",  //
                                      "#####...#",  //
                                      "#...#...#",  //
                                      "#...#.#.#",  //
                                      "#...#...#",  //
                                      "#####...#",  //
                                      "#########"},
                                     0.1, {3, 15, 15, 15, 3, 45, 10, 25, 3},
                                     {3, 20, 30, 10, 15, 15, 3});
}

/// Stamps at which another answer of the search counted, for a robot that drives circles and, if
/// `leaps_at` is a time, is in the second room from then on: its wheels know, its laser saw nothing
/// of the way.
std::vector<double> answersOf(double latency, double leaps_at) {
  const auto map = twoRooms();
  const GridRayCaster rays(map);
  LocalizerParams params;
  params.search_latency = latency;
  Localizer localizer(map, params);
  Pose2 at{2.5, 3.2, 0.0};
  localizer.setInitialPose(at, {0.1, 0.1, 0.05});
  std::vector<double> stamps;
  double last = -1.0;
  for (int i = 0; i < 400; ++i) {
    const double stamp = 0.1 * i;
    at = at * Pose2{0.05, 0.0, 0.04};
    const double aside = stamp >= leaps_at ? 4.8 : 0.0;
    const Pose2 here{at.x + aside, at.y, at.theta};
    const auto r = localizer.update(look(rays, here, stamp), here);
    if (!r || !r->place_probability || *r->place_probability == last) continue;
    last = *r->place_probability;
    stamps.push_back(stamp);
  }
  return stamps;
}

}  // namespace

TEST(Localizer, whatWasAskedBeforeAnAlarmDoesNotConfirmIt) {
  constexpr double kLatency = 2.0;
  const std::vector<double> usual = answersOf(kLatency, 1e9);
  ASSERT_GE(usual.size(), 2U);
  const double checked = usual.back();
  // In a room that was not seen before, where everything fits the map: while the check is under
  // way.
  const double leap = checked - 0.5 * kLatency;
  const std::vector<double> answers = answersOf(kLatency, leap);
  ASSERT_GT(answers.back(), leap) << "the alarm is looked into";
  for (double stamp : answers) {
    // The scan of the leap itself may be asked about; scans are 0.1 s apart.
    EXPECT_TRUE(stamp < leap || stamp > leap + kLatency - 0.05)
        << "an answer about the room before";
  }
}

TEST(Localizer, aLocalMapThatNobodyAsksForChangesNoPoseAndBeginsAnewWhenAsked) {
  const auto map = room();
  const GridRayCaster rays(map);
  Localizer kept(map, LocalizerParams{}), not_kept(map, LocalizerParams{});
  const auto known = [](const Localizer& l) {
    const auto cells = l.localMap().toGrid().cells;
    return std::count_if(cells.begin(), cells.end(), [](std::int8_t v) { return v >= 0; });
  };
  for (Localizer* l : {&kept, &not_kept}) l->setInitialPose({2.0, 2.0, 0.0}, {0.2, 0.2, 0.1});
  not_kept.keepLocalMap(false);
  Pose2 at{2.0, 2.0, 0.0};
  int updates = 0;
  for (int i = 0; i < 120; ++i) {
    at = at * Pose2{0.02, 0.0, 0.02};
    const hyselam::LaserScan scan = look(rays, at, 0.1 * i);
    const auto a = kept.update(scan, at), b = not_kept.update(scan, at);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) continue;
    ++updates;
    EXPECT_EQ(a->base_in_map.x, b->base_in_map.x);
    EXPECT_EQ(a->base_in_map.theta, b->base_in_map.theta);
  }
  EXPECT_GT(updates, 15);
  EXPECT_GT(known(kept), 0);
  EXPECT_EQ(known(not_kept), 0);
  not_kept.keepLocalMap(true);
  not_kept.update(look(rays, at, 100.0), at);
  EXPECT_GT(known(not_kept), 0);
}
