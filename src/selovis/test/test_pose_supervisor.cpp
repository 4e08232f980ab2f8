// Supervision by views where the learned frames have poses, else by places.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "hyselam_common/errors.hpp"
#include "selovis/recognition/pose_supervisor.hpp"

namespace selovis {
namespace {

using hyselam::Pose2;

/// A corridor of two rooms of 10 m each, learned in one direction; with poses or without.
PlaceModel corridor(bool with_poses) {
  PlaceModel model;
  model.descriptor = "GRAY";
  model.classifier.kernel = SvmKernel::kExemplar;
  model.transitions.places = {"left", "right"};
  model.transitions.pairs = {{0, 1}};
  model.samples.size = 1;
  const float nothing = 0.0f;
  for (int i = 0; i <= 40; ++i) {
    const Pose2 pose{0.5 * i, 0.0, 0.0};
    model.samples.add(&nothing, i < 20 ? 0 : 1, i, with_poses ? pose : kNoPose);
  }
  return model;
}

/// One frame taken at x while the robot is believed at another x.
class Rig {
 public:
  explicit Rig(const PlaceModel& model, const PoseSupervisorParams& params = {})
      : model_(model), supervisor_(model, model.transitions, params) {}
  SupervisionState look(double x, std::optional<double> believed) {
    std::vector<float> distances;
    for (int i = 0; i <= 40; ++i) {
      const double d = 0.5 * i - x;
      distances.push_back(static_cast<float>(1.0 + std::min(4.0, d * d)));
    }
    const std::vector<double> places =
        x < 10.0 ? std::vector<double>{0.95, 0.05} : std::vector<double>{0.05, 0.95};
    SupervisedFrame frame;
    frame.places = &places;
    frame.view.distances = &distances;
    frame.view.seconds = 0.2;
    if (believed) {
      frame.view.base = Pose2{*believed, 0.0, 0.0};
      frame.expected.agreeing = {*believed < 10.0 ? 0 : 1};
    }
    return supervisor_.update(frame);
  }
  PoseSupervisor& supervisor() { return supervisor_; }

 private:
  PlaceModel model_;
  PoseSupervisor supervisor_;
};

SupervisionState untilAlarm(Rig& rig, double x, double believed) {
  SupervisionState state;
  for (int i = 0; i < 60 && !state.alarm; ++i) state = rig.look(x, believed);
  return state;
}

TEST(PoseSupervisor, ByViewsAnAlarmTellsThePose) {
  Rig rig(corridor(true));
  EXPECT_TRUE(rig.supervisor().comparesViews());
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(rig.look(3.0, 3.0).kidnapped);
  SupervisionState state = untilAlarm(rig, 16.0, 3.0);
  ASSERT_TRUE(state.alarm && state.kidnapped && state.by_views);
  ASSERT_TRUE(state.pose);
  EXPECT_NEAR(state.pose->mean.x, 16.0, 1.0);
  EXPECT_EQ(state.place, 1);
  state = rig.look(16.0, 3.0);
  EXPECT_TRUE(state.kidnapped);
  EXPECT_FALSE(state.alarm) << "raised once";
  rig.supervisor().reset();  // the pose was set
  EXPECT_FALSE(rig.look(16.0, 16.0).kidnapped);
}

TEST(PoseSupervisor, AnAlarmEndsWhenThePoseAgreesAgain) {
  Rig rig(corridor(true));
  ASSERT_TRUE(untilAlarm(rig, 16.0, 3.0).alarm);
  SupervisionState state;
  for (int i = 0; i < 60; ++i) state = rig.look(3.0, 3.0);
  EXPECT_FALSE(state.kidnapped);
  EXPECT_EQ(state.evidence, 0.0);
}

TEST(PoseSupervisor, InOneRoomViewsTellWhatPlacesDoNot) {
  Rig views(corridor(true)), places(corridor(false));
  EXPECT_FALSE(places.supervisor().comparesViews());
  EXPECT_TRUE(untilAlarm(views, 8.0, 1.0).alarm);
  EXPECT_FALSE(untilAlarm(places, 8.0, 1.0).alarm);
  const SupervisionState state = untilAlarm(places, 16.0, 1.0);
  EXPECT_TRUE(state.alarm);
  EXPECT_FALSE(state.by_views || state.pose);
}

TEST(PoseSupervisor, ALostLocalizationIsLocatedByPlaces) {
  Rig rig(corridor(true));
  rig.supervisor().declareLost();
  SupervisionState state;
  for (int i = 0; i < 30; ++i) state = rig.look(16.0, {});
  EXPECT_TRUE(state.kidnapped);
  EXPECT_FALSE(state.tested);
  EXPECT_EQ(state.place, 1);
}

TEST(PoseSupervisor, HoursSetTheThresholdOfBothTests) {
  PoseSupervisorParams params;
  params.views.false_alarm_hours = 1.0;
  const double often = Rig(corridor(true), params).supervisor().threshold();
  params.views.false_alarm_hours = 100.0;
  EXPECT_GT(Rig(corridor(true), params).supervisor().threshold(), often + 3.0);
  params.views.false_alarm_hours = 0.0;
  EXPECT_THROW(Rig(corridor(true), params), hyselam::ParameterError);
}

TEST(PoseSupervisor, BeginsWithWhatTheModelRemembersOfErrors) {
  PlaceModel model = corridor(true);
  const Pose2 door{3.0, 0.0, 0.0}, away{7.0, 0.0, 0.0};
  model.reliability.add(door, {1}, 1.0);
  model.reliability.add(away, {}, 1.0);
  Rig rig(model);
  ASSERT_NE(rig.supervisor().memory(), nullptr);
  EXPECT_EQ(rig.supervisor().memory()->errorRate(door, 1), model.reliability.errorRate(door, 1));
  EXPECT_GT(rig.supervisor().memory()->errorRate(door, 1), 0.3);
  EXPECT_EQ(Rig(corridor(false)).supervisor().memory(), nullptr) << "by places there is none";
}

}  // namespace
}  // namespace selovis
