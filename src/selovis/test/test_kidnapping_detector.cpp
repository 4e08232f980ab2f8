// The sequential test of the pose by the recognized place.
#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "selovis/recognition/kidnapping_detector.hpp"

namespace selovis {
namespace {

/// A row of connected places.
PlaceTransitions chain(int n) {
  PlaceTransitions g;
  for (int i = 0; i < n; ++i) {
    g.places.push_back("place " + std::to_string(i));
    if (i > 0) g.pairs.emplace_back(i - 1, i);
  }
  return g;
}

/// A frame that shows the place `seen` with that probability.
std::vector<double> sees(int n, int seen, double probability = 0.9) {
  std::vector<double> p(static_cast<std::size_t>(n), (1.0 - probability) / (n - 1));
  p[static_cast<std::size_t>(seen)] = probability;
  return p;
}

TEST(KidnappingDetector, PoseThatAgreesRaisesNoEvidence) {
  KidnappingDetector s(chain(8), {});
  for (int i = 0; i < 1000; ++i) {
    const KidnappingState r = s.update(sees(8, 3), {3});
    EXPECT_TRUE(r.tested);
    EXPECT_FALSE(r.kidnapped);
    EXPECT_EQ(r.evidence, 0.0);
  }
}

TEST(KidnappingDetector, KidnappedRobotIsDetectedInAFewFramesAndLocated) {
  KidnappingDetector s(chain(8), {});
  for (int i = 0; i < 50; ++i) s.update(sees(8, 3), {3});
  int frames = 0;
  KidnappingState r;
  do {
    r = s.update(sees(8, 6, 0.97), {3});
    ASSERT_LT(++frames, 8);
  } while (!r.alarm);
  EXPECT_GT(frames, 2) << "no single frame is enough";
  EXPECT_TRUE(r.kidnapped);
  EXPECT_EQ(r.place, 6);
  // The alarm stays, and is raised once; then the pose is corrected.
  EXPECT_FALSE(s.update(sees(8, 6), {3}).alarm);
  for (int i = 0; i < 40; ++i) r = s.update(sees(8, 6), {6});
  EXPECT_FALSE(r.kidnapped);
  EXPECT_EQ(r.evidence, 0.0);
}

TEST(KidnappingDetector, ContradictingFramesRaiseNoAlarm) {
  // One of four frames sees some other place: a classifier at 75 %, whose mistakes are scattered.
  hyselam::Rng rng(3);
  KidnappingDetector s(chain(12), {});
  for (int i = 0; i < 4000; ++i) {
    const int seen = i % 4 == 0 ? static_cast<int>(rng.below(12)) : 5;
    EXPECT_FALSE(s.update(sees(12, seen), {5}).kidnapped) << i;
  }
}

TEST(KidnappingDetector, AllExpectedPlacesAgreeWithThePose) {
  KidnappingDetector s(chain(5), {});
  for (int i = 0; i < 200; ++i) EXPECT_FALSE(s.update(sees(5, 2), {1, 2}).kidnapped);
}

TEST(KidnappingDetector, UnmappedPlaceIsNoEvidence) {
  KidnappingDetector s(chain(8), {});
  for (int i = 0; i < 200; ++i) {
    const KidnappingState r = s.update(sees(8, 6), {3}, {6});
    EXPECT_FALSE(r.kidnapped);
    EXPECT_LT(r.evidence, 0.5);
  }
  // An alarm stays meanwhile, until places of the map are seen.
  int frames = 0;
  while (!s.update(sees(8, 0, 0.97), {3}, {6}).kidnapped) ASSERT_LT(++frames, 8);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(s.update(sees(8, 6), {3}, {6}).kidnapped) << i;
  for (int i = 0; i < 20; ++i) s.update(sees(8, 3), {3}, {6});
  EXPECT_FALSE(s.update(sees(8, 3), {3}, {6}).kidnapped);
  // Where all that is left is such a place, there is nothing to compare.
  EXPECT_FALSE(KidnappingDetector(chain(2), {}).update({0.5, 0.5}, {0}, {1}).tested);
}

TEST(KidnappingDetector, NothingIsTestedWithoutAPose) {
  KidnappingDetector s(chain(5), {});
  for (int i = 0; i < 200; ++i) {
    const KidnappingState r = s.update(sees(5, 2), {});
    EXPECT_FALSE(r.tested || r.kidnapped);
  }
  EXPECT_FALSE(KidnappingDetector(chain(1), {}).update({1.0}, {0}).tested)
      << "there is no elsewhere";
  EXPECT_FALSE(s.update(std::vector<double>(5, 0.0), {1}).kidnapped)
      << "a frame without information";
}

TEST(KidnappingDetector, ResetRemovesTheEvidence) {
  KidnappingDetector s(chain(6), {});
  for (int i = 0; i < 30; ++i) s.update(sees(6, 5), {0});
  s.reset();
  const KidnappingState r = s.update(sees(6, 0), {0});
  EXPECT_FALSE(r.kidnapped);
  EXPECT_EQ(r.evidence, 0.0);
}

TEST(KidnappingDetector, LostLocalizationIsLocatedByFrames) {
  KidnappingDetector s(chain(8), {});
  for (int i = 0; i < 50; ++i) s.update(sees(8, 3), {});
  EXPECT_EQ(s.update(sees(8, 3), {}).place, -1) << "not lost yet";
  s.declareLost();
  int frames = 0;
  KidnappingState r;
  do {
    r = s.update(sees(8, 6, 0.97), {});
    EXPECT_TRUE(r.kidnapped);
    EXPECT_FALSE(r.alarm) << "the localization reported it";
    ASSERT_LT(++frames, 8);
  } while (r.place < 0);
  EXPECT_EQ(r.place, 6);
  EXPECT_GT(frames, 1) << "no single frame is enough";
  // The localization has converged, and the camera agrees.
  for (int i = 0; i < 40; ++i) r = s.update(sees(8, 6), {6});
  EXPECT_FALSE(r.kidnapped);
}

TEST(KidnappingDetector, InvalidProbabilitiesAndPlacesAreRefused) {
  KidnappingDetector s(chain(4), {});
  EXPECT_THROW(s.update({0.5, 0.5}, {0}), hyselam::InputError);
  EXPECT_THROW(s.update({0.5, -0.5, 0.0, 1.0}, {0}), hyselam::InputError);
  EXPECT_THROW(s.update({0.5, std::nan(""), 0.0, 1.0}, {0}), hyselam::InputError);
  EXPECT_THROW(s.update(sees(4, 1), {4}), hyselam::InputError);
  EXPECT_THROW(s.update(sees(4, 1), {1}, {-1}), hyselam::InputError);
  KidnappingDetectorParams p;
  p.threshold = 0.0;
  EXPECT_THROW(KidnappingDetector(chain(4), p), hyselam::ParameterError);
}

}  // namespace
}  // namespace selovis
