// How many observations got the right class (Maffei 2017, 6.4: weight by length, tolerant borders).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "ngram_slam/semantics/semantic_class.hpp"

namespace ngram_slam {

/// counts[truth][prediction], in observations.
struct SemanticConfusion {
  std::array<std::array<std::uint64_t, kSemanticClasses>, kSemanticClasses> counts{};

  void add(const SemanticConfusion& other);
  std::uint64_t total() const;
  std::uint64_t actual(SemanticClass c) const;     ///< observations of that class
  std::uint64_t predicted(SemanticClass c) const;  ///< observations taken for it
  /// Share of what was taken for the class that is of it; nothing if nothing was.
  std::optional<double> precision(SemanticClass c) const;
  /// Share of the class that was taken for it; nothing if there is none.
  std::optional<double> recall(SemanticClass c) const;
  /// Means over the classes that occur, as in 6.4; a class that occurs but is never predicted has
  /// precision 0. 0 without observations.
  double averagePrecision() const;
  double averageRecall() const;
  double accuracy() const;  ///< 0 without observations
};

/// Which wrong predictions near a border count as a border drawn too early or too late.
enum class BorderRule {
  kThesis,  ///< 6.4: all, if a place of the predicted class is within the tolerance
  kStrict   ///< of these, only where both places were found: part of the true place is predicted
            ///< right, and so is part of the predicted region
};

/// Compares along one run; `tolerance` in observations. Observations without truth count nowhere
/// and end places. @throws hyselam::ParameterError if the lists differ in length.
SemanticConfusion compareClasses(const std::vector<std::optional<SemanticClass>>& truth,
                                 const std::vector<SemanticClass>& predicted,
                                 std::uint32_t tolerance = 10,
                                 BorderRule rule = BorderRule::kThesis);

}  // namespace ngram_slam
