#include "ngram_slam/signatures/signature_training.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr auto kFeatures = static_cast<Eigen::Index>(SignatureFeatures::kSize);

Vector vectorOf(const SignatureExample& example) {
  Vector v(kFeatures);
  for (Eigen::Index i = 0; i < kFeatures; ++i) {
    v[i] = static_cast<double>(example.features[static_cast<std::size_t>(i)]);
  }
  return v;
}

/// Variance within places: half the mean square of the differences between visits.
struct Differences {
  Matrix sum = Matrix::Zero(kFeatures, kFeatures);
  std::size_t pairs = 0;
};

Differences differencesOf(const std::vector<SignatureExample>& way, const Matrix& normalized,
                          const SignatureTrainingParams& p) {
  Differences d;
  std::vector<Eigen::Index> older;
  for (std::size_t i = p.separation; i < way.size(); ++i) {
    if (!way[i].truth) continue;
    for (std::size_t j = 0; j + p.separation <= i; ++j) {
      if (!way[j].truth || distance(*way[i].truth, *way[j].truth) >= p.max_distance) continue;
      const Vector v = normalized.col(static_cast<Eigen::Index>(i)) -
                       normalized.col(static_cast<Eigen::Index>(j));
      d.sum.selfadjointView<Eigen::Lower>().rankUpdate(v, 0.5);
      ++d.pairs;
    }
  }
  d.sum = d.sum.selfadjointView<Eigen::Lower>();
  return d;
}

}  // namespace

SignatureModel trainSignatures(const std::vector<std::vector<SignatureExample>>& ways,
                               const SignatureTrainingParams& p, const SignatureOrigin& origin) {
  if (!(p.ridge >= 0.0 && std::isfinite(p.ridge))) {
    throw hyselam::ParameterError("ridge", p.ridge, "at least 0, finite");
  }
  Vector mean = Vector::Zero(kFeatures), square = Vector::Zero(kFeatures);
  double count = 0.0;
  for (const auto& way : ways) {
    for (const SignatureExample& e : way) {
      const Vector v = vectorOf(e);
      mean += v;
      square += v.cwiseAbs2();
      count += 1.0;
    }
  }
  if (count == 0.0) throw hyselam::InputError("training", "", "has no places");
  mean /= count;
  const Vector scale = (square / count - mean.cwiseAbs2()).cwiseMax(1e-12).cwiseSqrt();

  Matrix within = Matrix::Zero(kFeatures, kFeatures), all = within;
  double within_weight = 0.0, all_weight = 0.0;
  for (const auto& way : ways) {
    if (way.size() < 2) continue;
    Matrix normalized(kFeatures, static_cast<Eigen::Index>(way.size()));
    for (std::size_t i = 0; i < way.size(); ++i) {
      normalized.col(static_cast<Eigen::Index>(i)) = (vectorOf(way[i]) - mean).cwiseQuotient(scale);
    }
    const Differences d = differencesOf(way, normalized, p);
    // Long ways count more, but not by all their pairs, which are not independent.
    if (d.pairs > 0) {
      const double weight = std::sqrt(static_cast<double>(std::min(d.pairs, p.max_pairs)));
      within += weight / static_cast<double>(d.pairs) * d.sum;
      within_weight += weight;
    }
    const auto places = static_cast<double>(way.size());
    const double weight = std::min(places, static_cast<double>(p.max_places));
    const Vector own_mean = normalized.rowwise().mean();
    normalized.colwise() -= own_mean;
    all += weight / (places - 1.0) * (normalized * normalized.transpose());
    all_weight += weight;
  }
  if (within_weight == 0.0) {
    throw hyselam::InputError("training", "", "has no place that was visited twice");
  }
  within /= within_weight;
  all /= all_weight;
  const Vector diagonal = within.diagonal();
  within += p.ridge * Matrix(diagonal.asDiagonal());
  within += 1e-4 * Matrix::Identity(kFeatures, kFeatures);

  // What varies most among all places while it varies by 1 between visits.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(all, within);
  if (solver.info() != Eigen::Success) {
    throw hyselam::InputError("training", "", "the features of its places vary too little");
  }
  std::vector<SignatureModel::Row> rows;
  std::vector<float> offsets, variances;
  for (std::size_t i = 0; i < PlaceSignature::kSize; ++i) {
    const Eigen::Index k = kFeatures - 1 - static_cast<Eigen::Index>(i);
    Vector axis = solver.eigenvectors().col(k);
    // The sign of an axis is free.
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis[largest] < 0.0) axis = -axis;
    axis = axis.cwiseQuotient(scale).eval();
    SignatureModel::Row row{};
    for (Eigen::Index f = 0; f < kFeatures; ++f) {
      row[static_cast<std::size_t>(f)] = static_cast<float>(axis[f]);
    }
    rows.push_back(row);
    offsets.push_back(static_cast<float>(-axis.dot(mean)));
    variances.push_back(static_cast<float>(std::max(1.01, solver.eigenvalues()[k])));
  }
  return {std::move(rows), std::move(offsets), std::move(variances), p.sensor, origin};
}

}  // namespace ngram_slam
