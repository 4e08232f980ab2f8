#include "hyselam_gr2to/segmentation/border_model.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <locale>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/numbers.hpp"

namespace hyselam_topo {
namespace {

constexpr const char* kFormat = "hyselam_border_trees 1";
constexpr std::size_t kMostMebibytes = 16;
constexpr std::size_t kMaxTrees = 100000;
constexpr std::size_t kMaxNodes = 4095;  // of a tree

// The mean over lengths and clearances.
constexpr double kStep = 0.1;    // of the logarithms
constexpr int kLengthSteps = 2;  // to either side
constexpr int kClearanceSteps = 1;
constexpr std::size_t kSizes = (2 * kLengthSteps + 1) * (2 * kClearanceSteps + 1);

static_assert(kSizes < 32, "a set of sizes has a bit for each");

/// A border in all these sizes, which walk through a tree together as long as they answer alike:
/// nearly always, since they differ little and in few features.
class BorderInSizes {
 public:
  explicit BorderInSizes(const BorderFeatures& border) {
    std::size_t size = 0;
    for (int i = -kLengthSteps; i <= kLengthSteps; ++i) {
      for (int j = -kClearanceSteps; j <= kClearanceSteps; ++j, ++size) {
        weights_[size] = (kLengthSteps + 1 - std::abs(i)) * (kClearanceSteps + 1 - std::abs(j));
        const BorderFeatures rescaled = rescaledBorder(border, i * kStep, j * kStep);
        for (std::size_t f = 0; f < kBorderFeatureCount; ++f) values_[f][size] = rescaled.values[f];
      }
    }
    for (std::size_t f = 0; f < kBorderFeatureCount; ++f) {
      const auto [low, high] = std::minmax_element(values_[f].begin(), values_[f].end());
      low_[f] = *low;
      high_[f] = *high;
    }
  }

  /// The mean of the trees' sums.
  double mean(const BoostedTrees& trees) {
    for (const int root : trees.roots()) add(trees.nodes(), root, (1u << kSizes) - 1u);
    double sum = 0.0;
    int weights = 0;
    for (std::size_t size = 0; size < kSizes; ++size) {
      sum += weights_[size] * sums_[size];
      weights += weights_[size];
    }
    return sum / weights;
  }

 private:
  /// Adds the answers of a tree from a node on for the sizes in a set, a bit each.
  void add(const std::vector<TreeNode>& nodes, int at, std::uint32_t sizes) {
    const TreeNode* node = &nodes[static_cast<std::size_t>(at)];
    while (node->feature >= 0) {
      const auto f = static_cast<std::size_t>(node->feature);
      if (high_[f] <= node->threshold) {
        node = &nodes[static_cast<std::size_t>(node->left)];
        continue;
      }
      if (!(low_[f] > node->threshold)) {
        std::uint32_t left = 0;
        for (std::size_t size = 0; size < kSizes; ++size)
          left |= (values_[f][size] <= node->threshold ? 1u : 0u) << size;
        left &= sizes;
        if (left != 0) add(nodes, node->left, left);
        sizes &= ~left;
        if (sizes == 0) return;
      }
      node = &nodes[static_cast<std::size_t>(node->left + 1)];
    }
    for (std::size_t size = 0; size < kSizes; ++size)
      if ((sizes >> size & 1u) != 0) sums_[size] += node->threshold;
  }

  std::array<int, kSizes> weights_{};
  std::array<std::array<double, kSizes>, kBorderFeatureCount> values_;
  std::array<double, kBorderFeatureCount> low_, high_;
  std::array<double, kSizes> sums_{};
};

/// Reads the trees of a model.
class ModelReader {
 public:
  ModelReader(const std::string& text, const std::string& source)
      : lines_(text, source, "file of border trees", kMostMebibytes) {}

  BorderModel read() {
    hyselam::ModelOrigin origin = lines_.head(kFormat);
    readFeatures();
    readTrees();
    lines_.end("trees");
    return BorderModel(BoostedTrees(std::move(nodes_), std::move(roots_)), std::move(origin));
  }

