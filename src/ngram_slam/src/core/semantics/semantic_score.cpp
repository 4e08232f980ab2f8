#include "ngram_slam/semantics/semantic_score.hpp"

#include <algorithm>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {
namespace {

using Truth = std::optional<SemanticClass>;

/// For each observation, whether the stretch of equal values of `key` around it has a right one.
template <typename T>
std::vector<bool> stretchFound(const std::vector<T>& key, const std::vector<bool>& right) {
  std::vector<bool> out(key.size(), false);
  for (std::size_t begin = 0, end; begin < key.size(); begin = end) {
    bool found = false;
    for (end = begin; end < key.size() && key[end] == key[begin]; ++end) found |= right[end];
    for (std::size_t i = begin; i < end; ++i) out[i] = found;
  }
  return out;
}

}  // namespace

void SemanticConfusion::add(const SemanticConfusion& other) {
  for (std::size_t t = 0; t < kSemanticClasses; ++t) {
    for (std::size_t p = 0; p < kSemanticClasses; ++p) counts[t][p] += other.counts[t][p];
  }
}

std::uint64_t SemanticConfusion::actual(SemanticClass c) const {
  std::uint64_t n = 0;
  for (std::uint64_t k : counts[indexOf(c)]) n += k;
  return n;
}

std::uint64_t SemanticConfusion::predicted(SemanticClass c) const {
  std::uint64_t n = 0;
  for (const auto& row : counts) n += row[indexOf(c)];
  return n;
}

std::uint64_t SemanticConfusion::total() const {
  std::uint64_t n = 0;
  for (SemanticClass c : kAllSemanticClasses) n += actual(c);
  return n;
}

std::optional<double> SemanticConfusion::precision(SemanticClass c) const {
  const std::uint64_t n = predicted(c);
  if (n == 0) return std::nullopt;
  return static_cast<double>(counts[indexOf(c)][indexOf(c)]) / static_cast<double>(n);
}

std::optional<double> SemanticConfusion::recall(SemanticClass c) const {
  const std::uint64_t n = actual(c);
  if (n == 0) return std::nullopt;
  return static_cast<double>(counts[indexOf(c)][indexOf(c)]) / static_cast<double>(n);
}

double SemanticConfusion::averagePrecision() const {
  double sum = 0.0;
  int classes = 0;
  for (SemanticClass c : kAllSemanticClasses) {
    if (actual(c) == 0) continue;
    sum += precision(c).value_or(0.0);
    ++classes;
  }
  return classes == 0 ? 0.0 : sum / classes;
}

double SemanticConfusion::averageRecall() const {
  double sum = 0.0;
  int classes = 0;
  for (SemanticClass c : kAllSemanticClasses) {
    if (actual(c) == 0) continue;
    sum += recall(c).value_or(0.0);
    ++classes;
  }
  return classes == 0 ? 0.0 : sum / classes;
}

double SemanticConfusion::accuracy() const {
  std::uint64_t right = 0;
  for (std::size_t c = 0; c < kSemanticClasses; ++c) right += counts[c][c];
  return total() == 0 ? 0.0 : static_cast<double>(right) / static_cast<double>(total());
}

SemanticConfusion compareClasses(const std::vector<Truth>& truth,
                                 const std::vector<SemanticClass>& predicted,
                                 std::uint32_t tolerance, BorderRule rule) {
  const std::size_t n = truth.size();
  if (predicted.size() != n) {
    throw hyselam::ParameterError("predicted", predicted.size(), "as many as there are truths");
  }
  std::vector<bool> right(n);
  for (std::size_t i = 0; i < n; ++i) right[i] = truth[i] == predicted[i];
  const std::vector<bool> place_found = stretchFound(truth, right);
  const std::vector<bool> region_found = stretchFound(predicted, right);
  SemanticConfusion out;
  for (std::size_t i = 0; i < n; ++i) {
    if (!truth[i]) continue;
    bool forgiven = false;
    if (!right[i] && (rule == BorderRule::kThesis || (place_found[i] && region_found[i]))) {
      const std::size_t begin = i - std::min<std::size_t>(i, tolerance);
      const std::size_t end = std::min(n, i + tolerance + 1);
      for (std::size_t k = begin; k < end && !forgiven; ++k) forgiven = truth[k] == predicted[i];
    }
    ++out.counts[indexOf(*truth[i])][indexOf(forgiven ? *truth[i] : predicted[i])];
  }
  return out;
}

}  // namespace ngram_slam
