// The parts of Monte Carlo localisation: ray casting against plain steps, resampling in exact
// cases, noise by its statistics, weights by the equations, and a robot that finds itself.
#include <gtest/gtest.h>

#include <algorithm>

#include "drawn_room.hpp"
#include "fsd_localization/localizer.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/temporary_directory.hpp"

using namespace fsd_localization;  // NOLINT: a test, not a header
using hyselam::Pose2;

namespace {

/// The basic beam model's ray: from cell to cell, one boundary after the other.
double plainRange(const hyselam::OccupancyGrid& map, double x, double y, double a,
                  double max_range) {
  const double res = map.geometry.resolution, px = x / res, py = y / res;
  const double dx = std::cos(a), dy = std::sin(a);
  int cx = static_cast<int>(std::floor(px)), cy = static_cast<int>(std::floor(py));
  double t = 0.0;
  while (t < max_range / res && map.geometry.contains({cx, cy})) {
    if (map.at({cx, cy}) == 100) return t * res;
    const double tx = ((dx > 0.0 ? cx + 1 : cx) - px) / dx,
                 ty = ((dy > 0.0 ? cy + 1 : cy) - py) / dy;
    t = std::min(tx, ty);
    (tx < ty ? cx : cy) += (tx < ty ? dx : dy) > 0.0 ? 1 : -1;
  }
  return max_range;
}

}  // namespace

TEST(Oracle, rangesEqualPlainStepsFromCellToCell) {
  std::mt19937_64 rng(19);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int hits = 0;
  for (int world = 0; world < 500; ++world) {
    const auto map = gridOf(random_worlds::rooms(rng, 60, 50));
    const GridRayCaster rays(map);
    for (int i = 0; i < 20; ++i) {
      const double x = 6.0 * unit(rng), y = 5.0 * unit(rng), a = 6.28 * unit(rng);
      const double plain = plainRange(map, x, y, a, 8.0);
      ASSERT_NEAR(rays.range(x, y, a, 8.0), plain, 1e-9) << "world " << world << " ray " << i;
      hits += plain < 8.0;
    }
  }
  EXPECT_GT(hits, 5000);
}

TEST(Resampling, copiesEachParticleByItsShare) {
  Particles in, out;
  in.resize(4);
  for (std::size_t i = 0; i < 4; ++i) in.set(i, {static_cast<double>(i), 0, 0}, 0.0F);
  in.weight = {1.0F, 0.0F, 2.0F, 1.0F};
  for (double offset : {0.0, 0.3, 0.999}) {
    resampleSystematic(in, 8, offset, out);
    std::array<int, 4> copies{};
    for (float x : out.x) ++copies[static_cast<std::size_t>(x)];
    EXPECT_EQ(copies[1], 0);
    EXPECT_EQ(copies[0] + copies[2] + copies[3], 8);
    EXPECT_NEAR(copies[2], 4, 1);
    EXPECT_NEAR(copies[0], 2, 1);
  }
}

TEST(Resampling, keepsAllParticlesWhenNoWeightIsLeft) {
  Particles in, out;
  in.resize(5);
  for (std::size_t i = 0; i < 5; ++i) in.set(i, {static_cast<double>(i), 0, 0}, 0.0F);
  resampleSystematic(in, 5, 0.5, out);
  EXPECT_EQ(out.x, in.x);
}

TEST(Noise, isStandardNormal) {
  const NoiseTable table;
  double sum = 0.0, squares = 0.0, cross = 0.0;
  constexpr int kDraws = 300000;
  for (int i = 0; i < kDraws; ++i) {
    float a, b, c;
    table.gaussians(hashAt(7, static_cast<std::uint64_t>(i)), a, b, c);
    sum += a + b + c;
    squares += a * a + b * b + c * c;
    cross += a * b + b * c;
  }
  EXPECT_NEAR(sum / (3.0 * kDraws), 0.0, 0.005);      // 4.7 standard errors
  EXPECT_NEAR(squares / (3.0 * kDraws), 1.0, 0.008);  // 5 standard errors
  EXPECT_NEAR(cross / (2.0 * kDraws), 0.0, 0.007);
}

