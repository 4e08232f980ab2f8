#include "fsd_localization/filter/motion_model.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

using hyselam::kPi;
using hyselam::normalizeAngle;
using hyselam::Pose2;

NoiseTable::NoiseTable() {
  // Quantiles by bisection of the normal distribution function; the ends, which lie at infinity, at
  // the mean of the outermost step.
  const auto cdf = [](double v) { return 0.5 * std::erfc(-v / std::sqrt(2.0)); };
  for (std::size_t i = 0; i <= 4096; ++i) {
    const double p =
        std::clamp(static_cast<double>(i) / 4096.0, 0.25 / 4096.0, 1.0 - 0.25 / 4096.0);
    double lo = -8.0, hi = 8.0;
    for (int k = 0; k < 60; ++k) {
      const double mid = 0.5 * (lo + hi);
      (cdf(mid) < p ? lo : hi) = mid;
    }
    table_[i] = static_cast<float>(0.5 * (lo + hi));
  }
  // Interpolation between quantiles changes the variance a little: scale it back to 1.
  double second = 0.0;
  for (std::size_t i = 0; i < 4096; ++i) {
    const double a = table_[i], b = table_[i + 1];
    second += (a * a + a * b + b * b) / 3.0 / 4096.0;
  }
  for (float& q : table_) q = static_cast<float>(q / std::sqrt(second));
}

void MotionParams::describe(hyselam::ParameterVisitor& visit) {
  const auto range = hyselam::Range::atLeast(0.0);
  visit("alpha1", alpha1, range, "", "variance of rotation by rotation^2");
  visit("alpha2", alpha2, range, "rad^2/m^2", "variance of rotation by translation^2");
  visit("alpha3", alpha3, range, "", "variance of translation by translation^2");
  visit("alpha4", alpha4, range, "m^2/rad^2", "variance of translation by rotation^2");
}

void MotionParams::validate() const {
  hyselam::checkParameters(*this);
  for (const double alpha : {alpha1, alpha2, alpha3, alpha4}) {
    if (!std::isfinite(alpha)) throw hyselam::ParameterError("odom_alpha1 .. 4", alpha, "finite");
  }
}

void MotionModel::move(const Pose2& delta, std::uint64_t stream, Particles& p, double noise) const {
  const double translation = std::hypot(delta.x, delta.y);
  // Turning on the spot has no direction of travel; driving backwards is no half turn.
  const double rot1 = translation < 0.01 ? 0.0 : std::atan2(delta.y, delta.x);
  const double rot2 = normalizeAngle(delta.theta - rot1);
  const auto turn = [](double r) {
    return std::min(std::abs(normalizeAngle(r)), std::abs(normalizeAngle(r - kPi)));
  };
  const double r1 = turn(rot1), r2 = turn(rot2), t2 = translation * translation;
  const auto s1 =
      static_cast<float>(noise * std::sqrt(params_.alpha1 * r1 * r1 + params_.alpha2 * t2));
  const auto st = static_cast<float>(
      noise * std::sqrt(params_.alpha3 * t2 + params_.alpha4 * (r1 * r1 + r2 * r2)));
  const auto s2 =
      static_cast<float>(noise * std::sqrt(params_.alpha1 * r2 * r2 + params_.alpha2 * t2));
  const auto base1 = toBinaryAngle(rot1), base2 = toBinaryAngle(rot2);
  const auto step = static_cast<float>(translation);
  constexpr auto kPerRadian = static_cast<float>(4294967296.0 / (2.0 * kPi));

  const std::size_t n = p.size();
  constexpr std::size_t kBlock = 256;  // small enough to stay in the first-level cache
  float n1[kBlock], nt[kBlock], n2[kBlock];
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    const std::size_t count = std::min(kBlock, n - begin);
    for (std::size_t i = 0; i < count; ++i) {
      noise_.gaussians(hashAt(stream, begin + i), n1[i], nt[i], n2[i]);
    }
    float* x = p.x.data() + begin;
    float* y = p.y.data() + begin;
    BinaryAngle* h = p.heading.data() + begin;
    for (std::size_t i = 0; i < count; ++i) {
      // A float to signed conversion covers +-half a turn: noise is cut there, where it means
      // nothing.
      const float e1 = std::min(std::max(n1[i] * s1, -3.1F), 3.1F) * kPerRadian;
      const float e2 = std::min(std::max(n2[i] * s2, -3.1F), 3.1F) * kPerRadian;
      const BinaryAngle mid =
          h[i] + base1 + static_cast<BinaryAngle>(static_cast<std::int32_t>(e1));
      float s, c;
      sinCos(mid, s, c);
      const float d = step + nt[i] * st;
      x[i] += d * c;
      y[i] += d * s;
      h[i] = mid + base2 + static_cast<BinaryAngle>(static_cast<std::int32_t>(e2));
    }
  }
}

}  // namespace fsd_localization
