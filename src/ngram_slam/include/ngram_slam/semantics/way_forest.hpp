// Kinds of regions in furnished buildings: a random forest on what lies around the places of a way
// (way_features.hpp), decided along the way (way_decision.hpp).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ngram_slam/semantics/semantic_forest.hpp"
#include "ngram_slam/semantics/way_decision.hpp"
#include "ngram_slam/semantics/way_features.hpp"
#include "ngram_slam/signatures/signature_sensor.hpp"

namespace ngram_slam {

/// What places must be for the shipped forest: of the sensor that it was learnt with.
SignatureSensorParams waySensorParams();

struct WayExample {
  std::vector<float> features;  ///< in the order of wayFeatureNames()
  SemanticClass semantic_class = SemanticClass::kCorridor;
  double weight = 1.0;  ///< > 0; how often it is drawn
};

struct WayForestParams {
  ForestParams forest;   ///< its seed is that of the draws as well
  int draws = 12000;     ///< examples drawn to learn from
  double balance = 0.5;  ///< 0: kinds as often as they come, 1: all as often as each other

  WayForestParams();
  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Const calls may run in several threads at once. The file is that of SemanticForest but for its
/// first line, "ngram_slam way forest 1", and the names of the features.
class WayForest {
 public:
  /// The same examples and parameters give the same forest. @throws hyselam::ParameterError for
  /// parameters out of range, without examples, or with one of another length or weight.
  static WayForest train(const std::vector<WayExample>& examples,
                         const WayForestParams& params = {});
  /// The forest of models/way_forest.txt, which the library carries.
  static WayForest shipped();
  /// @throws hyselam::InputError for a missing, damaged or foreign file.
  static WayForest load(const std::string& path);
  /// The same from the text of a file; `source` names it in errors.
  static WayForest parse(const std::string& text, const std::string& source);
  /// Replaces the file at once. @throws hyselam::InputError
  void save(const std::string& path) const;
  std::string text() const;

  const ForestOrigin& origin() const { return origin_; }
  /// @throws hyselam::ParameterError unless each is one line.
  void setOrigin(const ForestOrigin& origin);

  WayForest(WayForest&&) noexcept;
  WayForest& operator=(WayForest&&) noexcept;
  ~WayForest();

  /// What the trees say of one place.
  ClassShares sharesOf(const std::vector<float>& features) const;
  /// The class of each place of a run; the confidence is the share of the trees that say it.
  /// @throws hyselam::ParameterError
  std::vector<SemanticPrediction> classify(const std::vector<WayPlace>& run,
                                           const WayDecisionParams& params = {}) const;

 private:
  struct Model;
  explicit WayForest(std::unique_ptr<Model> model);
  std::unique_ptr<Model> model_;
  ForestOrigin origin_;
};

}  // namespace ngram_slam
