// The exemplar classifier: soft nearest neighbors among all training signatures.
#pragma once

#include <vector>

#include "selovis/classifiers/classifier.hpp"

namespace selovis {

/// v^power * scale of each value of a signature; the sign of a value is kept.
void normalizeSignature(const float* in, std::size_t size, double power, double scale, float* out);
/// The scale with which the mean squared length of the normalized samples is 1.
double normalizationScale(const Samples& samples, double power);

class ExemplarClassifier : public Classifier {
 public:
  ExemplarClassifier(const Samples& samples, int places, const ClassifierParams& params);
  int places() const override { return places_; }
  void predict(const float* signature, double* probabilities) override;
  double novelty() const override { return novelty_; }
  const std::vector<float>* distances() const override { return &distances_; }

 private:
  double typicalDistance(const Samples& samples) const;

  int places_;
  ClassifierParams params_;
  double scale_, typical_distance_ = 1.0, novelty_ = 0.0;
  std::size_t size_;
  std::vector<float> rows_, squares_, query_, distances_;
  std::vector<int> labels_, order_;
};

}  // namespace selovis
