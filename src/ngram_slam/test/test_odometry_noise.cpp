// What the scans teach about the noise of odometry, on motions whose noise is known.
#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "ngram_slam/slam/odometry_noise.hpp"

namespace ngram_slam {
namespace {

using hyselam::Pose2;

/// Scans that see walls all round, to 2 cm and 5 mrad.
Eigen::Matrix3d roomInformation() {
  return Eigen::Vector3d(2500.0, 2500.0, 40000.0).asDiagonal();
}

struct Noise {
  double position, heading;  // times what the model says
};

/// Drives `keyframes` of a meter, every third with a turn.
void drive(int keyframes, const Noise& noise, hyselam::Rng* rng, OdometryNoiseLearner* learner,
           const Eigen::Matrix3d& information = roomInformation()) {
  const OdometryNoise model;
  for (int k = 0; k < keyframes; ++k) {
    const Pose2 motion{1.0, 0.0, k % 3 == 0 ? 0.5 : 0.0};
    const double p = noise.position * model.positionStddev(motion);
    const double h = noise.heading * model.headingStddev(motion);
    const Pose2 correction{rng->gaussian(0.0, p) + rng->gaussian(0.0, 0.02),
                           rng->gaussian(0.0, p) + rng->gaussian(0.0, 0.02),
                           rng->gaussian(0.0, h) + rng->gaussian(0.0, 0.005)};
    learner->add(motion, correction, information);
  }
}

TEST(OdometryNoiseLearner, findsTheScaleOfTheNoise) {
  for (const double truth : {1.0, 3.0, 8.0}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      hyselam::Rng rng(seed);
      OdometryNoiseLearner learner(OdometryNoise{}, OdometryLearningParams{});
      drive(400, {truth, truth}, &rng, &learner);
      EXPECT_NEAR(learner.positionScale(), truth, 0.25 * truth) << seed;
      EXPECT_NEAR(learner.headingScale(), truth, 0.25 * truth) << seed;
    }
  }
}

TEST(OdometryNoiseLearner, doesNotExceedTheLargestScale) {
  hyselam::Rng rng(1);
  OdometryLearningParams params;
  params.max_scale = 4.0;
  OdometryNoiseLearner learner(OdometryNoise{}, params);
  drive(400, {10.0, 10.0}, &rng, &learner);
  EXPECT_EQ(learner.positionScale(), 4.0);
  EXPECT_EQ(learner.headingScale(), 4.0);
  params.max_scale = 1.0;
  OdometryNoiseLearner off(OdometryNoise{}, params);
  drive(400, {10.0, 10.0}, &rng, &off);
  EXPECT_EQ(off.noise().information({1, 0, 0.3}), OdometryNoise{}.information({1, 0, 0.3}));
}

TEST(OdometryNoiseLearner, neverBelievesMoreThanTheModel) {
  hyselam::Rng rng(7);
  OdometryNoiseLearner learner(OdometryNoise{}, OdometryLearningParams{});
  for (int i = 0; i < 50; ++i) {
    drive(20, {0.05, 0.05}, &rng, &learner);
    EXPECT_EQ(learner.positionScale(), 1.0);
    EXPECT_EQ(learner.headingScale(), 1.0);
  }
}

TEST(OdometryNoiseLearner, tellsPositionFromHeading) {
  hyselam::Rng rng(2);
  OdometryNoiseLearner learner(OdometryNoise{}, OdometryLearningParams{});
  drive(400, {1.0, 5.0}, &rng, &learner);
  EXPECT_LT(learner.positionScale(), 1.3);
  EXPECT_GT(learner.headingScale(), 3.5);
  const Pose2 motion{1.0, 0.0, 0.2};
  EXPECT_DOUBLE_EQ(learner.noise().headingStddev(motion),
                   learner.headingScale() * OdometryNoise{}.headingStddev(motion));
}

TEST(OdometryNoiseLearner, forgetsABadFloorAndIsNotFooledByAWrongMatch) {
  hyselam::Rng rng(3);
  OdometryNoiseLearner learner(OdometryNoise{}, OdometryLearningParams{});
  drive(400, {6.0, 6.0}, &rng, &learner);
  drive(1500, {1.0, 1.0}, &rng, &learner);
  EXPECT_LT(learner.positionScale(), 1.5);
  const double before = learner.positionScale();
  learner.add({1, 0, 0}, {5.0, 5.0, 2.0}, roomInformation());
  EXPECT_LT(learner.positionScale(), 1.1 * before);
}

TEST(OdometryNoiseLearner, learnsAlongACorridorFromItsWallsOnly) {
  // Along it the scans follow odometry: no correction, which tells nothing.
  hyselam::Rng rng(5);
  OdometryNoiseLearner learner(OdometryNoise{}, OdometryLearningParams{});
  const OdometryNoise model;
  const Eigen::Matrix3d walls = Eigen::Vector3d(1e-3, 2500.0, 40000.0).asDiagonal();
  for (int k = 0; k < 400; ++k) {
    const double p = 4.0 * model.positionStddev({1, 0, 0});
    learner.add({1, 0, 0}, {0.0, rng.gaussian(0.0, p), 0.0}, walls);
  }
  EXPECT_NEAR(learner.positionScale(), 4.0, 1.0);
}

TEST(OdometryNoiseLearner, learnsNothingWhereNothingIsSeen) {
  hyselam::Rng rng(6);
  OdometryNoiseLearner learner(OdometryNoise{}, OdometryLearningParams{});
  drive(400, {5.0, 5.0}, &rng, &learner, Eigen::Matrix3d::Zero());
  drive(400, {5.0, 5.0}, &rng, &learner, 1e-6 * Eigen::Matrix3d::Identity());
  EXPECT_LT(learner.positionScale(), 1.01);
  EXPECT_LT(learner.headingScale(), 1.01);
}

TEST(OdometryNoiseLearner, givesTheSameForTheSame) {
  hyselam::Rng one(9), two(9);
  OdometryNoiseLearner a(OdometryNoise{}, OdometryLearningParams{}), b = a;
  drive(300, {2.0, 3.0}, &one, &a);
  drive(300, {2.0, 3.0}, &two, &b);
  EXPECT_EQ(a.positionScale(), b.positionScale());
  EXPECT_EQ(a.headingScale(), b.headingScale());
}

TEST(OdometryLearningParams, refuseValuesOutOfRange) {
  OdometryLearningParams params;
  params.max_scale = 0.5;
  EXPECT_THROW(hyselam::checkParameters(params), hyselam::ParameterError);
}

}  // namespace
}  // namespace ngram_slam
