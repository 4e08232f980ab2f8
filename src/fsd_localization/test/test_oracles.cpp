// The fast algorithms against their transcriptions from the thesis, on random worlds.
#include <gtest/gtest.h>

#include "fsd_localization/density/free_space_density.hpp"
#include "fsd_localization/density/frontier_count.hpp"
#include "fsd_localization/density/local_map.hpp"
#include "random_worlds.hpp"
#include "transcription/himm.hpp"

using fsd_localization::FreeSpaceDensity;
using fsd_localization::Kernel;
using fsd_localization::KernelProfile;

namespace {
constexpr int kRounds = 10000;
}

TEST(Oracle, densityAndBoundsEqualAlgorithm31) {
  std::mt19937_64 rng(31);
  std::vector<FreeSpaceDensity> fast;
  for (int h : {1, 2, 7, 15, 30, 31, 32, 40, 63, 70}) {
    fast.emplace_back(Kernel(static_cast<KernelProfile>(h % 3), h));
  }
  int undefined = 0, folded = 0;
  for (int round = 0; round < kRounds; ++round) {
    const int w = 1 + static_cast<int>(rng() % 90), h = 1 + static_cast<int>(rng() % 90);
    const auto world = random_worlds::rooms(rng, w, h);
    const auto space = random_worlds::toFreeSpace(world);
    const int x = static_cast<int>(rng() % static_cast<unsigned>(w));
    const int y = static_cast<int>(rng() % static_cast<unsigned>(h));
    const auto& f = fast[rng() % fast.size()];
    const auto plain = transcription::freeSpaceDensity(world, x, y, f.kernel());
    const auto plain_upper = transcription::freeSpaceDensity(world, x, y, f.kernel(), true);
    const auto quick = f.density(space, {x, y});
    SCOPED_TRACE("round " + std::to_string(round) + " radius " +
                 std::to_string(f.kernel().radius()));
    ASSERT_NEAR(quick.soft, plain.soft, 1e-6);
    ASSERT_NEAR(f.soft(space, {x, y}), plain.soft, 1e-6);
    ASSERT_NEAR(quick.upper, plain_upper.soft, 1e-6);
    ASSERT_EQ(quick.hard.has_value(), plain.hard.has_value());
    if (quick.hard) {
      ASSERT_NEAR(*quick.hard, *plain.hard, 1e-6);
    }
    undefined += !quick.hard;
    folded += quick.soft > 0.0 && quick.soft < 0.9;
  }
  EXPECT_GT(undefined, kRounds / 20);  // the worlds do put every branch to the test
  EXPECT_GT(folded, kRounds / 4);
}

TEST(Oracle, frontiersEqualAlgorithm61) {
  std::mt19937_64 rng(61);
  int counts[4] = {0, 0, 0, 0};
  for (int round = 0; round < kRounds; ++round) {
    const auto world = random_worlds::rooms(rng, 80, 70);
    const auto space = random_worlds::toFreeSpace(world);
    const int x = static_cast<int>(rng() % 80), y = static_cast<int>(rng() % 70);
    const int h = 3 + static_cast<int>(rng() % 33);
    const double share = round % 2 == 0 ? 0.05 : 0.01;
    const FreeSpaceDensity f(Kernel(KernelProfile::kUniform, h));
    const int quick = frontierCount(f, space, {x, y}, share);
    ASSERT_EQ(quick, transcription::frontiers(world, x, y, h, share)) << "round " << round;
    ++counts[std::min(quick, 3)];
  }
  for (int c : counts) EXPECT_GT(c, kRounds / 50);
}

TEST(Oracle, localMapEqualsAlgorithm22) {
  std::mt19937_64 rng(22);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  constexpr int kMaps = kRounds / 4;  // four scans each
  for (int round = 0; round < kMaps; ++round) {
    fsd_localization::LocalMapParams p;
    p.radius = 1.0 + unit(rng) * 1.5;
    p.footprint_radius = 0.0;
    p.obstacle_depth = 0.5 + unit(rng);
    p.usable_range = unit(rng) < 0.5 ? 0.0 : 0.5 + p.radius * unit(rng);
    fsd_localization::LocalMap map(p);
    transcription::HimmGrid plain(map.side());
    const double cells = std::lround(p.radius / p.resolution);
    const double fov =
        round % 3 == 0 ? 2.0 * hyselam::kPi * 0.995 : hyselam::radians(90 + 180 * unit(rng));
    const int beams = 20 + static_cast<int>(rng() % 60);
    const hyselam::Pose2 at{20.0 * (unit(rng) - 0.5), 20.0 * (unit(rng) - 0.5), 0.0};
    for (int k = 0; k < 4; ++k) {
      auto scan = random_worlds::scan(rng, beams, fov, p.radius);
      if (round % 5 == 0) {  // a laser mounted upside down
        scan.angle_min = -scan.angle_min;
        scan.angle_increment = -scan.angle_increment;
      }
      const hyselam::Pose2 pose{at.x, at.y, 2.0 * hyselam::kPi * (unit(rng) - 0.5)};
      map.update(scan, pose);
      const double usable = p.usable_range > 0.0 ? std::min(p.usable_range, p.radius)
                                                 : std::min(scan.range_max, p.radius);
      transcription::himm(plain, scan, pose.theta, p.resolution, cells, usable, p.obstacle_depth);
    }
    for (int y = 0; y < map.side(); ++y) {
      for (int x = 0; x < map.side(); ++x) {
        ASSERT_EQ(static_cast<int>(map.value({x, y})), plain.at(x, y))
            << "round " << round << " cell " << x << ", " << y;
      }
    }
  }
}
