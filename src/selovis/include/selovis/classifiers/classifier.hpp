// Classifiers: from the signature of one image to a probability per place (dos Santos 2014, 6.4).
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "selovis/classifiers/samples.hpp"

namespace selovis {

/// The kernel of a support vector machine, or kExemplar: soft nearest neighbors among all training
/// signatures, without an SVM; or kFusion: the same for each part of the signatures, the parts'
/// answers joined by calibrated weights.
enum class SvmKernel { kLinear, kPoly, kRbf, kExemplar, kFusion };

/// Whether the kind compares with the training signatures themselves: it has distances, and learns
/// from several views of each image.
inline bool comparesExemplars(SvmKernel kernel) {
  return kernel == SvmKernel::kExemplar || kernel == SvmKernel::kFusion;
}

/// "linear", "poly", "rbf", "exemplar", "fusion".
const char* toString(SvmKernel kernel);
/// @throws hyselam::InputError for any other text.
SvmKernel svmKernelFromString(const std::string& name);
/// Each with its word, as parameters take them.
const std::vector<std::pair<std::string, SvmKernel>>& svmKernelWords();

struct ClassifierParams {
  SvmKernel kernel = SvmKernel::kFusion;
  /// Each value v of a signature becomes v^power; 0.5 turns the dot product of histograms into the
  /// Bhattacharyya coefficient, 1 leaves them as they are. Then all signatures are scaled so that
  /// their mean squared length is 1. 0.05 to 4.
  double power = 0.5;
  double cost = 10.0;   ///< C of the SVM, 1e-6 to 1e9
  double gamma = 1.0;   ///< of poly (gamma u.v + 1)^2 and rbf exp(-gamma |u - v|^2), 1e-9 to 1e9
  double beta = 10.0;   ///< exemplar: weight exp(-beta (d^2 - d_min^2) / d_min^2), 0 to 1e6
  int neighbors = 100;  ///< exemplar: the nearest so many are weighted, 1 to 100000
  unsigned seed = 1;    ///< of libsvm's cross-validation for probabilities

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

/// What one part of the last signature said.
struct PartOpinion {
  std::string part;
  int place = -1;            ///< the most likely one by this part alone
  double probability = 0.0;  ///< of it, by this part alone
  double weight = 0.0;       ///< its share in the answer, 0 to 1; all shares add up to 1
  /// Its nearest distance lies outside of the range that training saw: it was not asked.
  bool out_of_range = false;
  bool absolute_color = false;  ///< SignaturePart::absolute_color
};

class Classifier {
 public:
  virtual ~Classifier() = default;
  /// Number of classes.
  virtual int places() const = 0;
  /// Writes places() probabilities of sum 1. Not thread safe: buffers are kept.
  virtual void predict(const float* signature, double* probabilities) = 0;
  /// Distance of the last signature to the nearest training signature, in units of the typical
  /// distance between training signatures: about 1 for familiar images. 0 where the kind of
  /// classifier does not measure it.
  virtual double novelty() const { return 0.0; }
  /// Squared distances of the last signature to all samples, in any unit; null where the kind has
  /// none.
  virtual const std::vector<float>* distances() const { return nullptr; }
  /// Of the last signature, in the order of its parts; null where the kind does not tell them
  /// apart.
  virtual const std::vector<PartOpinion>* opinions() const { return nullptr; }
};

struct TrainedClassifier {
  std::unique_ptr<Classifier> classifier;
  /// Serialized state, input of restoreClassifier(); empty for an exemplar classifier, whose only
  /// state are its samples; JSON for a fusion.
  std::string state;
};

/// Trains on all samples. For an SVM, `libsvm_file`, if not empty, is written in libsvm's own
/// format.
/// @throws hyselam::InputError for samples of fewer than two of the `places` classes, or a file
///   that cannot be written; hyselam::ParameterError.
TrainedClassifier trainClassifier(const Samples& samples, int places,
                                  const ClassifierParams& params,
                                  const std::string& libsvm_file = "");

/// @throws hyselam::InputError for bytes that do not fit; hyselam::ParameterError.
std::unique_ptr<Classifier> restoreClassifier(const Samples& samples, int places,
                                              const ClassifierParams& params,
                                              const std::string& state);

}  // namespace selovis
