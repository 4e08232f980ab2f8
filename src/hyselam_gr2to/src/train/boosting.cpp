#include "boosting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace hyselam_topo {
namespace {

constexpr int kBins = 64;

struct Sums {
  double gradient = 0.0;
  double hessian = 0.0;
};

struct Leaf {
  int node = 0;  // in the tree
  std::vector<int> rows;
  Sums sums;
  double lower = -std::numeric_limits<double>::infinity();  // of its answer
  double upper = std::numeric_limits<double>::infinity();
  // The best question.
  double gain = 0.0;
  int feature = -1;
  int bin = 0;
};

class Booster {
 public:
  Booster(const Samples& samples, const BoostingParams& params)
      : samples_(samples), params_(params), random_(params.seed) {
    makeBins();
    weights_ = samples.weights;
    const double mean = std::accumulate(weights_.begin(), weights_.end(), 0.0) /
                        static_cast<double>(weights_.size());
    for (double& w : weights_) w /= mean;
  }

  BoostedTrees run() {
    scores_.assign(samples_.size(), 0.0);
    gradients_.resize(samples_.size());
    for (int i = 0; i < params_.trees; ++i) addTree();
    return BoostedTrees(nodes_, roots_);
  }

 private:
  int bins(int row, int feature) const {
    return binned_[static_cast<std::size_t>(row) * static_cast<std::size_t>(samples_.features) +
                   static_cast<std::size_t>(feature)];
  }

  void makeBins() {
    const auto columns = static_cast<std::size_t>(samples_.features);
    binned_.resize(samples_.values.size());
    limits_.resize(columns);
    std::vector<double> column(samples_.size());
    for (std::size_t f = 0; f < columns; ++f) {
      for (std::size_t i = 0; i < column.size(); ++i) column[i] = samples_.values[i * columns + f];
      std::vector<double> sorted = column;
      std::sort(sorted.begin(), sorted.end());
      std::vector<double>& limits = limits_[f];
      for (int b = 1; b < kBins; ++b) {
        const double limit = sorted[sorted.size() * static_cast<std::size_t>(b) / kBins];
        if (limits.empty() || limit > limits.back()) limits.push_back(limit);
      }
      for (std::size_t i = 0; i < column.size(); ++i)
        binned_[i * columns + f] = static_cast<std::uint8_t>(
            std::lower_bound(limits.begin(), limits.end(), column[i]) - limits.begin());
    }
  }

  double answer(const Sums& s, double lower, double upper) const {
    return std::clamp(-s.gradient / (s.hessian + params_.l2), lower, upper);
  }
  double score(const Sums& s, double value) const {
    return -(s.gradient * value + 0.5 * (s.hessian + params_.l2) * value * value);
  }
  int monotone(int feature) const {
    const auto f = static_cast<std::size_t>(feature);
    return f < params_.monotone.size() ? params_.monotone[f] : 0;
  }

  void findQuestion(Leaf& leaf) {
    leaf.gain = 0.0;
    const double alone = score(leaf.sums, answer(leaf.sums, leaf.lower, leaf.upper));
    for (const int f : features_) {
      Sums histogram[kBins];
      for (const int row : leaf.rows) {
        Sums& bin = histogram[bins(row, f)];
        bin.gradient += gradients_[static_cast<std::size_t>(row)].gradient;
        bin.hessian += gradients_[static_cast<std::size_t>(row)].hessian;
      }
      Sums left;
      const int limits = static_cast<int>(limits_[static_cast<std::size_t>(f)].size());
      for (int b = 0; b < limits; ++b) {
        left.gradient += histogram[b].gradient;
        left.hessian += histogram[b].hessian;
        const Sums right{leaf.sums.gradient - left.gradient, leaf.sums.hessian - left.hessian};
        if (left.hessian < params_.min_hessian || right.hessian < params_.min_hessian) continue;
        const double l = answer(left, leaf.lower, leaf.upper);
        const double r = answer(right, leaf.lower, leaf.upper);
        if (monotone(f) * (r - l) < 0.0) continue;
        const double gain = score(left, l) + score(right, r) - alone;
        if (gain > leaf.gain + 1e-9) leaf.gain = gain, leaf.feature = f, leaf.bin = b;
      }
    }
  }

