// The class of a region, learned from examples: a random forest (Breiman 2001, by OpenCV).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ngram_slam/semantics/semantic_classifier.hpp"

namespace ngram_slam {

struct SemanticExample {
  SemanticFeatures features;
  SemanticClass semantic_class = SemanticClass::kCorridor;
};

struct ForestParams {
  int trees = 60;          ///< 1 .. 1000
  int depth = 10;          ///< of a tree at most, 1 .. 24
  int smallest = 5;        ///< examples in a node that is divided further, >= 1
  int choice = 4;          ///< features that a node chooses from, 1 .. kSemanticFeatures
  std::uint64_t seed = 1;  ///< of the choices

  /// @throws hyselam::ParameterError
  void validate() const;
};

/// The confidence is the share of the trees that agree.
class SemanticForest : public SemanticClassifier {
 public:
  /// The same examples and parameters give the same forest. @throws hyselam::ParameterError for
  /// parameters out of range or without examples.
  static SemanticForest train(const std::vector<SemanticExample>& examples,
                              const ForestParams& params = {});
  /// @throws hyselam::InputError for a missing, damaged or foreign file, or one made for other
  /// features.
  static SemanticForest load(const std::string& path);
  /// Text with a checksum, packed if the name ends in .gz, replacing the file at once.
  /// @throws hyselam::InputError
  void save(const std::string& path) const;

  SemanticForest(SemanticForest&&) noexcept;
  SemanticForest& operator=(SemanticForest&&) noexcept;
  ~SemanticForest() override;
  SemanticVerdict classify(const SemanticFeatures& features) const override;

 private:
  struct Model;
  explicit SemanticForest(std::unique_ptr<Model> model);
  std::unique_ptr<Model> model_;
};

}  // namespace ngram_slam
