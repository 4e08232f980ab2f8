#include "hyselam_gr2to/segmentation/border_model.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <locale>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"

namespace hyselam_topo {
namespace {

constexpr const char* kFormat = "hyselam_border_trees 1";
constexpr std::size_t kMaxBytes = std::size_t{1} << 24;
constexpr std::size_t kMaxTrees = 100000;
constexpr std::size_t kMaxNodes = 4095;  // of a tree

// The mean over lengths and clearances.
constexpr double kStep = 0.1;    // of the logarithms
constexpr int kLengthSteps = 2;  // to either side
constexpr int kClearanceSteps = 1;

/// Reads the lines of a model one after another; knows where it is for its messages.
class ModelReader {
 public:
  ModelReader(const std::string& text, const std::string& source) : source_(source), rest_(text) {}

  BorderModel read() {
    if (rest_.size() > kMaxBytes) fail("has more than 16 MiB");
    checkChecksum();
    if (nextLine() != kFormat) fail(std::string("is no '") + kFormat + "'");
    BorderModelOrigin origin;
    origin.command = valueOf("command");
    origin.data = valueOf("data");
    origin.in_sample = valueOf("in_sample");
    origin.left_out = valueOf("left_out");
    readFeatures();
    readTrees();
    if (!rest_.empty()) {
      nextLine();
      fail("there is more than the trees");
    }
    return BorderModel(BoostedTrees(std::move(nodes_), std::move(roots_)), std::move(origin));
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw hyselam::InputError(source_, line_ == 0 ? "" : "line " + std::to_string(line_), reason);
  }

  /// Takes the last line off: the checksum of all before it.
  void checkChecksum() {
    const std::string_view key = "checksum ";
    const std::size_t last = rest_.rfind(key);
    if (last == std::string_view::npos || (last > 0 && rest_[last - 1] != '\n')) {
      fail("has no checksum: it is cut short, or no file of border trees");
    }
    const std::string_view body = rest_.substr(0, last);
    if (rest_.substr(last) != std::string(key) + hyselam::crc32Text(body) + "\n") {
      fail("the checksum is wrong: it was damaged or changed by hand");
    }
    rest_ = body;
  }

  std::string_view nextLine() {
    ++line_;
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) fail("it ends too early");
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return line;
  }

  std::string valueOf(const std::string& key) {
    const std::string_view line = nextLine();
    if (line.substr(0, key.size() + 1) != key + " ") fail("'" + key + "' is expected");
    return std::string(line.substr(key.size() + 1));
  }

  std::size_t countOf(const std::string& key, std::size_t most) {
    const auto value = hyselam::parseNumber(valueOf(key));
    if (!value || *value < 1.0 || *value > static_cast<double>(most) ||
        *value != static_cast<double>(static_cast<std::size_t>(*value))) {
      fail(key + " must be a number of 1 .. " + std::to_string(most));
    }
    return static_cast<std::size_t>(*value);
  }

  void readFeatures() {
    if (countOf("features", 1000) != kBorderFeatureCount) {
      fail("the features are not the " + std::to_string(kBorderFeatureCount) + " of this version");
    }
    for (std::size_t i = 0; i < kBorderFeatureCount; ++i) {
      const char* name = toString(static_cast<BorderFeature>(i));
      if (nextLine() != name) fail(std::string("the feature '") + name + "' is expected here");
    }
  }

  void readTrees() {
    const std::size_t trees = countOf("trees", kMaxTrees);
    for (std::size_t tree = 0; tree < trees; ++tree) {
      const std::size_t nodes = countOf("tree", kMaxNodes);
      const std::size_t root = nodes_.size();
      roots_.push_back(static_cast<int>(root));
      for (std::size_t node = 0; node < nodes; ++node)
        nodes_.push_back(readNode(root, node, nodes));
    }
  }

  /// "leaf ANSWER" or "FEATURE THRESHOLD LEFT", LEFT the child's number in its tree.
  TreeNode readNode(std::size_t root, std::size_t node, std::size_t nodes) {
    std::vector<std::string_view> fields;
    hyselam::splitFields(nextLine(), &fields);
    const bool leaf = fields.size() == 2 && fields[0] == "leaf";
    if (!leaf && fields.size() != 3) fail("a leaf or a question is expected");
    const auto value = hyselam::parseNumber(fields[1]);
    if (!value) fail("'" + hyselam::printable(fields[1]) + "' is no number");
    if (leaf) return {-1, *value, 0};
    const auto feature = borderFeatureFromString(std::string(fields[0]));
    if (!feature) fail("there is no feature '" + hyselam::printable(fields[0]) + "'");
    const auto left = hyselam::parseNumber(fields[2]);
    // Children follow their parents: no walk through a tree goes on for ever.
    if (!left || !(*left > static_cast<double>(node)) ||
        !(*left + 1.0 < static_cast<double>(nodes)) ||
        *left != static_cast<double>(static_cast<std::size_t>(*left))) {
      fail("the children must follow in the same tree");
    }
    return {static_cast<int>(*feature), *value,
            static_cast<int>(root + static_cast<std::size_t>(*left))};
  }

  const std::string& source_;
  std::string_view rest_;
  std::size_t line_ = 0;
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

BorderModel::BorderModel(BoostedTrees trees, BorderModelOrigin origin)
    : trees_(std::move(trees)), origin_(std::move(origin)) {}

BorderModel BorderModel::fromText(const std::string& text, const std::string& source) {
  return ModelReader(text, source).read();
}

BorderModel BorderModel::load(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw hyselam::InputError(path, "", "cannot be opened");
  std::string text(kMaxBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw hyselam::InputError(path, "", "cannot be read");
  text.resize(static_cast<std::size_t>(file.gcount()));
  return fromText(text, path);
}

std::string BorderModel::toText() const {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(6);
  out << kFormat << '\n'
      << "command " << origin_.command << '\n'
      << "data " << origin_.data << '\n'
      << "in_sample " << origin_.in_sample << '\n'
      << "left_out " << origin_.left_out << '\n'
      << "features " << kBorderFeatureCount << '\n';
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
  const std::string body = out.str();
  return body + "checksum " + hyselam::crc32Text(body) + "\n";
}

double BorderModel::oddsOfOnePlace(const BorderFeatures& border) const {
  double sum = 0.0;
  int weights = 0;
  for (int i = -kLengthSteps; i <= kLengthSteps; ++i) {
    for (int j = -kClearanceSteps; j <= kClearanceSteps; ++j) {
      const int weight = (kLengthSteps + 1 - std::abs(i)) * (kClearanceSteps + 1 - std::abs(j));
      sum += weight * trees_(rescaledBorder(border, i * kStep, j * kStep).values.data());
      weights += weight;
    }
  }
  return sum / weights;
}

}  // namespace hyselam_topo
