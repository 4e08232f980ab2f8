// The particle filter over the poses of the training frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_common/testing/files.hpp"
#include "selovis/classifiers/classifier.hpp"
#include "selovis/filters/pose_filter.hpp"

namespace selovis {
namespace {

using hyselam::testing::messageOf;

/// A ring road of radius 5 m with four places, learned by driving round it twice. Opposite places
/// have the same appearance.
struct Ring {
  Ring() {
    samples.size = 2;
    for (int i = 0; i < 200; ++i) {
      const float at[2] = {appearance(angle(i), 0), appearance(angle(i), 1)};
      samples.add(at, placeAt(angle(i)), i, pose(i));
    }
  }
  static double angle(double i) { return 2.0 * hyselam::kPi * i / 100.0; }
  static int placeAt(double angle) {
    return static_cast<int>(std::fmod(angle, 2.0 * hyselam::kPi) / (0.5 * hyselam::kPi));
  }
  static float appearance(double angle, int axis) {
    // Twice the angle: opposite sides of the ring look the same, except for one quarter.
    if (std::fmod(angle, 2.0 * hyselam::kPi) < 0.5 * hyselam::kPi) return 3.0f;
    return static_cast<float>(1.0 +
                              0.5 * (axis == 0 ? std::cos(2.0 * angle) : std::sin(2.0 * angle)));
  }
  static hyselam::Pose2 pose(double i) {
    return {5.0 * std::cos(angle(i)), 5.0 * std::sin(angle(i)), angle(i) + 0.5 * hyselam::kPi};
  }
  /// Drives round once from step 5; returns the share of frames in the right place after the first
  /// quarter.
  double drive(PoseFilter& filter, bool odometry) const {
    ClassifierParams params;
    params.kernel = SvmKernel::kExemplar;
    params.power = 1.0;
    const auto classifier = trainClassifier(samples, 4, params).classifier;
    const hyselam::Pose2 frame{3.0, -7.0, 1.0};
    std::vector<double> p(4);
    int right = 0;
    for (int i = 5; i < 105; ++i) {
      const float at[2] = {appearance(angle(i), 0), appearance(angle(i), 1)};
      classifier->predict(at, p.data());
      filter.update(*classifier->distances(),
                    odometry ? std::optional<hyselam::Pose2>(frame * pose(i)) : std::nullopt);
      const auto& state = filter.probabilities();
      const int place =
          static_cast<int>(std::max_element(state.begin(), state.end()) - state.begin());
      if (i >= 30) right += place == placeAt(angle(i));
    }
    return right / 75.0;
  }
  Samples samples;
};

TEST(PoseFilter, OdometryDistinguishesPlacesOfEqualAppearance) {
  const Ring ring;
  PoseFilterParams params;
  params.injection_rate = 0.0;
  PoseFilter filter(ring.samples, 4, params);
  EXPECT_GT(ring.drive(filter, true), 0.9);
  double sum = 0.0;
  for (const double p : filter.probabilities()) sum += p;
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(PoseFilter, IsDeterministicAlsoAfterReset) {
  const Ring ring;
  PoseFilter a(ring.samples, 4, {}), b(ring.samples, 4, {});
  ring.drive(a, true);
  ring.drive(b, true);
  EXPECT_EQ(a.probabilities(), b.probabilities());
  const std::vector<double> first = a.probabilities();
  a.reset();
  EXPECT_EQ(a.probabilities(), std::vector<double>(4, 0.25));
  ring.drive(a, true);
  EXPECT_EQ(a.probabilities(), first);
  ring.drive(a, false);  // without odometry it only has to stay valid
  for (const double p : a.probabilities()) EXPECT_TRUE(p >= 0.0 && p <= 1.0);
}

/// Distances of step i of the ring to all samples, as the exemplar kernel gives them.
std::vector<float> distancesAt(const Ring& ring, double i) {
  std::vector<float> d;
  for (std::size_t s = 0; s < ring.samples.count(); ++s) {
    const float x = ring.samples.row(s)[0] - Ring::appearance(Ring::angle(i), 0),
                y = ring.samples.row(s)[1] - Ring::appearance(Ring::angle(i), 1);
    d.push_back(x * x + y * y + 0.01f);
  }
  return d;
}

/// Drives a quarter round; `odometry(i)` at step i, one step per `seconds`.
template <typename F>
std::vector<double> quarterRound(const Ring& ring, F odometry, double seconds = 1.0) {
  PoseFilterParams params;
  params.injection_rate = 0.0;
  PoseFilter filter(ring.samples, 4, params);
  for (int i = 5; i < 45; ++i) filter.update(distancesAt(ring, i), odometry(i), seconds);
  return filter.probabilities();
}

TEST(PoseFilter, OdometryThatIsNotFiniteOrJumpsIsNotUsed) {
  const Ring ring;
  const double nan = std::nan("");
  using Odometry = std::optional<hyselam::Pose2>;
  const auto with = [&](const Odometry& odd) {
    return quarterRound(ring, [&](int i) { return i == 30 ? odd : Odometry(Ring::pose(i)); });
  };
  const auto without = with({});
  EXPECT_GT(without[1], 0.9);
  EXPECT_EQ(with(hyselam::Pose2{nan, 0.0, 0.0}), without);
  EXPECT_EQ(with(hyselam::Pose2{0.0, 0.0, nan}), without);
  // To the other end of the world, and begun again from elsewhere: the places before are kept.
  for (const double x : {1e300, -1e9, 100.0}) {
    const auto p = quarterRound(ring, [&](int i) {
      hyselam::Pose2 pose = Ring::pose(i);
      if (i >= 30) pose.x += x;
      return Odometry(pose);
    });
    EXPECT_GT(p[1], 0.9) << x;
  }
}

TEST(PoseFilter, SurvivesTimeThatGoesBackOrIsNotFinite) {
  const Ring ring;
  for (const double seconds : {-100.0, std::nan(""), 0.0, 1e12}) {
    for (const bool odometry : {false, true}) {
      const auto p = quarterRound(
          ring,
          [&](int i) {
            return odometry ? std::optional<hyselam::Pose2>(Ring::pose(i)) : std::nullopt;
          },
          seconds);
      EXPECT_NEAR(p[0] + p[1] + p[2] + p[3], 1.0, 1e-9) << seconds;
    }
  }
}

TEST(PoseFilter, BeginsAgainWhenAllParticlesLeaveTheTrainingPoses) {
  const Ring ring;
  PoseFilterParams params;
  params.injection_rate = 0.0;
  PoseFilter filter(ring.samples, 4, params), fresh(ring.samples, 4, params);
  filter.update(distancesAt(ring, 10), hyselam::Pose2{0.0, 0.0, 0.0});
  filter.update(distancesAt(ring, 10), hyselam::Pose2{900.0, 0.0, 0.0}, 1000.0);
  fresh.update(distancesAt(ring, 10), {});
  EXPECT_EQ(filter.probabilities(), fresh.probabilities());
  EXPECT_GT(filter.probabilities()[0], 0.9);
}

TEST(PoseFilter, FindsAKidnappedRobotAgainAtThirtyFramesASecond) {
  const Ring ring;
  PoseFilterParams params;
  params.particles = 200;  // 0.13 of a particle is set anew in each frame
  PoseFilter filter(ring.samples, 4, params);
  const hyselam::Pose2 still;
  for (int i = 0; i < 300; ++i) filter.update(distancesAt(ring, 60), still, 1.0 / 30.0);
  for (int i = 0; i < 1800; ++i) filter.update(distancesAt(ring, 12), still, 1.0 / 30.0);
  EXPECT_GT(filter.probabilities()[0], 0.9);
}

TEST(PoseFilter, RefusesSamplesWithoutPosesAndBadParameters) {
  Ring ring;
  PoseFilterParams params;
  params.particles = 1;
  EXPECT_THROW(PoseFilter(ring.samples, 4, params), hyselam::ParameterError);
  PoseFilter filter(ring.samples, 4, {});
  EXPECT_THROW(filter.update(std::vector<float>(3, 1.0f), {}), hyselam::InputError);
  ring.samples.poses.back().x = 1e9;
  EXPECT_NE(messageOf<hyselam::InputError>([&] { PoseFilter(ring.samples, 4, {}); }).find("5 km"),
            std::string::npos);
  std::fill(ring.samples.poses.begin(), ring.samples.poses.end(), kNoPose);
  EXPECT_NE(messageOf<hyselam::InputError>([&] { PoseFilter(ring.samples, 4, {}); }).find("pose"),
            std::string::npos);
}

}  // namespace
}  // namespace selovis
