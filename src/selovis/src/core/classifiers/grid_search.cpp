#include "selovis/classifiers/grid_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "exemplar_classifier.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/require.hpp"
#include "libsvm_training.hpp"

namespace selovis {
namespace {

/// A fold has at least so many stretches of consecutive frames, where there are enough frames.
constexpr int kStretchesPerFold = 8;

/// Fold of each sample: stretches of consecutive frames, dealt out in turn.
std::vector<int> foldsOf(const Samples& samples, int folds) {
  const int frames = samples.frames.empty() ? 0 : samples.frames.back() + 1;
  const int stretch = std::max(1, frames / (folds * kStretchesPerFold));
  std::vector<int> fold;
  for (const int f : samples.frames) fold.push_back(f / stretch % folds);
  return fold;
}

/// Share of the samples of each fold that are classified correctly by what the others teach.
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
    ExemplarClassifier exemplars(part, places, params);
    for (std::size_t i = 0; i < samples.count(); ++i) {
      if (fold[i] != f) continue;
      exemplars.predict(samples.row(i), p.data());
      right += std::max_element(p.begin(), p.end()) - p.begin() == samples.places[i];
    }
  }
  return static_cast<double>(right) / static_cast<double>(samples.count());
}

/// The kernel between all pairs of samples. Their dot products are the same for every cost and
/// gamma: a grid search computes them once, not in each of its trainings.
class KernelTable {
 public:
  KernelTable(const Samples& samples, double power)
      : labels_(samples.places.begin(), samples.places.end()),
        products_(samples.count() * samples.count()),
        nodes_(samples.count() * (samples.count() + 1)) {
    const std::size_t n = samples.count();
    const double scale = normalizationScale(samples, power);
    std::vector<float> rows(samples.values.size());
    for (std::size_t i = 0; i < n; ++i) {
      normalizeSignature(samples.row(i), samples.size, power, scale,
                         rows.data() + i * samples.size);
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        products_[i * n + j] = products_[j * n + i] =
            dot(rows.data() + i * samples.size, rows.data() + j * samples.size, samples.size);
      }
    }
  }

  /// Computes the kernel values from the dot products, as libsvm's PRECOMPUTED rows.
  void fill(const ClassifierParams& params) {
    const std::size_t n = labels_.size();
    for (std::size_t i = 0; i < n; ++i) {
      svm_node* row = nodes_.data() + i * (n + 1);
      row[0] = {0, static_cast<double>(i + 1)};
      for (std::size_t j = 0; j < n; ++j) {
        const double product = products_[i * n + j];
        double value = product;
        if (params.kernel == SvmKernel::kPoly) {
          value = (params.gamma * product + 1.0) * (params.gamma * product + 1.0);
        } else if (params.kernel == SvmKernel::kRbf) {
          value = std::exp(-params.gamma *
                           (products_[i * n + i] + products_[j * n + j] - 2.0 * product));
        }
        row[j + 1] = {static_cast<int>(j + 1), value};
      }
    }
  }

  /// Cross-validated accuracy with the values of the last fill().
  double validate(const ClassifierParams& params, const std::vector<int>& fold, int folds) {
    const std::size_t n = labels_.size();
    svm_parameter parameter = svmParameter(params, false);
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
      const SvmModelPtr model(svm_train(&problem, &parameter));
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

/// At most `max` samples, evenly chosen.
Samples subsampled(const Samples& samples, std::size_t max) {
  const std::size_t step = (samples.count() + max - 1) / max;
  if (step <= 1) return samples;
  Samples part;
  part.size = samples.size;
  for (std::size_t i = 0; i < samples.count(); i += step) {
    part.add(samples.row(i), samples.places[i], samples.frames[i]);
  }
  return part;
}

std::vector<ClassifierParams> candidatesOf(const GridSearchParams& grid,
                                           const ClassifierParams& params) {
  std::vector<ClassifierParams> candidates;
  if (params.kernel == SvmKernel::kExemplar) {
    for (const double beta : grid.betas) {
      candidates.push_back(params);
      candidates.back().beta = beta;
    }
    return candidates;
  }
  const bool has_gamma = params.kernel != SvmKernel::kLinear;
  for (const double gamma : has_gamma ? grid.gammas : std::vector<double>{params.gamma}) {
    for (const double cost : grid.costs) {
      candidates.push_back(params);
      candidates.back().cost = cost;
      candidates.back().gamma = gamma;
    }
  }
  return candidates;
}

}  // namespace

GridSearchResult searchGrid(const Samples& samples, int places, const GridSearchParams& grid,
                            const ClassifierParams& params,
                            const std::function<void(std::size_t, std::size_t)>& progress) {
  requireTwoClasses(samples, places);
  hyselam::require("folds", grid.folds, grid.folds >= 2, "2 or more");
  if (params.kernel == SvmKernel::kFusion) return {params, -1.0};  // it calibrates itself
  const bool exemplar = params.kernel == SvmKernel::kExemplar;
  const Samples searched = exemplar ? samples : subsampled(samples, grid.max_samples);
  const std::vector<int> fold = foldsOf(searched, grid.folds);
  std::unique_ptr<KernelTable> table;
  if (!exemplar) table = std::make_unique<KernelTable>(searched, params.power);
  GridSearchResult best{params, -1.0};
  double gamma = 0.0;  // of the table's values
  const std::vector<ClassifierParams> candidates = candidatesOf(grid, params);
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
    if (accuracy > best.accuracy) best = {candidates[i], accuracy};
  }
  if (progress) progress(candidates.size(), candidates.size());
  return best;
}

}  // namespace selovis