 private:
  void readFeatures() {
    if (lines_.countOf("features", 1000) != kBorderFeatureCount) {
      lines_.fail("the features are not the " + std::to_string(kBorderFeatureCount) +
                  " of this version");
    }
    for (std::size_t i = 0; i < kBorderFeatureCount; ++i) {
      const char* name = toString(static_cast<BorderFeature>(i));
      if (lines_.next() != name)
        lines_.fail(std::string("the feature '") + name + "' is expected here");
    }
  }

  void readTrees() {
    const std::size_t trees = lines_.countOf("trees", kMaxTrees);
    for (std::size_t tree = 0; tree < trees; ++tree) {
      const std::size_t nodes = lines_.countOf("tree", kMaxNodes);
      const std::size_t root = nodes_.size();
      roots_.push_back(static_cast<int>(root));
      for (std::size_t node = 0; node < nodes; ++node)
        nodes_.push_back(readNode(root, node, nodes));
    }
  }

  /// "leaf ANSWER" or "FEATURE THRESHOLD LEFT", LEFT the child's number in its tree.
  TreeNode readNode(std::size_t root, std::size_t node, std::size_t nodes) {
    const std::vector<std::string_view> fields = lines_.nextFields();
    const bool leaf = fields.size() == 2 && fields[0] == "leaf";
    if (!leaf && fields.size() != 3) lines_.fail("a leaf or a question is expected");
    const auto value = hyselam::parseNumber(fields[1]);
    if (!value) lines_.fail("'" + hyselam::printable(fields[1]) + "' is no number");
    if (leaf) return {-1, *value, 0};
    const auto feature = borderFeatureFromString(std::string(fields[0]));
    if (!feature) lines_.fail("there is no feature '" + hyselam::printable(fields[0]) + "'");
    const auto left = hyselam::parseNumber(fields[2]);
    // Children follow their parents: no walk through a tree goes on for ever.
    if (!left || !(*left > static_cast<double>(node)) ||
        !(*left + 1.0 < static_cast<double>(nodes)) ||
        *left != static_cast<double>(static_cast<std::size_t>(*left))) {
      lines_.fail("the children must follow in the same tree");
    }
    return {static_cast<int>(*feature), *value,
            static_cast<int>(root + static_cast<std::size_t>(*left))};
  }

  hyselam::ModelLines lines_;
  std::vector<TreeNode> nodes_;
  std::vector<int> roots_;
};

void writeTree(std::ostream& out, const BoostedTrees& trees, std::size_t root, std::size_t end) {
  out << "tree " << end - root << '\n';
  for (std::size_t i = root; i < end; ++i) {
    const TreeNode& node = trees.nodes()[i];
    if (node.feature < 0) {
      out << "leaf " << node.threshold << '\n';
    } else {
      out << toString(static_cast<BorderFeature>(node.feature)) << ' ' << node.threshold << ' '
          << node.left - static_cast<int>(root) << '\n';
    }
  }
}

}  // namespace

BorderModel::BorderModel(BoostedTrees trees, hyselam::ModelOrigin origin)
    : trees_(std::move(trees)), origin_(std::move(origin)) {}

BorderModel BorderModel::fromText(const std::string& text, const std::string& source) {
  return ModelReader(text, source).read();
}

BorderModel BorderModel::load(const std::string& path) {
  return fromText(hyselam::readTextFile(path, (kMostMebibytes + 1) << 20), path);
}

std::string BorderModel::toText() const {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(6);
  out << hyselam::modelHead(kFormat, origin_) << "features " << kBorderFeatureCount << '\n';
  for (std::size_t i = 0; i < kBorderFeatureCount; ++i) {
    out << toString(static_cast<BorderFeature>(i)) << '\n';
  }
  const std::vector<int>& roots = trees_.roots();
  out << "trees " << roots.size() << '\n';
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const std::size_t end =
        i + 1 < roots.size() ? static_cast<std::size_t>(roots[i + 1]) : trees_.nodes().size();
    writeTree(out, trees_, static_cast<std::size_t>(roots[i]), end);
  }
  return hyselam::withChecksum(out.str());
}

double BorderModel::oddsOfOnePlace(const BorderFeatures& border) const {
  return BorderInSizes(border).mean(trees_);
}

}  // namespace hyselam_topo
