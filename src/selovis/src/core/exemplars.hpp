// Soft nearest neighbours over all training signatures.
#pragma once

#include <vector>

#include "selovis/classifier.hpp"

namespace selovis {

/// Scale that makes the mean squared length of the transformed samples 1.
double learnScale(const Samples& samples, double power);
/// v^power * scale of one signature; the sign of a value is kept.
void transform(const float* in, std::size_t size, double power, double scale, float* out);

class Exemplars : public Classifier {
 public:
  Exemplars(const Samples& samples, int places, const ClassifierParams& params);
  int places() const override { return places_; }
  void predict(const float* signature, double* probabilities) override;
  double novelty() const override { return novelty_; }
  const std::vector<float>* distances() const override { return &distances_; }

 private:
  double typicalDistance(const Samples& samples) const;

  int places_;
  ClassifierParams params_;
  double scale_, typical_ = 1.0, novelty_ = 0.0;
  std::size_t size_;
  std::vector<float> rows_, squares_, query_, distances_;
  std::vector<int> labels_, order_;
};

}  // namespace selovis
