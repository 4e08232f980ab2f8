// The class of a region: the decision tree of the thesis (Fig. 6.8, Table 6.4).
#pragma once

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/pose2.hpp"
#include "ngram_slam/semantics/semantic_class.hpp"
#include "ngram_slam/semantics/semantic_features.hpp"

namespace ngram_slam {

struct SemanticPrediction {
  SemanticClass semantic_class = SemanticClass::kCorridor;
  double confidence = 1.0;  ///< 0..1
};

/// Classifies regions. Const calls may run in several threads at once.
class SemanticClassifier {
 public:
  virtual ~SemanticClassifier() = default;
  virtual SemanticPrediction classify(const SemanticFeatures& features) const = 0;
};

/// Thresholds of Table 6.4. Those of the density and of the frontiers depend on the kernel's
/// radius.
struct DecisionTreeParams {
  double high_variation = 0.1;                 ///< of the density
  double high_density = 0.8;                   ///< 0..1
  double few_frontiers = 1.5;                  ///< fewer are low
  double many_frontiers = 2.3;                 ///< more are high
  double huge_turn = hyselam::radians(120.0);  ///< more is very high [rad]
  double small_turn = hyselam::radians(20.0);  ///< less is low [rad]
  double very_long = 100.0;                    ///< [observations]
  /// The density hardly varies in a corner between two bifurcations. Low variation
  /// makes a region a corridor only if the robot turns by less than this in it [rad]; the thesis
  /// does not have this condition.
  double straight = hyselam::radians(45.0);

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Fig. 6.8: very long regions and straight ones of low variation are corridors; then few frontiers
/// make a hall (dense) or a corridor, many a bifurcation; then a huge turn makes a dead end, a
/// small one a corridor; the rest are corners.
///
/// The confidence is the smallest of those of the tests passed: 0.5 at a threshold, 1 far from it.
class DecisionTree : public SemanticClassifier {
 public:
  /// @throws hyselam::ParameterError
  explicit DecisionTree(const DecisionTreeParams& params = {});
  SemanticPrediction classify(const SemanticFeatures& features) const override;
  const DecisionTreeParams& params() const { return params_; }

 private:
  DecisionTreeParams params_;
};

}  // namespace ngram_slam
