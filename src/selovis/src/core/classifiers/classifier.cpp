#include "selovis/classifiers/classifier.hpp"

#include "exemplar_classifier.hpp"
#include "fusion_classifier.hpp"
#include "hyselam_common/errors.hpp"
#include "libsvm_training.hpp"
#include "svm_classifier.hpp"

namespace selovis {

const char* toString(SvmKernel kernel) {
  switch (kernel) {
    case SvmKernel::kLinear:
      return "linear";
    case SvmKernel::kPoly:
      return "poly";
    case SvmKernel::kRbf:
      return "rbf";
    case SvmKernel::kExemplar:
      return "exemplar";
    case SvmKernel::kFusion:
      break;
  }
  return "fusion";
}

SvmKernel svmKernelFromString(const std::string& name) {
  for (const auto& [word, kernel] : svmKernelWords()) {
    if (name == word) return kernel;
  }
  throw hyselam::InputError("kernel '" + name + "'", "",
                            "is not known: there are linear, poly, rbf, exemplar, fusion");
}

const std::vector<std::pair<std::string, SvmKernel>>& svmKernelWords() {
  static const std::vector<std::pair<std::string, SvmKernel>> words{
      {"linear", SvmKernel::kLinear},
      {"poly", SvmKernel::kPoly},
      {"rbf", SvmKernel::kRbf},
      {"exemplar", SvmKernel::kExemplar},
      {"fusion", SvmKernel::kFusion}};
  return words;
}

void ClassifierParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("kernel", kernel, svmKernelWords(),
        "of the SVM; exemplar: nearest neighbors; fusion: those of each part of the descriptor");
  visit("power", power, Range::between(0.05, 4.0), "",
        "that each value of a signature is raised to");
  visit("cost", cost, Range::between(1e-6, 1e9), "", "C of the SVM");
  visit("gamma", gamma, Range::between(1e-9, 1e9), "", "of poly and rbf");
  visit("beta", beta, Range::between(0.0, 1e6), "",
        "exemplar: exp(-beta (d^2 - d_min^2) / d_min^2)");
  visit("neighbors", neighbors, Range::between(1, 100000), "", "exemplar: nearest ones weighted");
}

void ClassifierParams::validate() const {
  hyselam::checkParameters(*this);
}

TrainedClassifier trainClassifier(const Samples& samples, int places,
                                  const ClassifierParams& params, const std::string& libsvm_file) {
  params.validate();
  requireTwoClasses(samples, places);
  if (!libsvm_file.empty() && comparesExemplars(params.kernel)) {
    throw hyselam::InputError(
        libsvm_file, "", "only support vector machines have a file of libsvm: linear, poly or rbf");
  }
  if (params.kernel == SvmKernel::kExemplar) {
    return {std::make_unique<ExemplarClassifier>(samples, places, params), ""};
  }
  if (params.kernel == SvmKernel::kFusion) {
    auto fusion = std::make_unique<FusionClassifier>(samples, places, params);
    std::string state = fusion->state();
    return {std::move(fusion), std::move(state)};
  }
  const double scale = normalizationScale(samples, params.power);
  const SvmProblem problem(samples, params.power, scale);
  const SvmModelPtr model = trainSvm(problem, params);
  if (!libsvm_file.empty() && svm_save_model(libsvm_file.c_str(), model.get()) != 0) {
    throw hyselam::InputError(libsvm_file, "", "cannot be written");
  }
  auto machine = std::make_unique<SvmClassifier>(*model, samples.size, places, params, scale);
  std::string state = machine->bytes();
  return {std::move(machine), std::move(state)};
}

std::unique_ptr<Classifier> restoreClassifier(const Samples& samples, int places,
                                              const ClassifierParams& params,
                                              const std::string& state) {
  params.validate();
  requireTwoClasses(samples, places);
  if (params.kernel == SvmKernel::kExemplar) {
    return std::make_unique<ExemplarClassifier>(samples, places, params);
  }
  if (params.kernel == SvmKernel::kFusion) {
    return std::make_unique<FusionClassifier>(samples, places, params, state);
  }
  return std::make_unique<SvmClassifier>(state, samples.size, places, params);
}

}  // namespace selovis
