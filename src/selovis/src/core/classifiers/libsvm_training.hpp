// Training of support vector machines with libsvm.
#pragma once

#include <libsvm/svm.h>

#include <memory>
#include <string>
#include <vector>

#include "selovis/classifiers/classifier.hpp"

namespace selovis {

/// @throws hyselam::InputError unless the samples belong to two or more of the classes 0 ..
///   places - 1.
void requireTwoClasses(const Samples& samples, int places);

struct FreeSvmModel {
  void operator()(svm_model* model) const { svm_free_and_destroy_model(&model); }
};
using SvmModelPtr = std::unique_ptr<svm_model, FreeSvmModel>;

/// The samples as libsvm's sparse rows, normalized (normalizeSignature).
struct SvmProblem {
  SvmProblem(const Samples& samples, double power, double scale);
  std::vector<svm_node> nodes;
  std::vector<svm_node*> rows;
  std::vector<double> labels;
  svm_problem problem{};
};

svm_parameter svmParameter(const ClassifierParams& params, bool probability);

/// Trains a machine with class probabilities. The model keeps pointers into `problem`.
/// @throws hyselam::InputError for what libsvm refuses.
SvmModelPtr trainSvm(const SvmProblem& problem, const ClassifierParams& params);

}  // namespace selovis
