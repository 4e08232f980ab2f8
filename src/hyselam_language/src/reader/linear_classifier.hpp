// One logistic regression for each class over features that are words: which class is likeliest,
// and how likely (the shares of the classes' logistic values).
#pragma once

#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace hyselam_topo {
namespace language {

using Features = std::vector<std::string>;

class LinearClassifier {
 public:
  /// Lines "classes A B ..." and "FEATURE CLASS_INDEX:WEIGHT ...", fields parted by one space,
  /// weights in thousandths. Throws hyselam::InputError that names `source` and the line.
  static LinearClassifier fromText(const std::string& source, const std::string& text);
  std::string toText() const;

  LinearClassifier() = default;
  explicit LinearClassifier(std::vector<std::string> classes) : classes_(std::move(classes)) {}
  void setWeight(const std::string& feature, std::size_t of_class, float weight);

  const std::vector<std::string>& classes() const { return classes_; }
  /// One for each class; they sum to 1. Features that no weight knows count nothing, those that
  /// stand there twice count once.
  std::vector<double> probabilities(const Features& features) const;
  /// The sums of weights that the features give the classes ...
  std::vector<double> scores(const Features& features) const;
  /// ... and the probabilities of such sums.
  static std::vector<double> probabilitiesOf(std::vector<double> scores);

 private:
  using Weight = std::pair<std::size_t, float>;  // class, weight
  std::vector<std::string> classes_;
  std::unordered_map<std::string, std::size_t> features_;  // of which weights
  std::vector<std::vector<Weight>> weights_;
};

}  // namespace language
}  // namespace hyselam_topo
