// From a signature to a probability per place.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "selovis/samples.hpp"

namespace selovis {

enum class Kernel { kLinear, kPoly, kRbf, kExemplar };

/// "linear", "poly", "rbf", "exemplar"; throws std::invalid_argument.
Kernel kernelOf(const std::string& name);
const char* nameOf(Kernel kernel);

struct ClassifierParams {
  Kernel kernel = Kernel::kPoly;
  /// Each value v becomes v^power before anything else; 0.5 makes the dot product of histograms
  /// that of Bhattacharyya. 1: as it is. Then all are scaled so that the mean squared length is 1.
  double power = 0.5;
  double cost = 10.0;    ///< C of the SVM
  double gamma = 1.0;    ///< of poly (gamma u.v + 1)^2 and rbf exp(-gamma |u - v|^2)
  double beta = 10.0;    ///< exemplar: how fast the weight falls with (d^2 - d_min^2) / d_min^2
  int neighbours = 100;  ///< exemplar: at most so many are weighed
  unsigned seed = 1;     ///< of libsvm's cross-validation for probabilities
};

/// Throws hyselam::ParameterError.
void validate(const ClassifierParams& params);

class Classifier {
 public:
  virtual ~Classifier() = default;
  virtual int places() const = 0;
  /// Writes places() values, not negative, of sum 1. Not thread safe: buffers are kept.
  virtual void predict(const float* signature, double* probabilities) = 0;
  /// How far the last signature lay from everything learnt: about 1 for signatures like the
  /// training's, growing without bound. 0 where the kind of classifier cannot tell.
  virtual double novelty() const { return 0.0; }
  /// Squared distances of the last signature to all samples; null where the kind has none.
  virtual const std::vector<float>* distances() const { return nullptr; }
};

/// Trains on all samples; `places` classes, of which at least two must occur
/// (std::invalid_argument). For an SVM, `libsvm_file`, if not empty, gets libsvm's own model file,
/// and `state` what restoreClassifier() needs; an exemplar classifier is its samples.
std::unique_ptr<Classifier> trainClassifier(const Samples& samples, int places,
                                            const ClassifierParams& params, std::string* state,
                                            const std::string& libsvm_file = "");

/// From the bytes of trainClassifier(). Throws std::invalid_argument on bytes that do not fit.
std::unique_ptr<Classifier> restoreClassifier(const Samples& samples, int places,
                                              const ClassifierParams& params,
                                              const std::string& state);

struct GridSearch {
  std::vector<double> costs{1.0, 10.0, 100.0};
  std::vector<double> gammas{0.3, 1.0, 3.0, 10.0};
  int folds = 4;  ///< each is a stretch of frames in time order: neighbours in time stay together
                  ///< (of an SVM's samples at most 5000, evenly chosen, are searched)
};

/// The cost and gamma of the highest cross-validated accuracy (the first among equals) put into
/// `params`; returns that accuracy. `progress` is told (done, all). For the exemplar kernel beta is
/// chosen instead.
double searchGrid(const Samples& samples, int places, const GridSearch& grid,
                  ClassifierParams& params,
                  const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace selovis
