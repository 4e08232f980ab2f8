// The trees of a forest and the file that they are kept in: what all forests have in common.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ngram_slam/semantics/semantic_class.hpp"
#include "ngram_slam/semantics/semantic_forest.hpp"

namespace ngram_slam {

/// What a file of a forest begins with, and the names of the features it was made for.
struct ForestFormat {
  std::string magic;    ///< the first line
  std::string retrain;  ///< tool that makes one
  std::vector<std::string> features;
};

/// The trees one after the other, each node before what is below it: a split is followed by its
/// left side, where the feature is at most the threshold.
class ForestTrees {
 public:
  /// The same samples and parameters give the same trees. Samples have one length and are not
  /// empty.
  static ForestTrees train(const std::vector<std::vector<float>>& samples,
                           const std::vector<SemanticClass>& classes, const ForestParams& params);

  /// How many trees say each class.
  std::array<std::size_t, kSemanticClasses> votes(const float* features) const;
  std::size_t size() const { return roots_.size(); }

  /// The whole file.
  std::string text(const ForestFormat& format, const ForestOrigin& origin) const;
  /// @throws hyselam::InputError for what text() of the same format does not write.
  static ForestTrees parse(const std::string& text, const std::string& source,
                           const ForestFormat& format, ForestOrigin* origin);

 private:
  struct Node {
    int feature = -1;  ///< of a split; -1: a leaf
    float threshold = 0.0f;
    std::size_t right = 0;  ///< other side of a split
    SemanticClass semantic_class = SemanticClass::kCorridor;
  };
  class Reader;
  class Grower;

  std::vector<Node> nodes_;
  std::vector<std::size_t> roots_;
};

/// @throws hyselam::ParameterError unless each is one line.
void requireLines(const ForestOrigin& origin);

}  // namespace ngram_slam
