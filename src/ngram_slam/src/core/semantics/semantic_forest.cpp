#include "ngram_slam/semantics/semantic_forest.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/rng.hpp"

namespace ngram_slam {
namespace {

constexpr const char* kMagic = "ngram_slam semantic forest 2";
constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

cv::Mat rowOf(const SemanticFeatures& features) {
  const auto v = vectorOf(features);
  return cv::Mat(1, static_cast<int>(v.size()), CV_32F, const_cast<float*>(v.data())).clone();
}

/// The first line of a file with that body.
std::string headOf(const std::string& body) {
  std::ostringstream out;
  out << kMagic << ", " << kSemanticFeatures << " features, crc32 " << hyselam::crc32Text(body);
  return out.str();
}

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

  /// A line "tree" before each, then a node a line: "FEATURE THRESHOLD" or the name of a class.
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
        out << nameOf(node.semantic_class) << "\n";
      } else {
        out << node.feature << " " << node.threshold << "\n";
      }
    }
    return out.str();
  }

  static Model read(const std::string& body, const std::string& path);
};

SemanticForest::Model SemanticForest::Model::read(const std::string& body,
                                                  const std::string& path) {
  Model model;
  std::vector<std::size_t> waiting;  // splits without their right side
  bool ended = true;                 // a side, or a tree; else a node must follow
  std::vector<std::string_view> fields;
  hyselam::forEachLine(body, [&](std::size_t number, std::string_view line) {
    const auto fail = [&](const char* reason) {
      throw hyselam::InputError(path, "line " + std::to_string(number + 1), reason);
    };
    const std::size_t own = model.nodes.size();
    if (line == "tree") {
      if (!ended || !waiting.empty()) fail("begins a tree within a tree");
      model.roots.push_back(own);
      ended = false;
      return;
    }
    if (ended) {
      if (waiting.empty()) fail("stands outside of a tree");
      model.nodes[waiting.back()].right = own;
      waiting.pop_back();
    }
    Node node;
    hyselam::splitFields(line, &fields);
    if (fields.size() == 1) {
      const auto semantic_class = semanticClassOf(std::string(fields[0]));
      if (!semantic_class) fail("is no class");
      node.semantic_class = *semantic_class;
      ended = true;
    } else if (fields.size() == 2) {
      const auto feature = hyselam::parseNumber(fields[0]);
      const auto threshold = hyselam::parseNumber(fields[1]);
      if (!feature || *feature != std::floor(*feature) || *feature < 0.0 ||
          *feature >= kSemanticFeatures) {
        fail("names a feature that there is not");
      }
      if (!threshold || std::abs(*threshold) > std::numeric_limits<float>::max()) {
        fail("has a threshold that is no number");
      }
      node.feature = static_cast<int>(*feature);
      node.threshold = static_cast<float>(*threshold);
      waiting.push_back(own);
      ended = false;
    } else {
      fail("must be a class, or a feature and a threshold");
    }
    model.nodes.push_back(node);
  });
  if (model.roots.empty() || !ended || !waiting.empty()) {
    throw hyselam::InputError(path, "", "ends within a tree");
  }
  return model;
}

SemanticForest::SemanticForest(std::unique_ptr<Model> model) : model_(std::move(model)) {}
SemanticForest::SemanticForest(SemanticForest&&) noexcept = default;
SemanticForest& SemanticForest::operator=(SemanticForest&&) noexcept = default;
SemanticForest::~SemanticForest() = default;

void ForestParams::validate() const {
  const auto require = [](const char* name, int value, int low, int high, const char* allowed) {
    if (value < low || value > high) throw hyselam::ParameterError(name, value, allowed);
  };
  require("trees", trees, 1, 1000, "in 1 .. 1000");
  require("depth", depth, 1, 24, "in 1 .. 24");
  require("smallest", smallest, 1, 1 << 20, ">= 1");
  require("choice", choice, 1, static_cast<int>(kSemanticFeatures), "in 1 .. number of features");
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
  trees->setMinSampleCount(params.smallest);
  trees->setActiveVarCount(params.choice);
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

void SemanticForest::save(const std::string& path) const {
  const std::string body = model_->text();
  const std::string text = headOf(body) + "\n" + body;
  if (path.size() < 3 || path.compare(path.size() - 3, 3, ".gz") != 0) {
    hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << text; });
    return;
  }
  hyselam::replaceFileAtomically(path, [&](const std::string& temporary) {
    const gzFile packed = gzopen(temporary.c_str(), "wb9");
    const bool written =
        packed != nullptr && gzwrite(packed, text.data(), static_cast<unsigned>(text.size())) ==
                                 static_cast<int>(text.size());
    const bool closed = packed != nullptr && gzclose(packed) == Z_OK;
    if (!written || !closed) throw hyselam::InputError(path, "", "cannot be written");
  });
}

SemanticForest SemanticForest::load(const std::string& path) {
  const std::string text = hyselam::readTextFile(path, kMaxBytes);
  const std::size_t line = text.find('\n');
  const std::string head = text.substr(0, line);
  if (head.compare(0, std::string(kMagic).size(), kMagic) != 0)
    throw hyselam::InputError(path, "line 1", "is no forest of semantic classes of this version");
  const std::string body = line == std::string::npos ? "" : text.substr(line + 1);
  const std::string expected = headOf(body);
  const std::size_t sum = expected.rfind(' ');
  if (head.compare(0, sum, expected, 0, sum) != 0)
    throw hyselam::InputError(path, "line 1",
                              "was made for other features: train it again with train_semantic");
  if (head != expected)
    throw hyselam::InputError(path, "", "is damaged or cut off: its checksum is wrong");
  return SemanticForest(std::make_unique<Model>(Model::read(body, path)));
}

SemanticVerdict SemanticForest::classify(const SemanticFeatures& features) const {
  const auto values = vectorOf(features);
  std::array<std::size_t, kSemanticClasses> votes{};
  for (const std::size_t root : model_->roots) ++votes[indexOf(model_->ask(root, values))];
  const auto best = std::max_element(votes.begin(), votes.end());
  return {kAllSemanticClasses[static_cast<std::size_t>(best - votes.begin())],
          static_cast<double>(*best) / static_cast<double>(model_->roots.size())};
}

}  // namespace ngram_slam