TEST(Motion, hasTheVarianceOfItsParameters) {
  Particles p;
  p.resize(40000);
  for (std::size_t i = 0; i < p.size(); ++i) p.set(i, {5.0, 5.0, 1.0}, 1.0F);
  MotionParams params;
  params.alpha1 = params.alpha2 = params.alpha4 = 0.0;
  params.alpha3 = 0.04;  // 20 % of the way
  MotionModel(params).move({1.0, 0.0, 0.0}, 99, p);
  double mean = 0.0, var = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double d = std::hypot(p.x[i] - 5.0F, p.y[i] - 5.0F);
    mean += d / 40000.0;
    var += (d - 1.0) * (d - 1.0) / 40000.0;
  }
  EXPECT_NEAR(mean, 1.0, 0.005);
  EXPECT_NEAR(std::sqrt(var), 0.2, 0.005);
}

/// A density or direction `off` beyond what fits.
double agreement(double off, double tolerance, const FsdObservationModelParams& p) {
  if (p.profile == FsdObservationModelParams::Profile::kStep)
    return off > tolerance ? p.penalty : 1.0;
  const double stddev = tolerance / 2.0;
  return p.penalty + (1.0 - p.penalty) * std::exp(-off * off / (2.0 * stddev * stddev));
}

class FsdModelProfile : public testing::TestWithParam<FsdObservationModelParams::Profile> {};

