#include "ngram_slam/semantics/semantic_forest.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <locale>
#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>
#include <optional>
#include <sstream>
#include <string_view>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/rng.hpp"

namespace ngram_slam {
namespace {

constexpr const char* kMagic = "ngram_slam semantic forest 3";
constexpr const char* kSumName = "crc32 ";
constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

cv::Mat rowOf(const SemanticFeatures& features) {
  const auto v = vectorOf(features);
  return cv::Mat(1, static_cast<int>(v.size()), CV_32F, const_cast<float*>(v.data())).clone();
}

/// The line of a file that names its features.
std::string featureLine() {
  std::string line = "features:";
  for (const SemanticFeature& feature : kSemanticFeatureList) {
    line += std::string(" ") + feature.name;
  }
  return line;
}

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

/// The index of a feature; nothing for any other word.
std::optional<int> featureIndex(std::string_view name) {
  for (std::size_t i = 0; i < kSemanticFeatures; ++i) {
    if (name == kSemanticFeatureList[i].name) return static_cast<int>(i);
  }
  return std::nullopt;
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

/// The trees one after the other, each node before what is below it: a split is followed by its
/// left side, where the feature is at most the threshold.
struct SemanticForest::Model {
  struct Node {
    int feature = -1;  ///< of a split; -1: a leaf
    float threshold = 0.0f;
    std::size_t right = 0;  ///< other side of a split
    SemanticClass semantic_class = SemanticClass::kCorridor;
  };
  std::vector<Node> nodes;
  std::vector<std::size_t> roots;

  SemanticClass ask(std::size_t root, const std::array<float, kSemanticFeatures>& features) const {
    std::size_t at = root;
    while (nodes[at].feature >= 0) {
      const Node& node = nodes[at];
      const bool left = features[static_cast<std::size_t>(node.feature)] <= node.threshold;
      at = left ? at + 1 : node.right;
    }
    return nodes[at].semantic_class;
  }

  /// Adds a tree of OpenCV's from a node of it on.
  void add(const cv::ml::DTrees& trees, int from) {
    const auto& given = trees.getNodes()[static_cast<std::size_t>(from)];
    const std::size_t own = nodes.size();
    nodes.emplace_back();
    if (given.split < 0) {
      nodes[own].semantic_class = kAllSemanticClasses.at(static_cast<std::size_t>(given.value));
      return;
    }
    const auto& split = trees.getSplits()[static_cast<std::size_t>(given.split)];
    nodes[own].feature = split.varIdx;
    nodes[own].threshold = split.c;
    add(trees, given.left);
    nodes[own].right = nodes.size();
    add(trees, given.right);
  }

  /// A line "tree" before each, then a node a line: "FEATURE THRESHOLD" or the name of a
  /// class.
  std::string text() const {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(std::numeric_limits<float>::max_digits10);
    auto root = roots.begin();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Node& node = nodes[i];
      if (root != roots.end() && *root == i) {
        out << "tree\n";
        ++root;
      }
      if (node.feature < 0) {
        out << toString(node.semantic_class) << "\n";
      } else {
        out << kSemanticFeatureList[static_cast<std::size_t>(node.feature)].name << " "
            << node.threshold << "\n";
      }
    }
    return out.str();
  }

  static Model read(Lines lines, const std::string& source);

 private:
  static Node readNode(std::string_view line, std::vector<std::string_view>& fields,
                       const std::function<void(const char*)>& fail);
};

SemanticForest::Model::Node SemanticForest::Model::readNode(
    std::string_view line, std::vector<std::string_view>& fields,
    const std::function<void(const char*)>& fail) {
  Node node;
  hyselam::splitFields(line, &fields);
  if (fields.size() == 1) {
    const auto semantic_class = semanticClassFromString(std::string(fields[0]));
    if (!semantic_class) fail("is no class");
    node.semantic_class = *semantic_class;
  } else if (fields.size() == 2) {
    const auto feature = featureIndex(fields[0]);
    const auto threshold = hyselam::parseNumber(fields[1]);
    if (!feature) fail("names a feature that there is not");
    if (!threshold || std::abs(*threshold) > std::numeric_limits<float>::max()) {
      fail("has a threshold that is no number");
    }
    node.feature = *feature;
    node.threshold = static_cast<float>(*threshold);
  } else {
    fail("must be a class, or a feature and a threshold");
  }
  return node;
}

SemanticForest::Model SemanticForest::Model::read(Lines lines, const std::string& source) {
  Model model;
  std::vector<std::size_t> waiting;  // splits without their right side
  bool ended = true;                 // a side, or a tree; else a node must follow
  std::vector<std::string_view> fields;
  const auto fail = [&](const char* reason) {
    throw hyselam::InputError(source, "line " + std::to_string(lines.number), reason);
  };
  for (std::string_view line; lines.next(&line);) {
    const std::size_t own = model.nodes.size();
    if (line == "tree") {
      if (!ended || !waiting.empty()) fail("begins a tree within a tree");
      model.roots.push_back(own);
      ended = false;
      continue;
    }
    if (ended) {
      if (waiting.empty()) fail("stands outside of a tree");
      model.nodes[waiting.back()].right = own;
      waiting.pop_back();
    }
    model.nodes.push_back(readNode(line, fields, fail));
    ended = model.nodes.back().feature < 0;
    if (!ended) waiting.push_back(own);
  }
  if (model.roots.empty() || !ended || !waiting.empty()) {
    throw hyselam::InputError(source, "", "ends within a tree");
  }
  return model;
}

SemanticForest::SemanticForest(std::unique_ptr<Model> model) : model_(std::move(model)) {}
SemanticForest::SemanticForest(SemanticForest&&) noexcept = default;
SemanticForest& SemanticForest::operator=(SemanticForest&&) noexcept = default;
SemanticForest::~SemanticForest() = default;

void ForestParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("trees", trees, Range::between(1, 1000), "", "of the forest");
  visit("depth", depth, Range::between(1, 24), "", "of a tree at most");
  visit("min_examples", min_examples, Range::between(1, 1 << 20), "",
        "examples in a node that is divided further");
  visit("features_per_split", features_per_split,
        Range::between(1, static_cast<double>(kSemanticFeatures)), "",
        "features that a node chooses from");
}

void ForestParams::validate() const {
  hyselam::checkParameters(*this);
}

SemanticForest SemanticForest::train(const std::vector<SemanticExample>& examples,
                                     const ForestParams& params) {
  params.validate();
  if (examples.empty()) throw hyselam::ParameterError("examples", 0, "at least one");
  cv::Mat samples, answers;
  for (const SemanticExample& e : examples) {
    samples.push_back(rowOf(e.features));
    answers.push_back(static_cast<int>(indexOf(e.semantic_class)));
  }
  const auto trees = cv::ml::RTrees::create();
  trees->setMaxDepth(params.depth);
  trees->setMinSampleCount(params.min_examples);
  trees->setActiveVarCount(params.features_per_split);
  trees->setTermCriteria({cv::TermCriteria::MAX_ITER, params.trees, 0.0});
  cv::Mat types(samples.cols + 1, 1, CV_8U, cv::Scalar(cv::ml::VAR_ORDERED));
  types.at<uchar>(samples.cols) = cv::ml::VAR_CATEGORICAL;
  // OpenCV draws from the thread's own generator.
  const std::uint64_t before = cv::theRNG().state;
  cv::theRNG().state = hyselam::mix(params.seed, 1) | 1;
  trees->train(cv::ml::TrainData::create(samples, cv::ml::ROW_SAMPLE, answers, cv::noArray(),
                                         cv::noArray(), cv::noArray(), types));
  cv::theRNG().state = before;
  auto model = std::make_unique<Model>();
  for (const int root : trees->getRoots()) {
    model->roots.push_back(model->nodes.size());
    model->add(*trees, root);
  }
  return SemanticForest(std::move(model));
}

void SemanticForest::setOrigin(const ForestOrigin& origin) {
  for (const OriginLine& line : kOriginLines) {
    if ((origin.*line.member).find('\n') != std::string::npos) {
      throw hyselam::ParameterError("origin of the forest", origin.*line.member, "one line");
    }
  }
  origin_ = origin;
}

std::string SemanticForest::text() const {
  std::string text = std::string(kMagic) + "\n";
  for (const OriginLine& line : kOriginLines) text += line.name + origin_.*line.member + "\n";
  text += featureLine() + "\n" + model_->text();
  return text + kSumName + hyselam::crc32Text(text) + "\n";
}

void SemanticForest::save(const std::string& path) const {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << text(); });
}

