#include "forest_trees.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/rng.hpp"

namespace ngram_slam {
namespace {

constexpr const char* kSumName = "crc32 ";

/// The lines of a file about its origin, in order.
struct OriginLine {
  const char* name;
  std::string ForestOrigin::*member;
};
constexpr std::array<OriginLine, 4> kOriginLines{
    {{"command: ", &ForestOrigin::command},
     {"data: ", &ForestOrigin::data},
     {"in sample: ", &ForestOrigin::in_sample},
     {"out of sample: ", &ForestOrigin::out_of_sample}}};

/// The line of a file that names its features.
std::string featureLine(const ForestFormat& format) {
  std::string line = "features:";
  for (const std::string& feature : format.features) line += " " + feature;
  return line;
}

/// What is between the head and the checksum of a file, line by line.
struct Lines {
  std::string_view rest;
  std::size_t number = 0;  ///< of the line taken last, from 1

  bool next(std::string_view* line) {
    if (rest.empty()) return false;
    const std::size_t end = rest.find('\n');
    *line = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    ++number;
    return true;
  }
};

}  // namespace

/// Takes over trees of OpenCV's.
class ForestTrees::Grower {
 public:
  Grower(const cv::ml::DTrees& given, ForestTrees* out) : given_(given), out_(*out) {}
  void addAll() {
    for (const int root : given_.getRoots()) {
      out_.roots_.push_back(out_.nodes_.size());
      add(root);
    }
  }

 private:
  void add(int from) {
    const auto& given = given_.getNodes()[static_cast<std::size_t>(from)];
    const std::size_t own = out_.nodes_.size();
    out_.nodes_.emplace_back();
    if (given.split < 0) {
      out_.nodes_[own].semantic_class =
          kAllSemanticClasses.at(static_cast<std::size_t>(given.value));
      return;
    }
    const auto& split = given_.getSplits()[static_cast<std::size_t>(given.split)];
    out_.nodes_[own].feature = split.varIdx;
    out_.nodes_[own].threshold = split.c;
    add(given.left);
    out_.nodes_[own].right = out_.nodes_.size();
    add(given.right);
  }
  const cv::ml::DTrees& given_;
  ForestTrees& out_;
};

/// Reads the lines of the trees.
class ForestTrees::Reader {
 public:
  Reader(Lines lines, std::string source, const ForestFormat& format)
      : lines_(lines), source_(std::move(source)), format_(format) {}

  ForestTrees read() {
    ForestTrees trees;
    std::vector<std::size_t> waiting;  // splits without their right side
    bool ended = true;                 // a side, or a tree; else a node must follow
    for (std::string_view line; lines_.next(&line);) {
      const std::size_t own = trees.nodes_.size();
      if (line == "tree") {
        if (!ended || !waiting.empty()) fail("begins a tree within a tree");
        trees.roots_.push_back(own);
        ended = false;
        continue;
      }
      if (ended) {
        if (waiting.empty()) fail("stands outside of a tree");
        trees.nodes_[waiting.back()].right = own;
        waiting.pop_back();
      }
      trees.nodes_.push_back(readNode(line));
      ended = trees.nodes_.back().feature < 0;
      if (!ended) waiting.push_back(own);
    }
    if (trees.roots_.empty() || !ended || !waiting.empty()) {
      throw hyselam::InputError(source_, "", "ends within a tree");
    }
    return trees;
  }

 private:
  [[noreturn]] void fail(const char* reason) const {
    throw hyselam::InputError(source_, "line " + std::to_string(lines_.number), reason);
  }
  Node readNode(std::string_view line) {
    Node node;
    hyselam::splitFields(line, &fields_);
    if (fields_.size() == 1) {
      const auto semantic_class = semanticClassFromString(std::string(fields_[0]));
      if (!semantic_class) fail("is no class");
      node.semantic_class = *semantic_class;
    } else if (fields_.size() == 2) {
      const auto feature = std::find(format_.features.begin(), format_.features.end(), fields_[0]);
      const auto threshold = hyselam::parseNumber(fields_[1]);
      if (feature == format_.features.end()) fail("names a feature that there is not");
      if (!threshold || std::abs(*threshold) > std::numeric_limits<float>::max()) {
        fail("has a threshold that is no number");
      }
      node.feature = static_cast<int>(feature - format_.features.begin());
      node.threshold = static_cast<float>(*threshold);
    } else {
      fail("must be a class, or a feature and a threshold");
    }
    return node;
  }

