// A support vector machine that libsvm trained, as dense matrices; predicts without libsvm.
#pragma once

#include <string>
#include <vector>

#include "selovis/classifiers/classifier.hpp"

struct svm_model;

namespace selovis {

/// Probabilities equal those of libsvm's svm_predict_probability up to rounding. A linear machine
/// is one weight vector per pair of classes; the others compute the kernel of the signature with
/// each support vector once.
class SvmClassifier : public Classifier {
 public:
  /// Copies a model that was trained with probabilities on signatures normalized with `scale`.
  SvmClassifier(const svm_model& model, std::size_t size, int places,
                const ClassifierParams& params, double scale);
  /// From bytes(). @throws hyselam::InputError.
  SvmClassifier(const std::string& bytes, std::size_t size, int places,
                const ClassifierParams& params);

  std::string bytes() const;
  int places() const override { return places_; }
  void predict(const float* signature, double* probabilities) override;

 private:
  void prepare();

  int places_;
  ClassifierParams params_;
  std::size_t size_;
  double scale_ = 1.0;
  std::vector<int> labels_, counts_;  // of the classes that occur, and their support vectors
  std::vector<float> vectors_;        // support vectors by class
  std::vector<double> coefficients_;  // (classes - 1) x vectors
  std::vector<double> rho_, prob_a_, prob_b_;  // per pair of classes
  std::vector<float> weights_, squares_, query_;
  std::vector<double> kernel_, pair_, estimate_, matrix_, step_;
};

}  // namespace selovis