TEST_P(FsdModelProfile, weighsAsEquations34To36) {
  const auto map = std::make_shared<const FsdMap>(room(), FsdMapParams{});
  FsdObservationModelParams params;
  params.undefined = FsdObservationModelParams::Undefined::kNeutral;
  params.profile = GetParam();
  const FsdObservationModel model(map, params);
  Observation o;
  o.fsd.readings.resize(3);
  const double densities[] = {0.7, 0.5, 0.3};
  for (std::size_t k = 0; k < 3; ++k) {
    o.fsd.readings[k].density = {densities[k], densities[k], densities[k]};
    o.fsd.readings[k].descent = 0.4 + static_cast<double>(k);
  }
  o.fsd.readings[2].density.hard.reset();  // undefined: factor 1
  Particles p = uniformParticles(*map, 5000, 3);
  ASSERT_TRUE(model.weigh(o, p).has_value());
  for (std::size_t i = 0; i < p.size(); ++i) {
    const hyselam::Cell c{static_cast<int>(p.x[i] / 0.1F), static_cast<int>(p.y[i] / 0.1F)};
    double w = 1.0;
    bool borderline = false;
    for (int k = 0; k < 3; ++k) {
      if (k < 2) {
        const double off = std::abs(map->density(c, k) - densities[k]);
        borderline |= std::abs(off - params.epsilon_d) < 1e-6;
        w *= agreement(off, params.epsilon_d, params);
      }
      if (const auto a = map->descent(c, k)) {
        // The model takes headings in the 128 steps of the map's directions.
        const double step = 2.0 * hyselam::kPi / 128.0;
        const double heading = std::round(toRadians(p.heading[i]) / step) * step;
        const double off = std::abs(hyselam::normalizeAngle(*a - heading - (0.4 + k)));
        borderline |= std::abs(off - params.epsilon_theta) < 1e-6;
        w *= agreement(off, params.epsilon_theta, params);
      }
    }
    if (!borderline) {
      ASSERT_NEAR(p.weight[i], w, 1e-5 * w) << i;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Both, FsdModelProfile,
                         testing::Values(FsdObservationModelParams::Profile::kStep,
                                         FsdObservationModelParams::Profile::kGaussian));

TEST(Localizer, localizesGloballyAndReproducibly) {
  const auto map = room();
  const GridRayCaster rays(map);
  const auto drive = [&](std::uint64_t seed) {
    LocalizerParams params;
    params.filter.max_particles = 10000;
    params.seed = seed;
    Localizer localizer(map, params);
    std::optional<LocalizationResult> last;
    Pose2 pose{1.5, 1.5, 0.0}, truth;
    for (int i = 0; i < 400; ++i) {
      pose = pose * Pose2{0.05, 0.0,
                          pose.x > 5.5 && pose.theta < 1.57  ? 0.05
                          : pose.y > 6.0 && pose.theta < 3.1 ? 0.05
                                                             : 0.0};
      if (pose.x < 1.5 && i > 150) break;
      if (const auto r = localizer.update(look(rays, pose, 1.0 + 0.1 * i), pose)) {
        last = r;
        truth = pose;
      }
    }
    EXPECT_TRUE(last && last->converged);
    // Two cells of the map, a few metres after waking up.
    EXPECT_LT(hyselam::distance(last->base_in_map, truth), 0.2);
    return last->base_in_map;
  };
  const Pose2 first = drive(4), again = drive(4);
  EXPECT_EQ(first.x, again.x);
  EXPECT_EQ(first.y, again.y);
  EXPECT_EQ(first.theta, again.theta);
}

TEST(Localizer, detectsKidnappingWhileTurningInPlace) {
  const auto map = room();
  const GridRayCaster rays(map);
  Localizer localizer(map, LocalizerParams{});
  localizer.setInitialPose({2.0, 2.0, 0.0}, {0.2, 0.2, 0.1});
  double stamp = 0.0, heading = 0.0;
  const auto turn = [&](double x, double y) {
    heading = hyselam::normalizeAngle(heading + hyselam::radians(10.0));
    stamp += 0.1;
    // The wheels know of the turn only.
    return localizer.update(look(rays, {x, y, heading}, stamp), {2.0, 2.0, heading});
  };
  std::optional<LocalizationResult> result;
  for (int i = 0; i < 36; ++i) result = turn(2.0, 2.0);
  ASSERT_TRUE(result && result->converged);
  ASSERT_EQ(result->phase, Phase::kTracking);
  bool lost = false;
  for (int i = 0; i < 72 && !lost; ++i) {
    result = turn(10.0, 5.5);
    lost = result && result->phase == Phase::kLost;
  }
  EXPECT_TRUE(lost) << "not within two turns";
}

TEST(ParticleFilter, weightsStayFiniteWithoutResampling) {
  /// Prefers particles on the left a little, and calls everything far more or less likely than 1.
  class Extreme final : public ObservationModel {
   public:
    explicit Extreme(double scale) : scale_(scale) {}
    const char* name() const override { return "extreme"; }
    std::optional<double> weigh(const Observation&, Particles& p) const override {
      for (std::size_t i = 0; i < p.size(); ++i) {
        p.weight[i] = static_cast<float>(p.weight[i] * scale_ * (p.x[i] < 6.0F ? 1.0 : 0.9));
      }
      return 1.0;
    }

   private:
    double scale_;
  };
  const auto map = std::make_shared<const FsdMap>(room(), FsdMapParams{});
  FilterParams params;
  params.max_particles = 1000;
  params.resample_threshold = 0.01;
  params.motion.alpha1 = params.motion.alpha2 = params.motion.alpha3 = params.motion.alpha4 = 0.0;
  for (const double scale : {1e-25, 1e25}) {
    ParticleFilter filter(map, params, 1);
    for (int i = 0; i < 10; ++i) EXPECT_FALSE(filter.step({}, Extreme(scale), {}).resampled);
    const Particles& p = filter.particles();
    const auto right =
        static_cast<std::size_t>(std::max_element(p.x.begin(), p.x.end()) - p.x.begin());
    const auto left =
        static_cast<std::size_t>(std::min_element(p.x.begin(), p.x.end()) - p.x.begin());
    EXPECT_NEAR(p.weight[right] / p.weight[left], std::pow(0.9, 10), 1e-5) << scale;
  }
}

TEST(MotionModel, noiseIsScaled) {
  const auto spread = [](double noise) {
    Particles p;
    p.resize(4000);
    for (std::size_t i = 0; i < p.size(); ++i) p.set(i, {1.0, 2.0, 0.0}, 1.0F);
    MotionModel().move({0.5, 0.0, 0.0}, 7, p, noise);
    double sum = 0.0, squares = 0.0;
    for (const float x : p.x) {
      sum += x;
      squares += static_cast<double>(x) * x;
    }
    const double n = static_cast<double>(p.size()), mean = sum / n;
    EXPECT_NEAR(mean, 1.5, 0.01);
    return std::sqrt(std::max(0.0, squares / n - mean * mean));
  };
  EXPECT_LT(spread(0.0), 1e-3);
  EXPECT_NEAR(spread(1.0), 0.5 * std::sqrt(MotionParams{}.alpha3), 0.01);
  EXPECT_NEAR(spread(0.3), 0.3 * spread(1.0), 0.005);
}

TEST(Localizer, refusesBadScansAndKeepsItsState) {
  const auto map = room();
  const GridRayCaster rays(map);
  LocalizerParams params;
  params.filter.max_particles = 1000;
  Localizer localizer(map, params);
  const Pose2 at{2.0, 2.0, 0.0};
  ASSERT_TRUE(localizer.update(look(rays, at, 1.0), at));
  const auto before = localizer.particles().x;
  const auto refused = [&](auto change, const Pose2& pose = Pose2{2.0, 2.0, 0.0}) {
    hyselam::LaserScan s = look(rays, at, 2.0);
    change(s);
    EXPECT_THROW(localizer.update(s, pose, true), hyselam::InputError);
    EXPECT_EQ(localizer.particles().x, before);
  };
  refused([](auto& s) { s.ranges.clear(); });
  refused([](auto& s) { s.angle_increment = 0.0; });
  refused([](auto& s) { s.angle_min = std::nan(""); });
  refused([](auto& s) { s.range_max = s.range_min; });
  refused([](auto& s) { s.stamp = 1.0; });
  refused([](auto& s) { s.stamp = 0.5; });
  refused([](auto& s) { s.laser_in_base.x = 50.0; });
  refused([](auto&) {}, Pose2{std::nan(""), 0.0, 0.0});
  refused([](auto&) {}, Pose2{1e12, 0.0, 0.0});
  EXPECT_TRUE(localizer.update(look(rays, at, 3.0), at, true));
  EXPECT_THROW(localizer.setInitialPose({std::nan(""), 0, 0}, {}), hyselam::InputError);
  EXPECT_THROW(localizer.setInitialPose({}, {-1, 0, 0}), hyselam::InputError);
  EXPECT_THROW(localizer.setInitialPose({1e9, 0, 0}, {}), hyselam::InputError);
  EXPECT_THROW(localizer.setInitialPose({}, {0, 1e9, 0}), hyselam::InputError);
}

TEST(Parameters, outOfRangeAreNamed) {
  const auto named = [](auto change, const std::string& name) {
    LocalizerParams p;
    change(p);
    try {
      p.validate();
      ADD_FAILURE() << name << " was accepted";
    } catch (const hyselam::ParameterError& e) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
    }
  };
  named([](auto& p) { p.update_min_d = -1; }, "update_min_d");
  named([](auto& p) { p.converged_cluster_weight = 0; }, "converged_cluster_weight");
  named([](auto& p) { p.filter.min_particles = 0; }, "min_particles");
  named([](auto& p) { p.filter.kld_error = 2; }, "kld_err");
  named([](auto& p) { p.filter.motion.alpha1 = std::nan(""); }, "odom_alpha1");
  named([](auto& p) { p.map.kernels.clear(); }, "bandwidths");
  named([](auto& p) { p.map.kernels[0].bandwidth = 20; }, "bandwidth");
  named([](auto& p) { p.local_map.resolution = 0; }, "resolution");
  named([](auto& p) { p.likelihood.sigma_hit = 0; }, "sigma_hit");
  EXPECT_THROW(observationModelKindFromString("amcl"), hyselam::ParameterError);
}

TEST(Localizer, checksMapsBeforePreparation) {
  const LocalizerParams params;
  EXPECT_NO_THROW(Localizer::checkMap(room(), params));
  hyselam::OccupancyGrid shut(room().geometry, 100);
  EXPECT_THROW(Localizer::checkMap(shut, params), hyselam::InputError);
  EXPECT_THROW(Localizer(shut, params), hyselam::InputError);
  hyselam::OccupancyGrid vast = room();
  vast.geometry.resolution = 10.0;  // larger than a kernel
  EXPECT_THROW(Localizer::checkMap(vast, params), hyselam::ParameterError);
  EXPECT_THROW(Localizer(vast, params), hyselam::ParameterError);
}

TEST(LikelihoodField, farReturnsAreNeverInliers) {
  LikelihoodFieldParams params;
  params.sigma_hit = 0.03;
  const LikelihoodFieldModel model(room(), params);
  const Pose2 at{6.0, 4.0, 0.0};
  hyselam::LaserScan scan = look(GridRayCaster(room()), at, 1.0);
  EXPECT_GT(*model.inlierRatio(scan, at, 0.3), 0.9);
  for (float& range : scan.ranges) range *= 0.5F;  // into the open
  EXPECT_LT(*model.inlierRatio(scan, at, 0.3), 0.1);
}

TEST(FsdMap, cacheIsUsedOnlyWhenItFits) {
  const hyselam::testing::TemporaryDirectory folder;
  const std::string path = folder / "room.fsd";
  bool cached = true;
  const auto first = FsdMap::cached(path, room(), {}, 1, {}, &cached);
  EXPECT_FALSE(cached);
  const auto second = FsdMap::cached(path, room(), {}, 1, {}, &cached);
  EXPECT_TRUE(cached);
  EXPECT_TRUE(std::equal(first.data(), first.data() + first.bytes(), second.data()));
  auto changed = room();
  changed.at({50, 40}) = 100;
  FsdMap::cached(path, changed, {}, 1, {}, &cached);
  EXPECT_FALSE(cached);
  if (FILE* f = std::fopen(path.c_str(), "r+b")) {  // damage a byte
    std::fseek(f, 1000, SEEK_SET);
    std::fputc(77, f);
    std::fclose(f);
  }
  FsdMap::cached(path, changed, {}, 1, {}, &cached);
  EXPECT_FALSE(cached);
}

TEST(FsdMap, unwritableCacheIsReportedAndFieldsAreUsed) {
  const hyselam::testing::TemporaryDirectory folder;
  const std::string path = folder / "no/such/folder/room.fsd";
  bool cached = true;
  std::string problem;
  const auto map = FsdMap::cached(path, room(), {}, 1, {}, &cached, &problem);
  EXPECT_FALSE(cached);
  EXPECT_EQ(problem.find(path), 0U) << problem;
  const FsdMap fresh(room(), {}, 1);
  EXPECT_TRUE(std::equal(fresh.data(), fresh.data() + fresh.bytes(), map.data()));

  FsdMap::cached(folder / "room_kept.fsd", room(), {}, 1, {}, &cached, &problem);
  EXPECT_TRUE(problem.empty()) << problem;
}

TEST(DensityField, doesNotDependOnTheNumberOfThreads) {
  const FreeSpaceGrid space = freeSpaceOf(room());
  const Kernel kernel(KernelProfile::kGaussian, 20);
  EXPECT_EQ(densityField(space, kernel, 1).values, densityField(space, kernel, 3).values);
}
