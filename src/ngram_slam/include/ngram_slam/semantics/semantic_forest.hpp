// The class of a region, learned from examples: a random forest (Breiman 2001, by OpenCV).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "ngram_slam/semantics/semantic_classifier.hpp"
#include "ngram_slam/semantics/semantic_examples.hpp"

namespace ngram_slam {

struct ForestParams {
  int trees = 60;              ///< 1 .. 1000
  int depth = 10;              ///< of a tree at most, 1 .. 24
  int min_examples = 5;        ///< examples in a node that is divided further, >= 1
  int features_per_split = 4;  ///< features that a node chooses from, 1 .. kSemanticFeatures
  std::uint64_t seed = 1;      ///< of the choices

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Where a forest comes from; one line each, in its file for people to read.
struct ForestOrigin {
  std::string command;        ///< that trained it
  std::string data;           ///< how many examples of what, and their checksum
  std::string in_sample;      ///< scores on what it has learned from
  std::string out_of_sample;  ///< scores on other data
};

/// A forest of decision trees; the confidence is the share of the trees that agree.
///
/// File, plain text: "ngram_slam semantic forest 3"; the four lines of ForestOrigin, each behind
/// its name ("command: ", "data: ", "in sample: ", "out of sample: "); "features: " and the names
/// of all features; for each tree "tree" and its nodes, a split before what is below it: "FEATURE
/// THRESHOLD", then the side where the feature is at most the threshold, then the other one; a leaf
/// is the name of a class. The last line is "crc32 " and the checksum of all before it.
class SemanticForest : public SemanticClassifier {
 public:
  /// The same examples and parameters give the same forest. @throws hyselam::ParameterError for
  /// parameters out of range or without examples.
  static SemanticForest train(const std::vector<SemanticExample>& examples,
                              const ForestParams& params = {});
  /// The forest of models/semantic_forest.txt, which the library carries.
  static SemanticForest shipped();
  /// @throws hyselam::InputError for a missing, damaged or foreign file, or one made for other
  /// features.
  static SemanticForest load(const std::string& path);
  /// The same from the text of a file; `source` names it in errors.
  static SemanticForest parse(const std::string& text, const std::string& source);
  /// Replaces the file at once. @throws hyselam::InputError
  void save(const std::string& path) const;
  std::string text() const;

  const ForestOrigin& origin() const { return origin_; }
  /// @throws hyselam::ParameterError unless each is one line.
  void setOrigin(const ForestOrigin& origin);

  SemanticForest(SemanticForest&&) noexcept;
  SemanticForest& operator=(SemanticForest&&) noexcept;
  ~SemanticForest() override;
  SemanticPrediction classify(const SemanticFeatures& features) const override;

 private:
  struct Model;
  explicit SemanticForest(std::unique_ptr<Model> model);
  std::unique_ptr<Model> model_;
  ForestOrigin origin_;
};

}  // namespace ngram_slam