  Lines lines_;
  std::string source_;
  const ForestFormat& format_;
  std::vector<std::string_view> fields_;
};

ForestTrees ForestTrees::train(const std::vector<std::vector<float>>& samples,
                               const std::vector<SemanticClass>& classes,
                               const ForestParams& params) {
  cv::Mat rows(static_cast<int>(samples.size()), static_cast<int>(samples.at(0).size()), CV_32F);
  cv::Mat answers;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::copy(samples[i].begin(), samples[i].end(), rows.ptr<float>(static_cast<int>(i)));
    answers.push_back(static_cast<int>(indexOf(classes.at(i))));
  }
  const auto trees = cv::ml::RTrees::create();
  trees->setMaxDepth(params.depth);
  trees->setMinSampleCount(params.min_examples);
  trees->setActiveVarCount(params.features_per_split);
  trees->setTermCriteria({cv::TermCriteria::MAX_ITER, params.trees, 0.0});
  cv::Mat types(rows.cols + 1, 1, CV_8U, cv::Scalar(cv::ml::VAR_ORDERED));
  types.at<uchar>(rows.cols) = cv::ml::VAR_CATEGORICAL;
  // OpenCV draws from the thread's own generator.
  const std::uint64_t before = cv::theRNG().state;
  cv::theRNG().state = hyselam::mix(params.seed, 1) | 1;
  trees->train(cv::ml::TrainData::create(rows, cv::ml::ROW_SAMPLE, answers, cv::noArray(),
                                         cv::noArray(), cv::noArray(), types));
  cv::theRNG().state = before;
  ForestTrees out;
  Grower(*trees, &out).addAll();
  return out;
}

std::array<std::size_t, kSemanticClasses> ForestTrees::votes(const float* features) const {
  std::array<std::size_t, kSemanticClasses> votes{};
  for (const std::size_t root : roots_) {
    std::size_t at = root;
    while (nodes_[at].feature >= 0) {
      const Node& node = nodes_[at];
      at = features[node.feature] <= node.threshold ? at + 1 : node.right;
    }
    ++votes[indexOf(nodes_[at].semantic_class)];
  }
  return votes;
}

/// After the head a line "tree" before each, then a node a line: "FEATURE THRESHOLD" or the name of
/// a class.
std::string ForestTrees::text(const ForestFormat& format, const ForestOrigin& origin) const {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(std::numeric_limits<float>::max_digits10);
  out << format.magic << "\n";
  for (const OriginLine& line : kOriginLines) out << line.name << origin.*line.member << "\n";
  out << featureLine(format) << "\n";
  auto root = roots_.begin();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (root != roots_.end() && *root == i) {
      out << "tree\n";
      ++root;
    }
    if (node.feature < 0) {
      out << toString(node.semantic_class) << "\n";
    } else {
      out << format.features[static_cast<std::size_t>(node.feature)] << " " << node.threshold
          << "\n";
    }
  }
  const std::string text = out.str();
  return text + kSumName + hyselam::crc32Text(text) + "\n";
}

ForestTrees ForestTrees::parse(const std::string& text, const std::string& source,
                               const ForestFormat& format, ForestOrigin* origin) {
  const std::string head = format.magic + "\n";
  if (text.compare(0, head.size(), head) != 0) {
    const std::string_view first = std::string_view(text).substr(0, text.find('\n'));
    throw hyselam::InputError(source, "line 1", hyselam::formatRefusal(first, format.magic));
  }
  const std::string example = kSumName + hyselam::crc32Text("") + "\n";
  const std::size_t end = text.size() - std::min(text.size(), example.size());
  if (text.substr(end) != kSumName + hyselam::crc32Text(text.substr(0, end)) + "\n") {
    throw hyselam::InputError(source, "", "is damaged or cut off: its checksum is wrong");
  }
  Lines lines{std::string_view(text).substr(0, end)};
  std::string_view line;
  lines.next(&line);
  for (const OriginLine& expected : kOriginLines) {
    const std::string name = expected.name;
    if (!lines.next(&line) || line.substr(0, name.size()) != name) {
      throw hyselam::InputError(source, "line " + std::to_string(lines.number),
                                "does not begin with '" + name + "'");
    }
    origin->*expected.member = std::string(line.substr(name.size()));
  }
  if (!lines.next(&line) || line != featureLine(format)) {
    throw hyselam::InputError(source, "line " + std::to_string(lines.number),
                              "was made for other features: train it again with " + format.retrain);
  }
  return Reader(lines, source, format).read();
}

void requireLines(const ForestOrigin& origin) {
  for (const OriginLine& line : kOriginLines) {
    if ((origin.*line.member).find('\n') != std::string::npos) {
      throw hyselam::ParameterError("origin of the forest", origin.*line.member, "one line");
    }
  }
}

}  // namespace ngram_slam