SemanticForest SemanticForest::load(const std::string& path) {
  return parse(hyselam::readTextFile(path, kMaxBytes), path);
}

SemanticForest SemanticForest::parse(const std::string& text, const std::string& source) {
  if (text.compare(0, std::string(kMagic).size() + 1, std::string(kMagic) + "\n") != 0) {
    throw hyselam::InputError(source, "line 1", "is no forest of semantic classes of this version");
  }
  const std::string example = kSumName + hyselam::crc32Text("") + "\n";
  const std::size_t end = text.size() - std::min(text.size(), example.size());
  if (text.substr(end) != kSumName + hyselam::crc32Text(text.substr(0, end)) + "\n") {
    throw hyselam::InputError(source, "", "is damaged or cut off: its checksum is wrong");
  }
  Lines lines{std::string_view(text).substr(0, end)};
  std::string_view line;
  lines.next(&line);
  ForestOrigin origin;
  for (const OriginLine& expected : kOriginLines) {
    const std::string name = expected.name;
    if (!lines.next(&line) || line.substr(0, name.size()) != name) {
      throw hyselam::InputError(source, "line " + std::to_string(lines.number),
                                "does not begin with '" + name + "'");
    }
    origin.*expected.member = std::string(line.substr(name.size()));
  }
  if (!lines.next(&line) || line != featureLine()) {
    throw hyselam::InputError(source, "line " + std::to_string(lines.number),
                              "was made for other features: train it again with train_semantic");
  }
  SemanticForest forest(std::make_unique<Model>(Model::read(lines, source)));
  forest.origin_ = origin;
  return forest;
}

SemanticPrediction SemanticForest::classify(const SemanticFeatures& features) const {
  const auto values = vectorOf(features);
  std::array<std::size_t, kSemanticClasses> votes{};
  for (const std::size_t root : model_->roots) ++votes[indexOf(model_->ask(root, values))];
  const auto best = std::max_element(votes.begin(), votes.end());
  return {kAllSemanticClasses[static_cast<std::size_t>(best - votes.begin())],
          static_cast<double>(*best) / static_cast<double>(model_->roots.size())};
}

}  // namespace ngram_slam
