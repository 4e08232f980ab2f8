#include "ngram_slam/semantics/semantic_forest.hpp"

#include <algorithm>

#include "forest_trees.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"

namespace ngram_slam {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

const ForestFormat& format() {
  static const ForestFormat format = [] {
    ForestFormat f{"ngram_slam semantic forest 3", "train_semantic", {}};
    for (const SemanticFeature& feature : kSemanticFeatureList)
      f.features.emplace_back(feature.name);
    return f;
  }();
  return format;
}

}  // namespace

struct SemanticForest::Model {
  ForestTrees trees;
};

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
  std::vector<std::vector<float>> samples;
  std::vector<SemanticClass> classes;
  for (const SemanticExample& e : examples) {
    const auto values = vectorOf(e.features);
    samples.emplace_back(values.begin(), values.end());
    classes.push_back(e.semantic_class);
  }
  return SemanticForest(
      std::make_unique<Model>(Model{ForestTrees::train(samples, classes, params)}));
}

void SemanticForest::setOrigin(const ForestOrigin& origin) {
  requireLines(origin);
  origin_ = origin;
}

std::string SemanticForest::text() const {
  return model_->trees.text(format(), origin_);
}

void SemanticForest::save(const std::string& path) const {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << text(); });
}

SemanticForest SemanticForest::load(const std::string& path) {
  return parse(hyselam::readTextFile(path, kMaxBytes), path);
}

SemanticForest SemanticForest::parse(const std::string& text, const std::string& source) {
  ForestOrigin origin;
  SemanticForest forest(
      std::make_unique<Model>(Model{ForestTrees::parse(text, source, format(), &origin)}));
  forest.origin_ = origin;
  return forest;
}

SemanticPrediction SemanticForest::classify(const SemanticFeatures& features) const {
  const auto values = vectorOf(features);
  const auto votes = model_->trees.votes(values.data());
  const auto best = std::max_element(votes.begin(), votes.end());
  return {kAllSemanticClasses[static_cast<std::size_t>(best - votes.begin())],
          static_cast<double>(*best) / static_cast<double>(model_->trees.size())};
}

}  // namespace ngram_slam
