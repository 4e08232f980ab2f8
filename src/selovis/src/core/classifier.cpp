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

/// How many of the samples of each fold are told rightly by what the other folds teach.
double validateExemplars(const Samples& samples, int places, const ClassifierParams& params,
                         const std::vector<int>& fold, int folds) {
  std::size_t right = 0;
  std::vector<double> p(static_cast<std::size_t>(places));
  for (int f = 0; f < folds; ++f) {
    Samples part;
    part.size = samples.size;
    for (std::size_t i = 0; i < samples.count(); ++i) {
      if (fold[i] != f) part.add(samples.row(i), samples.places[i], samples.frames[i]);
    }
    if (part.count() == 0 || part.count() == samples.count()) continue;
    Exemplars exemplars(part, places, params);
    for (std::size_t i = 0; i < samples.count(); ++i) {
      if (fold[i] != f) continue;
      exemplars.predict(samples.row(i), p.data());
      right += std::max_element(p.begin(), p.end()) - p.begin() == samples.places[i];
    }
  }
  return static_cast<double>(right) / static_cast<double>(samples.count());
}

/// The kernel between all pairs of samples: the products are the same for every cost and gamma, so
/// a grid search makes them once and not in each of its trainings.
class KernelTable {
 public:
  KernelTable(const Samples& samples, double power)
      : labels_(samples.places.begin(), samples.places.end()),
        products_(samples.count() * samples.count()),
        nodes_(samples.count() * (samples.count() + 1)) {
    const std::size_t n = samples.count();
    const double scale = learnScale(samples, power);
    std::vector<float> rows(samples.values.size());
    for (std::size_t i = 0; i < n; ++i) {
      transform(samples.row(i), samples.size, power, scale, rows.data() + i * samples.size);
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        products_[i * n + j] = products_[j * n + i] =
            dot(rows.data() + i * samples.size, rows.data() + j * samples.size, samples.size);
      }
    }
  }

  void fill(const ClassifierParams& params) {
    const std::size_t n = labels_.size();
    for (std::size_t i = 0; i < n; ++i) {
      svm_node* row = nodes_.data() + i * (n + 1);
      row[0] = {0, static_cast<double>(i + 1)};
      for (std::size_t j = 0; j < n; ++j) {
        const double product = products_[i * n + j];
        double value = product;
        if (params.kernel == Kernel::kPoly) {
          value = (params.gamma * product + 1.0) * (params.gamma * product + 1.0);
        } else if (params.kernel == Kernel::kRbf) {
          value = std::exp(-params.gamma *
                           (products_[i * n + i] + products_[j * n + j] - 2.0 * product));
        }
        row[j + 1] = {static_cast<int>(j + 1), value};
      }
    }
  }

  double validate(const ClassifierParams& params, const std::vector<int>& fold, int folds) {
    const std::size_t n = labels_.size();
    svm_parameter parameter = libsvmParameter(params, false);
    parameter.kernel_type = PRECOMPUTED;
    std::size_t right = 0;
    for (int f = 0; f < folds; ++f) {
      std::vector<svm_node*> rows;
      std::vector<double> labels;
      for (std::size_t i = 0; i < n; ++i) {
        if (fold[i] == f) continue;
        rows.push_back(nodes_.data() + i * (n + 1));
        labels.push_back(labels_[i]);
      }
      if (rows.empty() || rows.size() == n) continue;
      svm_problem problem{};
      problem.l = static_cast<int>(rows.size());
      problem.y = labels.data();
      problem.x = rows.data();
      svm_set_print_string_function(silent);
      const ModelPtr model(svm_train(&problem, &parameter));
      for (std::size_t i = 0; i < n; ++i) {
        if (fold[i] != f) continue;
        right += svm_predict(model.get(), nodes_.data() + i * (n + 1)) == labels_[i];
      }
    }
    return static_cast<double>(right) / static_cast<double>(n);
  }

 private:
  std::vector<double> labels_;
  std::vector<float> products_;
  std::vector<svm_node> nodes_;  // a row per sample: its number, then the kernel with each
};

/// Every so manieth sample, so that a table of kernels stays within 400 MB.
constexpr std::size_t kMaxTable = 5000;

Samples thinned(const Samples& samples) {
  const std::size_t step = (samples.count() + kMaxTable - 1) / kMaxTable;
  if (step <= 1) return samples;
  Samples part;
  part.size = samples.size;
  for (std::size_t i = 0; i < samples.count(); i += step) {
    part.add(samples.row(i), samples.places[i], samples.frames[i]);
  }
  return part;
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
  const bool exemplar = params.kernel == Kernel::kExemplar;
  const Samples searched = exemplar ? samples : thinned(samples);
  const std::vector<int> fold = foldsOf(searched, grid.folds);
  std::vector<ClassifierParams> candidates;
  if (exemplar) {
    for (const double beta : {3.0, 10.0, 30.0}) {
      candidates.push_back(params);
      candidates.back().beta = beta;
    }
  } else {
    for (const double gamma :
         params.kernel == Kernel::kLinear ? std::vector<double>{params.gamma} : grid.gammas) {
      for (const double cost : grid.costs) {
        candidates.push_back(params);
        candidates.back().cost = cost;
        candidates.back().gamma = gamma;
      }
    }
  }
  std::unique_ptr<KernelTable> table;
  if (!exemplar) table = std::make_unique<KernelTable>(searched, params.power);
  double best = -1.0, gamma = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (progress) progress(i, candidates.size());
    double accuracy = 0.0;
    if (exemplar) {
      accuracy = validateExemplars(searched, places, candidates[i], fold, grid.folds);
    } else {
      if (candidates[i].gamma != gamma) table->fill(candidates[i]);
      gamma = candidates[i].gamma;
      accuracy = table->validate(candidates[i], fold, grid.folds);
    }
    if (accuracy > best) {
      best = accuracy;
      params = candidates[i];
    }
  }
  if (progress) progress(candidates.size(), candidates.size());
  return best;
}

}  // namespace selovis
