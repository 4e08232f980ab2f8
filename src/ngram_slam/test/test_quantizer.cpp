// Density classes: mean shift against its iteration written down plainly, stable ids, renewals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/words/quantizer.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::ParameterError;
using hyselam::testing::messageOf;

namespace {

DensityHistogram histogramOf(const std::vector<std::pair<double, double>>& peaks, int count,
                             std::uint64_t seed, double sigma = 0.02) {
  hyselam::Rng rng(seed);
  DensityHistogram h(256, 0);
  for (int i = 0; i < count; ++i) {
    double u = rng.uniform(), mean = peaks.back().first;
    for (const auto& [at, share] : peaks) {
      mean = at;
      if ((u -= share) < 0.0) break;
    }
    const double v = std::clamp(rng.gaussian(mean, sigma), 0.0, 0.999);
    ++h[static_cast<std::size_t>(v * 256)];
  }
  return h;
}

/// Cheng 1995: a point climbs to the mean of what its window sees, again and again.
double climb(const DensityHistogram& h, double x, double bandwidth) {
  for (int round = 0; round < 100000; ++round) {
    double sum = 0.0, weight = 0.0;
    for (std::size_t i = 0; i < h.size(); ++i) {
      if (h[i] == 0) continue;
      const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(h.size());
      const double z = (at - x) / bandwidth;
      const double w = static_cast<double>(h[i]) * std::exp(-0.5 * z * z);
      sum += w * at;
      weight += w;
    }
    const double next = sum / weight;
    if (std::abs(next - x) < 1e-9) return next;
    x = next;
  }
  return x;
}

std::vector<int> idsOf(const DensityClasses& classes) {
  std::vector<int> ids;
  for (const auto& c : classes.list()) ids.push_back(c.id);
  return ids;
}

void feed(MeanShiftQuantizer& q, double mean, int count, std::uint64_t seed, int* changes) {
  hyselam::Rng rng(seed);
  for (int i = 0; i < count; ++i) *changes += q.add(std::clamp(rng.gaussian(mean, 0.02), 0.0, 1.0));
}

}  // namespace

TEST(DensityClasses, uniformOnesHaveEqualWidth) {
  const auto c = DensityClasses::uniform(8);
  EXPECT_EQ(c.classOf(0.0), 0);
  EXPECT_EQ(c.classOf(0.124), 0);
  EXPECT_EQ(c.classOf(0.126), 1);
  EXPECT_EQ(c.classOf(1.0), 7);
  EXPECT_NE(messageOf<ParameterError>([] { DensityClasses::uniform(0); }), "");
  EXPECT_NE(messageOf<ParameterError>([] {
              DensityClasses({{1, 0.2, 0.5}, {1, 0.7, 1.0}});
            }).find("unique"),
            std::string::npos);
  EXPECT_NE(messageOf<ParameterError>([] {
              DensityClasses({{0, 0.2, 0.5}, {1, 0.7, 0.5}});
            }).find("bound"),
            std::string::npos);
}

TEST(MeanShift, modesAreWhereEveryBinClimbsTo) {
  std::size_t bins = 0, astray = 0;
  for (std::uint64_t round = 0; round < 30; ++round) {
    hyselam::Rng rng(95, round);
    std::vector<std::pair<double, double>> peaks;
    const int n = 1 + static_cast<int>(rng.below(5));
    for (int i = 0; i < n; ++i) peaks.push_back({rng.uniform(0.1, 0.9), 1.0 / n});
    const DensityHistogram h = histogramOf(peaks, 2000, round);
    const double bandwidth = rng.uniform(0.01, 0.06);
    const auto modes = densityModes(h, bandwidth);
    ASSERT_FALSE(modes.empty());
    ASSERT_EQ(modes.front().begin, 0u);
    ASSERT_EQ(modes.back().end, h.size());
    double share = 0.0;
    for (std::size_t m = 0; m < modes.size(); ++m) {
      if (m > 0) {
        ASSERT_EQ(modes[m].begin, modes[m - 1].end);
      }
      share += modes[m].share;
      for (std::size_t i = modes[m].begin; i < modes[m].end; ++i) {
        if (h[i] == 0) continue;
        ++bins;
        const double at = climb(h, (static_cast<double>(i) + 0.5) / 256.0, bandwidth);
        astray += std::abs(at - modes[m].mode) > 1.0 / 256.0;
      }
    }
    ASSERT_NEAR(share, 1.0, 1e-9);
  }
  EXPECT_GT(bins, 2000u);
  // A bin that holds a minimum may climb either way.
  EXPECT_LE(astray, bins / 200);
}

TEST(MeanShift, findsThreeClassesFromTheData) {
  // Fig. 4.3: corridors, corners, crossroads.
  const DensityHistogram h = histogramOf({{0.38, 0.7}, {0.52, 0.2}, {0.68, 0.1}}, 4000, 7);
  const double bandwidth = bandwidthOf(h, 0.02, 12);
  const auto modes = densityModes(h, bandwidth, 0.02);
  ASSERT_EQ(modes.size(), 3u) << "bandwidth " << bandwidth;
  EXPECT_NEAR(modes[0].mode, 0.38, 0.01);
  EXPECT_NEAR(modes[1].mode, 0.52, 0.015);
  EXPECT_NEAR(modes[2].mode, 0.68, 0.015);
  EXPECT_NEAR(modes[0].share, 0.7, 0.03);
  EXPECT_EQ(densityModes(histogramOf({{0.4, 1.0}}, 4000, 8),
                         bandwidthOf(histogramOf({{0.4, 1.0}}, 4000, 8), 0.02, 12), 0.02)
                .size(),
            1u);
}

