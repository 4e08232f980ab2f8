#include "fsd_localization/pose_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace fsd_localization {

namespace {

struct Bin {
  int x = 0, y = 0, a = 0;
  double weight = 0.0;
  int cluster = -1;
};

std::uint64_t key(int x, int y, int a) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 40) ^
         (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 12) ^
         static_cast<std::uint64_t>(a);
}

}  // namespace

double PoseEstimate::positionStddev() const {
  const double a = covariance(0, 0), b = covariance(0, 1), d = covariance(1, 1);
  const double largest = 0.5 * (a + d) + std::sqrt(0.25 * (a - d) * (a - d) + b * b);
  return std::sqrt(std::max(0.0, largest));
}

PoseEstimate estimatePose(const Particles& p, const ClusterParams& params) {
  PoseEstimate result;
  double total = 0.0;
  for (float w : p.weight) total += w;
  if (!(total > 0.0) || !std::isfinite(total)) return result;

  const int turn = std::max(1, static_cast<int>(std::lround(2.0 * hyselam::kPi / params.angle)));
  const auto per_metre = static_cast<float>(1.0 / params.cell);
  std::unordered_map<std::uint64_t, int> index;
  index.reserve(p.size() / 4 + 16);
  std::vector<Bin> bins;
  std::vector<int> bin_of(p.size());
  std::uint64_t last_key = ~std::uint64_t{0};
  int last = -1;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const int x = static_cast<int>(std::floor(p.x[i] * per_metre));
    const int y = static_cast<int>(std::floor(p.y[i] * per_metre));
    const int a = static_cast<int>(
        (static_cast<std::uint64_t>(p.heading[i]) * static_cast<unsigned>(turn)) >> 32);
    const std::uint64_t k = key(x, y, a);
    if (k != last_key) {  // neighbours in memory mostly share their bin
      const auto [it, is_new] = index.emplace(k, static_cast<int>(bins.size()));
      if (is_new) bins.push_back({x, y, a});
      last = it->second;
      last_key = k;
    }
    bin_of[i] = last;
    bins[static_cast<std::size_t>(last)].weight += p.weight[i];
  }
  // Bins with next to no weight would bridge what lies apart.
  const double negligible = 1e-3 * total / static_cast<double>(bins.size());
  std::vector<double> cluster_weight;
  std::vector<int> stack;
  for (std::size_t first = 0; first < bins.size(); ++first) {
    if (bins[first].weight <= negligible) continue;
    ++result.bins;
    if (bins[first].cluster >= 0) continue;
    const int id = static_cast<int>(cluster_weight.size());
    cluster_weight.push_back(0.0);
    bins[first].cluster = id;
    stack.assign(1, static_cast<int>(first));
    while (!stack.empty()) {
      const Bin b = bins[static_cast<std::size_t>(stack.back())];
      stack.pop_back();
      cluster_weight[static_cast<std::size_t>(id)] += b.weight;
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
          for (int da = -1; da <= 1; ++da) {
            const auto it = index.find(key(b.x + dx, b.y + dy, (b.a + da + turn) % turn));
            if (it == index.end()) continue;
            Bin& other = bins[static_cast<std::size_t>(it->second)];
            if (other.cluster >= 0 || other.weight <= negligible) continue;
            other.cluster = id;
            stack.push_back(it->second);
          }
    }
  }
  const int best = static_cast<int>(std::max_element(cluster_weight.begin(), cluster_weight.end()) -
                                    cluster_weight.begin());
  for (double w : cluster_weight) result.clusters += w >= 0.01 * total;
  const double weight = cluster_weight[static_cast<std::size_t>(best)];
  result.share = weight / total;

  double x = 0.0, y = 0.0, s = 0.0, c = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (bins[static_cast<std::size_t>(bin_of[i])].cluster == best) {
      const double w = p.weight[i] / weight, a = toRadians(p.heading[i]);
      x += w * p.x[i];
      y += w * p.y[i];
      s += w * std::sin(a);
      c += w * std::cos(a);
    }
  result.mean = {x, y, std::atan2(s, c)};
  for (std::size_t i = 0; i < p.size(); ++i)
    if (bins[static_cast<std::size_t>(bin_of[i])].cluster == best) {
      const Eigen::Vector3d e(p.x[i] - x, p.y[i] - y,
                              hyselam::normalizeAngle(toRadians(p.heading[i]) - result.mean.theta));
      result.covariance += p.weight[i] / weight * e * e.transpose();
    }
  return result;
}

}  // namespace fsd_localization
