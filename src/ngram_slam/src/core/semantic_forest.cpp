#include "ngram_slam/semantic_forest.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"

namespace ngram_slam {
namespace {

constexpr const char* kMagic = "ngram_slam semantic forest 1";
constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

std::string checksum(const std::string& body) {
  std::ostringstream out;
  out << std::hex << hyselam::crc32Of(body);
  return out.str();
}

cv::Mat rowOf(const SemanticFeatures& features) {
  const auto v = vectorOf(features);
  return cv::Mat(1, static_cast<int>(v.size()), CV_32F, const_cast<float*>(v.data())).clone();
}

/// NaN stands for what is no number.
std::vector<double> numbersOf(const cv::FileNode& list) {
  std::vector<double> numbers;
  for (const cv::FileNode& entry : list) {
    const bool number = entry.isInt() || entry.isReal();
    numbers.push_back(number ? entry.real() : std::numeric_limits<double>::quiet_NaN());
  }
  return numbers;
}

/// OpenCV believes what a file says of its own layout. These lists are always the same for
/// features that are ordered and one class.
bool hasLayout(const cv::FileNode& root) {
  std::vector<double> indices(kSemanticFeatures);
  std::iota(indices.begin(), indices.end(), 0.0);
  std::vector<double> types(kSemanticFeatures, cv::ml::VAR_ORDERED);
  types.push_back(cv::ml::VAR_CATEGORICAL);
  if (numbersOf(root["var_idx"]) != indices || numbersOf(root["var_type"]) != types ||
      numbersOf(root["cat_ofs"]) != std::vector<double>(2 * kSemanticFeatures, 0.0) ||
      numbersOf(root["missing_subst"]).size() != types.size()) {
    return false;
  }
  const std::vector<double> labels = numbersOf(root["class_labels"]);
  return !labels.empty() && std::all_of(labels.begin(), labels.end(), [](double label) {
    return label >= 0.0 && label < kSemanticClasses && label == std::floor(label);
  });
}

/// Whether every way down a tree ends in a class.
bool isSound(const cv::ml::RTrees& trees, std::size_t classes) {
  const auto& nodes = trees.getNodes();
  const auto& splits = trees.getSplits();
  const auto within = [](int index, std::size_t size) {
    return index >= 0 && static_cast<std::size_t>(index) < size;
  };
  const auto& roots = trees.getRoots();
  for (const int root : roots) {
    if (!within(root, nodes.size())) return false;
  }
  for (const auto& node : nodes) {
    if (!within(node.classIdx, classes)) return false;
    if (node.split < 0) continue;
    if (!within(node.split, splits.size()) || !within(node.left, nodes.size()) ||
        !within(node.right, nodes.size()) ||
        !within(splits[static_cast<std::size_t>(node.split)].varIdx, kSemanticFeatures)) {
      return false;
    }
  }
  return !roots.empty() && trees.isClassifier();
}

}  // namespace

struct SemanticForest::Model {
  cv::Ptr<cv::ml::RTrees> trees;
};

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
  auto model = std::make_unique<Model>();
  model->trees = cv::ml::RTrees::create();
  model->trees->setMaxDepth(params.depth);
  model->trees->setMinSampleCount(params.smallest);
  model->trees->setActiveVarCount(params.choice);
  model->trees->setTermCriteria({cv::TermCriteria::MAX_ITER, params.trees, 0.0});
  cv::Mat types(samples.cols + 1, 1, CV_8U, cv::Scalar(cv::ml::VAR_ORDERED));
  types.at<uchar>(samples.cols) = cv::ml::VAR_CATEGORICAL;
  // OpenCV draws from the thread's own generator.
  const std::uint64_t before = cv::theRNG().state;
  cv::theRNG().state = hyselam::mix(params.seed, 1) | 1;
  model->trees->train(cv::ml::TrainData::create(samples, cv::ml::ROW_SAMPLE, answers, cv::noArray(),
                                                cv::noArray(), cv::noArray(), types));
  cv::theRNG().state = before;
  return SemanticForest(std::move(model));
}

void SemanticForest::save(const std::string& path) const {
  cv::FileStorage file(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  model_->trees->write(file);
  const std::string body = file.releaseAndGetString();
  std::ostringstream head;
  head << kMagic << ", " << kSemanticFeatures << " features, crc32 " << checksum(body) << "\n";
  const std::string text = head.str() + body;
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
  std::ostringstream expected;
  expected << kMagic << ", " << kSemanticFeatures << " features, crc32 ";
  if (head.compare(0, expected.str().size(), expected.str()) != 0)
    throw hyselam::InputError(path, "line 1",
                              "was made for other features: train it again with train_semantic");
  if (head != expected.str() + checksum(body))
    throw hyselam::InputError(path, "", "is damaged or cut off: its checksum is wrong");
  auto model = std::make_unique<Model>();
  std::size_t classes = 0;
  try {
    const cv::FileStorage file(body, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (!hasLayout(file.root())) {
      throw hyselam::InputError(path, "", "holds no forest for these features");
    }
    model->trees = cv::Algorithm::read<cv::ml::RTrees>(file.root());
    classes = file.root()["class_labels"].size();
  } catch (const hyselam::InputError&) {
    throw;
  } catch (const cv::Exception& e) {
    throw hyselam::InputError(path, "", "holds no forest: " + e.err);
  } catch (const std::exception& e) {
    throw hyselam::InputError(path, "", std::string("holds no forest: ") + e.what());
  }
  if (!model->trees || !model->trees->isTrained() ||
      model->trees->getVarCount() != static_cast<int>(kSemanticFeatures) ||
      !isSound(*model->trees, classes)) {
    throw hyselam::InputError(path, "", "holds a forest whose trees are not whole");
  }
  return SemanticForest(std::move(model));
}

SemanticVerdict SemanticForest::classify(const SemanticFeatures& features) const {
  // The first row of the votes holds the classes, the second how many trees chose each.
  cv::Mat votes;
  model_->trees->getVotes(rowOf(features), votes, 0);
  double all = 0.0;
  int best = 0;
  for (int c = 0; c < votes.cols; ++c) {
    all += votes.at<int>(1, c);
    if (votes.at<int>(1, c) > votes.at<int>(1, best)) best = c;
  }
  const auto index = static_cast<std::size_t>(votes.at<int>(0, best));
  return {kAllSemanticClasses[std::min(index, kSemanticClasses - 1)],
          votes.at<int>(1, best) / std::max(1.0, all)};
}

}  // namespace ngram_slam
