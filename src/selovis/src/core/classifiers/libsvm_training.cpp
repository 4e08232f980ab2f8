#include "libsvm_training.hpp"

#include <algorithm>
#include <cstdlib>

#include "exemplar_classifier.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {

void requireTwoClasses(const Samples& samples, int places) {
  if (samples.count() == 0) {
    throw hyselam::InputError("training samples", "", "there is nothing to learn from");
  }
  for (const int place : samples.places) {
    if (place < 0 || place >= places) {
      throw hyselam::InputError("training samples", "", "a sample's class is no place");
    }
  }
  if (std::all_of(samples.places.begin(), samples.places.end(),
                  [&](int p) { return p == samples.places.front(); })) {
    throw hyselam::InputError("training samples", "", "a classifier needs at least two places");
  }
}

SvmProblem::SvmProblem(const Samples& samples, double power, double scale) {
  std::vector<float> row(samples.size);
  std::vector<std::size_t> begin;
  for (std::size_t i = 0; i < samples.count(); ++i) {
    begin.push_back(nodes.size());
    labels.push_back(samples.places[i]);
    normalizeSignature(samples.row(i), samples.size, power, scale, row.data());
    // libsvm counts from 1, leaves zeros out, and ends a row with the index -1.
    for (std::size_t k = 0; k < samples.size; ++k) {
      if (row[k] != 0.0f) nodes.push_back({static_cast<int>(k) + 1, row[k]});
    }
    nodes.push_back({-1, 0.0});
  }
  for (const std::size_t b : begin) rows.push_back(nodes.data() + b);
  problem.l = static_cast<int>(rows.size());
  problem.y = labels.data();
  problem.x = rows.data();
}

svm_parameter svmParameter(const ClassifierParams& params, bool probability) {
  svm_parameter out{};
  out.svm_type = C_SVC;
  out.kernel_type = params.kernel == SvmKernel::kLinear ? LINEAR
                    : params.kernel == SvmKernel::kPoly ? POLY
                                                        : RBF;
  out.degree = 2;
  out.gamma = params.gamma;
  out.coef0 = 1.0;
  out.cache_size = 200;  // [MB]
  out.eps = 1e-3;
  out.C = params.cost;
  out.shrinking = 1;
  out.probability = probability ? 1 : 0;
  svm_set_print_string_function([](const char*) {});
  return out;
}

SvmModelPtr trainSvm(const SvmProblem& problem, const ClassifierParams& params) {
  const svm_parameter parameter = svmParameter(params, true);
  if (const char* error = svm_check_parameter(&problem.problem, &parameter)) {
    throw hyselam::InputError("libsvm", "", error);
  }
  std::srand(params.seed);  // libsvm shuffles with rand()
  return SvmModelPtr(svm_train(&problem.problem, &parameter));
}

}  // namespace selovis
