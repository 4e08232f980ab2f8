#include "ngram_slam/semantics/way_forest.hpp"

#include <algorithm>
#include <cmath>

#include "forest_trees.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"

namespace ngram_slam {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

const ForestFormat& format() {
  static const ForestFormat format{"ngram_slam way forest 1", "train_way_regions",
                                   wayFeatureNames()};
  return format;
}

void requireUsable(const std::vector<WayExample>& examples) {
  if (examples.empty()) throw hyselam::ParameterError("examples", 0, "at least one");
  for (const WayExample& e : examples) {
    if (e.features.size() != wayFeatureNames().size()) {
      throw hyselam::ParameterError("features of an example", e.features.size(),
                                    std::to_string(wayFeatureNames().size()));
    }
    if (!(e.weight > 0.0) || !std::isfinite(e.weight)) {
      throw hyselam::ParameterError("weight of an example", e.weight, "above 0");
    }
  }
}

/// The examples drawn, in order; often is drawn what has much weight and is of a rare kind.
std::vector<std::size_t> draw(const std::vector<WayExample>& examples,
                              const WayForestParams& params) {
  std::array<double, kSemanticClasses> of_class{};
  for (const WayExample& e : examples) of_class[indexOf(e.semantic_class)] += e.weight;
  std::vector<double> sums;
  double sum = 0.0;
  for (const WayExample& e : examples) {
    sum += e.weight * std::pow(of_class[indexOf(e.semantic_class)], -params.balance);
    sums.push_back(sum);
  }
  hyselam::Rng rng(params.forest.seed, 2);
  std::vector<std::size_t> drawn;
  for (int i = 0; i < params.draws; ++i) {
    const auto at = std::upper_bound(sums.begin(), sums.end(), rng.uniform() * sum);
    drawn.push_back(std::min(sums.size() - 1, static_cast<std::size_t>(at - sums.begin())));
  }
  return drawn;
}

}  // namespace

SignatureSensorParams waySensorParams() {
  SignatureSensorParams params;
  params.spacing = 0.25;
  return params;
}

WayForestParams::WayForestParams() {
  forest.trees = 40;
  forest.depth = 14;
  forest.min_examples = 4;
  forest.features_per_split = 11;
}

void WayForestParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.group("", forest);
  visit("draws", draws, Range::between(1, 10000000), "", "examples drawn to learn from");
  visit("balance", balance, Range::between(0.0, 1.0), "",
        "0: kinds as often as they come, 1: all as often as each other");
}

void WayForestParams::validate() const {
  hyselam::checkParameters(*this);
}

struct WayForest::Model {
  ForestTrees trees;
};

WayForest::WayForest(std::unique_ptr<Model> model) : model_(std::move(model)) {}
WayForest::WayForest(WayForest&&) noexcept = default;
WayForest& WayForest::operator=(WayForest&&) noexcept = default;
WayForest::~WayForest() = default;

WayForest WayForest::train(const std::vector<WayExample>& examples, const WayForestParams& params) {
  params.validate();
  requireUsable(examples);
  std::vector<std::vector<float>> samples;
  std::vector<SemanticClass> classes;
  for (const std::size_t i : draw(examples, params)) {
    samples.push_back(examples[i].features);
    classes.push_back(examples[i].semantic_class);
  }
  return WayForest(
      std::make_unique<Model>(Model{ForestTrees::train(samples, classes, params.forest)}));
}

void WayForest::setOrigin(const ForestOrigin& origin) {
  requireLines(origin);
  origin_ = origin;
}

std::string WayForest::text() const {
  return model_->trees.text(format(), origin_);
}

void WayForest::save(const std::string& path) const {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << text(); });
}

WayForest WayForest::load(const std::string& path) {
  return parse(hyselam::readTextFile(path, kMaxBytes), path);
}

WayForest WayForest::parse(const std::string& text, const std::string& source) {
  ForestOrigin origin;
  WayForest forest(
      std::make_unique<Model>(Model{ForestTrees::parse(text, source, format(), &origin)}));
  forest.origin_ = origin;
  return forest;
}

ClassShares WayForest::sharesOf(const std::vector<float>& features) const {
  if (features.size() != wayFeatureNames().size()) {
    throw hyselam::ParameterError("features", features.size(),
                                  std::to_string(wayFeatureNames().size()));
  }
  const auto votes = model_->trees.votes(features.data());
  ClassShares shares{};
  for (std::size_t c = 0; c < kSemanticClasses; ++c) {
    shares[c] = static_cast<double>(votes[c]) / static_cast<double>(model_->trees.size());
  }
  return shares;
}

std::vector<SemanticPrediction> WayForest::classify(const std::vector<WayPlace>& run,
                                                    const WayDecisionParams& params) const {
  std::vector<ClassShares> shares;
  for (const std::vector<float>& f : wayFeaturesOf(run)) shares.push_back(sharesOf(f));
  const std::vector<SemanticClass> classes = mostLikelyClasses(shares, params);
  std::vector<SemanticPrediction> out;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    out.push_back({classes[i], shares[i][indexOf(classes[i])]});
  }
  return out;
}

}  // namespace ngram_slam
