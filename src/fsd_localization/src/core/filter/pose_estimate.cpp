#include "fsd_localization/filter/pose_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pose_bins.hpp"

namespace fsd_localization {

namespace {

using Bin = PoseBins::Bin;
/// With more bins than this the particles are all over the place, and clusters mean nothing yet.
constexpr std::size_t kMaxClusteredBins = 4000;

/// Numbers the clusters of touching bins; returns their weights.
std::vector<double> cluster(PoseBins& bins, double negligible) {
  std::vector<double> weights;
  std::vector<int> stack;
  for (std::size_t first = 0; first < bins.bins.size(); ++first) {
    if (bins.bins[first].cluster >= 0 || bins.bins[first].weight <= negligible) continue;
    const int id = static_cast<int>(weights.size());
    weights.push_back(0.0);
    bins.bins[first].cluster = id;
    stack.assign(1, static_cast<int>(first));
    while (!stack.empty()) {
      const Bin b = bins.bins[static_cast<std::size_t>(stack.back())];
      stack.pop_back();
      weights.back() += b.weight;
      for (int dx = -1; dx <= 1; ++dx) {
        for (int dy = -1; dy <= 1; ++dy) {
          for (int da = -1; da <= 1; ++da) {
            const int number = bins.find(b.x + dx, b.y + dy, b.a + da);
            if (number < 0) continue;
            Bin& other = bins.bins[static_cast<std::size_t>(number)];
            if (other.cluster >= 0 || other.weight <= negligible) continue;
            other.cluster = id;
            stack.push_back(number);
          }
        }
      }
    }
  }
  return weights;
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

  PoseBins bins(params.cell, params.angle, p.size());
  std::vector<int> bin_of(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) bin_of[i] = bins.add(p, i);
  // Bins with next to no weight would bridge what lies apart.
  const double negligible = 1e-3 * total / static_cast<double>(bins.bins.size());
  for (const Bin& b : bins.bins) result.bins += b.weight > negligible ? 1 : 0;

  std::vector<double> weights;
  if (result.bins <= kMaxClusteredBins) {
    weights = cluster(bins, negligible);
  } else {  // each bin for itself
    for (Bin& b : bins.bins) {
      b.cluster = static_cast<int>(weights.size());
      weights.push_back(b.weight);
    }
  }
  const int best =
      static_cast<int>(std::max_element(weights.begin(), weights.end()) - weights.begin());
  for (double w : weights) result.clusters += w >= 0.01 * total ? 1 : 0;
  const double weight = weights[static_cast<std::size_t>(best)];
  result.cluster_weight = weight / total;

  double x = 0.0, y = 0.0, s = 0.0, c = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (bins.bins[static_cast<std::size_t>(bin_of[i])].cluster == best) {
      const double w = p.weight[i] / weight, a = toRadians(p.heading[i]);
      x += w * p.x[i];
      y += w * p.y[i];
      s += w * std::sin(a);
      c += w * std::cos(a);
    }
  }
  result.mean = {x, y, std::atan2(s, c)};
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (bins.bins[static_cast<std::size_t>(bin_of[i])].cluster == best) {
      const Eigen::Vector3d e(p.x[i] - x, p.y[i] - y,
                              hyselam::normalizeAngle(toRadians(p.heading[i]) - result.mean.theta));
      result.covariance += p.weight[i] / weight * e * e.transpose();
    }
  }
  return result;
}

}  // namespace fsd_localization
