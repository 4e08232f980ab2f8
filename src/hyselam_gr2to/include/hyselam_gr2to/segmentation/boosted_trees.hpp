// A sum of small decision trees, which classifies whether two neighboring regions are one place.
#pragma once

#include <cstddef>
#include <vector>

namespace hyselam_topo {

/// A question (feature >= 0: go to `left` if value[feature] <= threshold, else to `left` + 1) or an
/// answer (feature < 0: `threshold` is the value).
struct TreeNode {
  int feature;
  double threshold;
  int left;
};

/// Log-odds: the sum of the answers of all trees.
class BoostedTrees {
 public:
  BoostedTrees() = default;
  /// `roots`: the index of each tree's first node; children follow their parents.
  BoostedTrees(std::vector<TreeNode> nodes, std::vector<int> roots)
      : nodes_(std::move(nodes)), roots_(std::move(roots)) {}

  double operator()(const double* features) const {
    double sum = 0.0;
    for (const int root : roots_) {
      const TreeNode* node = &nodes_[static_cast<std::size_t>(root)];
      while (node->feature >= 0)
        node = &nodes_[static_cast<std::size_t>(
            node->left + (features[node->feature] <= node->threshold ? 0 : 1))];
      sum += node->threshold;
    }
    return sum;
  }
  const std::vector<TreeNode>& nodes() const { return nodes_; }
  const std::vector<int>& roots() const { return roots_; }

 private:
  std::vector<TreeNode> nodes_;
  std::vector<int> roots_;
};

}  // namespace hyselam_topo
