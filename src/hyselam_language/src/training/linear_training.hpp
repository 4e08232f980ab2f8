// Learns a LinearClassifier by L1-regularized logistic regression (liblinear), which leaves most
// features without a weight.
#pragma once

#include <string>
#include <vector>

#include "reader/linear_classifier.hpp"

namespace hyselam_topo {
namespace language {

class TrainingSet {
 public:
  void add(const Features& features, const std::string& label);
  bool empty() const { return labels_.empty(); }

  /// Features seen in fewer than `least_seen` examples, and labels with fewer, are left out; `cost`
  /// is liblinear's C. The same examples in the same order give the same classifier.
  LinearClassifier train(double cost, std::size_t least_seen) const;

 private:
  std::vector<Features> features_;
  std::vector<std::string> labels_;
};

}  // namespace language
}  // namespace hyselam_topo
