#include "selovis/classifier.hpp"

#include <libsvm/svm.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "exemplars.hpp"
#include "hyselam_common/errors.hpp"
#include "svm_machine.hpp"

namespace selovis {
namespace {

void silent(const char*) {}

/// Samples as libsvm wants them; zeros are left out.
struct Problem {
  Problem(const Samples& samples, const std::vector<std::size_t>& rows, double power,
          double scale) {
    std::vector<float> row(samples.size);
    std::vector<std::size_t> begin;
    for (const std::size_t i : rows) {
      begin.push_back(nodes.size());
      labels.push_back(samples.places[i]);
      transform(samples.row(i), samples.size, power, scale, row.data());
      for (std::size_t k = 0; k < samples.size; ++k) {
        if (row[k] != 0.0f) nodes.push_back({static_cast<int>(k) + 1, row[k]});
      }
      nodes.push_back({-1, 0.0});
    }
    for (const std::size_t b : begin) starts.push_back(nodes.data() + b);
    problem.l = static_cast<int>(rows.size());
    problem.y = labels.data();
    problem.x = starts.data();
  }
  std::vector<svm_node> nodes;
  std::vector<svm_node*> starts;
  std::vector<double> labels;
  svm_problem problem{};
};

svm_parameter libsvmParameter(const ClassifierParams& p, bool probability) {
  svm_parameter out{};
  out.svm_type = C_SVC;
  out.kernel_type = p.kernel == Kernel::kLinear ? LINEAR : p.kernel == Kernel::kPoly ? POLY : RBF;
  out.degree = 2;
  out.gamma = p.gamma;
  out.coef0 = 1.0;
  out.cache_size = 200;
  out.eps = 1e-3;
  out.C = p.cost;
  out.shrinking = 1;
  out.probability = probability ? 1 : 0;
  return out;
}

struct FreeModel {
  void operator()(svm_model* m) const { svm_free_and_destroy_model(&m); }
};
using ModelPtr = std::unique_ptr<svm_model, FreeModel>;

ModelPtr trainLibsvm(const Problem& problem, const ClassifierParams& params, bool probability) {
  const svm_parameter parameter = libsvmParameter(params, probability);
  if (const char* error = svm_check_parameter(&problem.problem, &parameter)) {
    throw std::invalid_argument(std::string("libsvm: ") + error);
  }
  svm_set_print_string_function(silent);
  std::srand(params.seed);  // libsvm shuffles with rand()
  return ModelPtr(svm_train(&problem.problem, &parameter));
}

void requireClasses(const Samples& samples, int places) {
  if (samples.count() == 0) throw std::invalid_argument("there is nothing to learn from");
  for (const int place : samples.places) {
    if (place < 0 || place >= places) throw std::invalid_argument("a sample's class is no place");
  }
  if (std::all_of(samples.places.begin(), samples.places.end(),
                  [&](int p) { return p == samples.places.front(); })) {
    throw std::invalid_argument("a classifier needs at least two places");
  }
}

/// Fold of each sample: stretches of consecutive frames, dealt out in turn.
std::vector<int> foldsOf(const Samples& samples, int folds) {
  const int frames = samples.frames.empty() ? 0 : samples.frames.back() + 1;
  const int stretch = std::max(1, frames / (folds * 8));
  std::vector<int> fold;
  for (const int f : samples.frames) fold.push_back(f / stretch % folds);
  return fold;
}

double validateOnce(const Samples& samples, int places, const ClassifierParams& params,
                    const std::vector<int>& fold, int folds) {
  std::size_t right = 0, all = 0;
  for (int f = 0; f < folds; ++f) {
    std::vector<std::size_t> train, test;
    for (std::size_t i = 0; i < samples.count(); ++i) (fold[i] == f ? test : train).push_back(i);
    if (train.empty() || test.empty()) continue;
    if (params.kernel == Kernel::kExemplar) {
      Samples part;
      part.size = samples.size;
      for (const std::size_t i : train)
        part.add(samples.row(i), samples.places[i], samples.frames[i]);
      Exemplars exemplars(part, places, params);
      std::vector<double> p(static_cast<std::size_t>(places));
      for (const std::size_t i : test) {
        exemplars.predict(samples.row(i), p.data());
        right += std::max_element(p.begin(), p.end()) - p.begin() == samples.places[i];
      }
    } else {
      const double scale = learnScale(samples, params.power);
      const Problem problem(samples, train, params.power, scale);
      const Problem held(samples, test, params.power, scale);
      const ModelPtr model = trainLibsvm(problem, params, false);
      for (std::size_t i = 0; i < test.size(); ++i) {
        right += svm_predict(model.get(), held.starts[i]) == held.labels[i];
      }
    }
    all += test.size();
  }
  return all > 0 ? static_cast<double>(right) / static_cast<double>(all) : 0.0;
}

}  // namespace

Kernel kernelOf(const std::string& name) {
  for (const Kernel k : {Kernel::kLinear, Kernel::kPoly, Kernel::kRbf, Kernel::kExemplar}) {
    if (name == nameOf(k)) return k;
  }
  throw std::invalid_argument("no kernel is called '" + name +
                              "': there are linear, poly, rbf, exemplar");
}

const char* nameOf(Kernel kernel) {
  switch (kernel) {
    case Kernel::kLinear:
      return "linear";
    case Kernel::kPoly:
      return "poly";
    case Kernel::kRbf:
      return "rbf";
    case Kernel::kExemplar:
      break;
  }
  return "exemplar";
}

void validate(const ClassifierParams& p) {
  const auto check = [](const char* name, double value, double low, double high,
                        const char* range) {
    if (!(value >= low && value <= high)) throw hyselam::ParameterError(name, value, range);
  };
  check("power", p.power, 0.05, 4.0, "0.05 to 4");
  check("cost", p.cost, 1e-6, 1e9, "1e-6 to 1e9");
  check("gamma", p.gamma, 1e-9, 1e9, "1e-9 to 1e9");
  check("beta", p.beta, 0.0, 1e6, "0 to 1e6");
  check("neighbours", p.neighbours, 1, 100000, "1 to 100000");
}

std::unique_ptr<Classifier> trainClassifier(const Samples& samples, int places,
                                            const ClassifierParams& params, std::string* state,
                                            const std::string& libsvm_file) {
  validate(params);
  requireClasses(samples, places);
  if (params.kernel == Kernel::kExemplar) {
    return std::make_unique<Exemplars>(samples, places, params);
  }
  const double scale = learnScale(samples, params.power);
  std::vector<std::size_t> rows(samples.count());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  const Problem problem(samples, rows, params.power, scale);
  const ModelPtr model = trainLibsvm(problem, params, true);
  if (!libsvm_file.empty() && svm_save_model(libsvm_file.c_str(), model.get()) != 0) {
    throw hyselam::InputError(libsvm_file, "", "cannot be written");
  }
  auto machine = std::make_unique<SvmMachine>(*model, samples.size, places, params, scale);
  if (state != nullptr) *state = machine->bytes();
  return machine;
}

std::unique_ptr<Classifier> restoreClassifier(const Samples& samples, int places,
                                              const ClassifierParams& params,
                                              const std::string& state) {
  validate(params);
  requireClasses(samples, places);
  if (params.kernel == Kernel::kExemplar) {
    return std::make_unique<Exemplars>(samples, places, params);
  }
  return std::make_unique<SvmMachine>(state, samples.size, places, params);
}

double searchGrid(const Samples& samples, int places, const GridSearch& grid,
                  ClassifierParams& params,
                  const std::function<void(std::size_t, std::size_t)>& progress) {
  requireClasses(samples, places);
  if (grid.folds < 2) throw hyselam::ParameterError("folds", grid.folds, "2 or more");
  const std::vector<int> fold = foldsOf(samples, grid.folds);
  std::vector<ClassifierParams> candidates;
  if (params.kernel == Kernel::kExemplar) {
    for (const double beta : {3.0, 10.0, 30.0}) {
      candidates.push_back(params);
      candidates.back().beta = beta;
    }
  } else {
    for (const double cost : grid.costs) {
      for (const double gamma :
           params.kernel == Kernel::kLinear ? std::vector<double>{params.gamma} : grid.gammas) {
        candidates.push_back(params);
        candidates.back().cost = cost;
        candidates.back().gamma = gamma;
      }
    }
  }
  double best = -1.0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (progress) progress(i, candidates.size());
    const double accuracy = validateOnce(samples, places, candidates[i], fold, grid.folds);
    if (accuracy > best) {
      best = accuracy;
      params = candidates[i];
    }
  }
  if (progress) progress(candidates.size(), candidates.size());
  return best;
}

}  // namespace selovis