  Leaf leafOf(int node, std::vector<int> rows, double lower, double upper) {
    Leaf leaf;
    leaf.node = node;
    leaf.rows = std::move(rows);
    leaf.lower = lower;
    leaf.upper = upper;
    for (const int row : leaf.rows) {
      leaf.sums.gradient += gradients_[static_cast<std::size_t>(row)].gradient;
      leaf.sums.hessian += gradients_[static_cast<std::size_t>(row)].hessian;
    }
    findQuestion(leaf);
    return leaf;
  }

  void addTree() {
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const double p = 1.0 / (1.0 + std::exp(-scores_[i]));
      gradients_[i] = {weights_[i] * (p - samples_.one_place[i]), weights_[i] * p * (1.0 - p)};
    }
    std::vector<int> rows;
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (uniform(random_) < params_.sample_share) rows.push_back(static_cast<int>(i));
    features_.clear();
    for (int f = 0; f < samples_.features; ++f)
      if (uniform(random_) < params_.feature_share) features_.push_back(f);

    const int root = static_cast<int>(nodes_.size());
    roots_.push_back(root);
    nodes_.push_back({-1, 0.0, 0});
    const double inf = std::numeric_limits<double>::infinity();
    std::vector<Leaf> leaves;
    leaves.push_back(leafOf(root, std::move(rows), -inf, inf));
    while (static_cast<int>(leaves.size()) < params_.leaves) {
      const auto best =
          std::max_element(leaves.begin(), leaves.end(),
                           [](const Leaf& a, const Leaf& b) { return a.gain < b.gain; });
      if (best->gain <= 1e-6) break;
      Leaf parent = std::move(*best);
      leaves.erase(best);
      std::vector<int> left, right;
      for (const int row : parent.rows)
        (bins(row, parent.feature) <= parent.bin ? left : right).push_back(row);
      const int first = static_cast<int>(nodes_.size());
      nodes_[static_cast<std::size_t>(parent.node)] = {
          parent.feature,
          limits_[static_cast<std::size_t>(parent.feature)][static_cast<std::size_t>(parent.bin)],
          first};
      nodes_.push_back({-1, 0.0, 0});
      nodes_.push_back({-1, 0.0, 0});
      Leaf l = leafOf(first, std::move(left), parent.lower, parent.upper);
      Leaf r = leafOf(first + 1, std::move(right), parent.lower, parent.upper);
      const int way = monotone(parent.feature);
      if (way != 0) {
        const double middle =
            0.5 * (answer(l.sums, l.lower, l.upper) + answer(r.sums, r.lower, r.upper));
        (way > 0 ? l.upper : l.lower) = middle;
        (way > 0 ? r.lower : r.upper) = middle;
        findQuestion(l);
        findQuestion(r);
      }
      leaves.push_back(std::move(l));
      leaves.push_back(std::move(r));
    }
    for (const Leaf& leaf : leaves)
      nodes_[static_cast<std::size_t>(leaf.node)].threshold =
          params_.rate * answer(leaf.sums, leaf.lower, leaf.upper);
    const BoostedTrees tree(std::vector<TreeNode>(nodes_), {root});
    const auto columns = static_cast<std::size_t>(samples_.features);
    for (std::size_t i = 0; i < samples_.size(); ++i)
      scores_[i] += tree(&samples_.values[i * columns]);
  }

  const Samples& samples_;
  const BoostingParams& params_;
  std::mt19937_64 random_;
  std::vector<double> weights_;
  std::vector<std::uint8_t> binned_;
  std::vector<std::vector<double>> limits_;
  std::vector<double> scores_;
  std::vector<Sums> gradients_;
  std::vector<int> features_;
  std::vector<TreeNode> nodes_;
  std::vector<int> roots_;
};

}  // namespace

BoostedTrees boost(const Samples& samples, const BoostingParams& params) {
  return Booster(samples, params).run();
}

}  // namespace hyselam_topo