TEST(MeanShift, weakModesJoinOverTheHigherPass) {
  const DensityHistogram h = histogramOf({{0.3, 0.6}, {0.42, 0.01}, {0.8, 0.39}}, 20000, 5);
  EXPECT_EQ(densityModes(h, 0.015).size(), 3u);
  const auto modes = densityModes(h, 0.015, 0.05);
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_GT(modes[0].end, static_cast<std::size_t>(0.42 * 256));
  EXPECT_TRUE(densityModes(DensityHistogram(256, 0), 0.02).empty());
}

TEST(MeanShift, idsStayWhereModesPersist) {
  const std::vector<DensityClass> old = {{0, 0.3, 0.4}, {1, 0.5, 0.6}, {2, 0.8, 1.0}};
  const auto mode = [](double at, std::size_t begin, std::size_t end) {
    return DensityMode{at, begin, end, 0.3};
  };
  // A new mode between, one gone, one moved a little.
  const auto classes =
      classesOf({mode(0.31, 0, 90), mode(0.4, 90, 120), mode(0.52, 120, 256)}, 256, old, 0.05);
  ASSERT_EQ(classes.size(), 3u);
  EXPECT_EQ(classes[0].id, 0);
  EXPECT_EQ(classes[1].id, 2);  // free since 0.8 is gone
  EXPECT_EQ(classes[2].id, 1);
  EXPECT_NEAR(classes[0].upper, 90.0 / 256, 1e-9);
}

TEST(MeanShiftQuantizer, changesClassesOnlyForNewModes) {
  MeanShiftQuantizer q;
  int changes = 0;
  feed(q, 0.38, 400, 1, &changes);
  EXPECT_EQ(changes, 0);  // uniform until then
  EXPECT_EQ(q.classes().list().size(), 8u);
  for (std::uint64_t i = 0; i < 20; ++i) {
    feed(q, 0.38, 80, 10 + i, &changes);
    feed(q, 0.6, 40, 50 + i, &changes);
  }
  ASSERT_EQ(q.classes().list().size(), 2u);
  const int learnt = changes;
  EXPECT_GE(learnt, 1);
  EXPECT_LE(learnt, 4);
  const auto ids = idsOf(q.classes());
  for (std::uint64_t i = 0; i < 200; ++i) {
    feed(q, 0.38, 80, 100 + i, &changes);
    feed(q, 0.6, 40, 500 + i, &changes);
  }
  EXPECT_EQ(changes, learnt) << "more of the same";
  EXPECT_EQ(idsOf(q.classes()), ids);
  for (std::uint64_t i = 0; i < 60; ++i) feed(q, 0.85, 100, 900 + i, &changes);
  EXPECT_EQ(changes, learnt + 1) << "a new kind of place";
  ASSERT_EQ(q.classes().list().size(), 3u);
  EXPECT_EQ(q.classes().list()[0].id, ids[0]);
  EXPECT_EQ(q.classes().list()[1].id, ids[1]);
}

TEST(MeanShiftQuantizer, continuesFromASavedState) {
  MeanShiftQuantizer a;
  int ignored = 0;
  feed(a, 0.38, 700, 1, &ignored);
  feed(a, 0.6, 700, 2, &ignored);
  MeanShiftQuantizer b;
  b.restore(a.classes(), a.histogram());
  EXPECT_EQ(b.count(), a.count());
  EXPECT_EQ(idsOf(b.classes()), idsOf(a.classes()));
  a.update();
  b.update();
  EXPECT_EQ(idsOf(b.classes()), idsOf(a.classes()));
  EXPECT_NE(messageOf<ParameterError>([&] { b.restore(a.classes(), DensityHistogram(3, 1)); }), "");
}

TEST(MeanShiftQuantizer, refusesParametersOutOfRange) {
  const auto messageFor = [](const std::function<void(MeanShiftParams&)>& change) {
    MeanShiftParams p;
    change(p);
    return messageOf<ParameterError>([&] { MeanShiftQuantizer q(p); });
  };
  EXPECT_EQ(messageFor([](MeanShiftParams&) {}), "");
  EXPECT_NE(messageFor([](MeanShiftParams& p) { p.bandwidth = -1; }).find("bandwidth"),
            std::string::npos);
  EXPECT_NE(messageFor([](MeanShiftParams& p) { p.min_share = 0.7; }).find("min_share"),
            std::string::npos);
  EXPECT_NE(messageFor([](MeanShiftParams& p) { p.tolerance = 0; }).find("tolerance"),
            std::string::npos);
  EXPECT_NE(messageFor([](MeanShiftParams& p) { p.update_growth = 1; }).find("update_growth"),
            std::string::npos);
  EXPECT_NE(messageFor([](MeanShiftParams& p) { p.uniform_classes = 0; }).find("classes"),
            std::string::npos);
}
