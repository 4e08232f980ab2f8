#include "svm_classifier.hpp"

#include <libsvm/svm.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "exemplar_classifier.hpp"
#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr const char* kSource = "support vector machine";  // in messages

[[noreturn]] void refuse(const std::string& reason) {
  throw hyselam::InputError(kSource, "", reason);
}

}  // namespace
SvmClassifier::SvmClassifier(const svm_model& m, std::size_t size, int places,
                             const ClassifierParams& params, double scale)
    : places_(places), params_(params), size_(size), scale_(scale) {
  const std::size_t classes = static_cast<std::size_t>(m.nr_class),
                    vectors = static_cast<std::size_t>(m.l), pairs = classes * (classes - 1) / 2;
  labels_.assign(m.label, m.label + classes);
  counts_.assign(m.nSV, m.nSV + classes);
  vectors_.assign(vectors * size, 0.0f);
  for (std::size_t i = 0; i < vectors; ++i) {
    for (const svm_node* node = m.SV[i]; node->index != -1; ++node) {
      vectors_[i * size + static_cast<std::size_t>(node->index - 1)] =
          static_cast<float>(node->value);
    }
  }
  for (std::size_t c = 0; c + 1 < classes; ++c) {
    coefficients_.insert(coefficients_.end(), m.sv_coef[c], m.sv_coef[c] + vectors);
  }
  rho_.assign(m.rho, m.rho + pairs);
  prob_a_.assign(m.probA, m.probA + pairs);
  prob_b_.assign(m.probB, m.probB + pairs);
  prepare();
}

SvmClassifier::SvmClassifier(const std::string& bytes, std::size_t size, int places,
                             const ClassifierParams& params)
    : places_(places), params_(params), size_(size) {
  hyselam::BinaryReader in(bytes, kSource);
  scale_ = in.get<double>();
  labels_ = in.getSized<int>();
  counts_ = in.getSized<int>();
  vectors_ = in.getSized<float>();
  coefficients_ = in.getSized<double>();
  rho_ = in.getSized<double>();
  prob_a_ = in.getSized<double>();
  prob_b_ = in.getSized<double>();
  in.requireEnd();
  const std::size_t classes = labels_.size(), pairs = classes * (classes - 1) / 2;
  std::size_t vectors = 0;
  for (const int n : counts_) {
    if (n < 0) refuse("has a negative number of support vectors");
    vectors += static_cast<std::size_t>(n);
  }
  std::vector<char> seen(static_cast<std::size_t>(places), 0);
  for (const int label : labels_) {
    if (label < 0 || label >= places || seen[static_cast<std::size_t>(label)]++) {
      refuse("has a class that is no place");
    }
  }
  const auto finite = [](const auto& v) {
    return std::all_of(v.begin(), v.end(), [](auto x) { return std::isfinite(x); });
  };
  if (classes < 2 || counts_.size() != classes || vectors_.size() != vectors * size ||
      coefficients_.size() != (classes - 1) * vectors || rho_.size() != pairs ||
      prob_a_.size() != pairs || prob_b_.size() != pairs) {
    refuse("has parts that do not fit each other");
  }
  if (!std::isfinite(scale_) || !finite(vectors_) || !finite(coefficients_) || !finite(rho_) ||
      !finite(prob_a_) || !finite(prob_b_)) {
    refuse("has numbers that are none");
  }
  prepare();
}

std::string SvmClassifier::bytes() const {
  std::ostringstream bytes;
  hyselam::BinaryWriter out(bytes);
  out.put(scale_);
  out.putSized(labels_);
  out.putSized(counts_);
  out.putSized(vectors_);
  out.putSized(coefficients_);
  out.putSized(rho_);
  out.putSized(prob_a_);
  out.putSized(prob_b_);
  out.flush();
  return bytes.str();
}

void SvmClassifier::prepare() {
  const std::size_t classes = labels_.size(),
                    vectors = vectors_.size() / std::max<std::size_t>(1, size_);
  query_.resize(size_);
  estimate_.resize(classes);
  pair_.resize(classes * classes);
  matrix_.resize(classes * classes);
  step_.resize(classes);
  kernel_.resize(vectors);
  squares_.resize(vectors);
  for (std::size_t i = 0; i < vectors; ++i) {
    squares_[i] = dot(vectors_.data() + i * size_, vectors_.data() + i * size_, size_);
  }
  if (params_.kernel != SvmKernel::kLinear) return;
  // Sums of weighted support vectors: one vector per pair.
  std::vector<std::size_t> start(classes, 0);
  for (std::size_t c = 1; c < classes; ++c) {
    start[c] = start[c - 1] + static_cast<std::size_t>(counts_[c - 1]);
  }
  std::vector<double> sum(size_);
  for (std::size_t a = 0; a < classes; ++a) {
    for (std::size_t b = a + 1; b < classes; ++b) {
      std::fill(sum.begin(), sum.end(), 0.0);
      const auto addClass = [&](std::size_t of, std::size_t row) {
        for (std::size_t i = start[of]; i < start[of] + static_cast<std::size_t>(counts_[of]);
             ++i) {
          const double c = coefficients_[row * vectors + i];
          for (std::size_t k = 0; k < size_; ++k) sum[k] += c * vectors_[i * size_ + k];
        }
      };
      addClass(a, b - 1);
      addClass(b, a);
      weights_.insert(weights_.end(), sum.begin(), sum.end());
    }
  }
}

namespace {

/// The sigmoid of Platt, as libsvm evaluates it.
double sigmoid(double decision, double a, double b) {
  const double f = decision * a + b;
  return f >= 0.0 ? std::exp(-f) / (1.0 + std::exp(-f)) : 1.0 / (1.0 + std::exp(f));
}

/// Class probabilities from those of pairs: method 2 of Wu, Lin, Weng (2004), with libsvm's
/// stopping rule.
void couple(std::size_t k, const std::vector<double>& r, std::vector<double>& q,
            std::vector<double>& qp, std::vector<double>& p) {
  for (std::size_t t = 0; t < k; ++t) {
    p[t] = 1.0 / static_cast<double>(k);
    q[t * k + t] = 0.0;
    for (std::size_t j = 0; j < k; ++j) {
      if (j == t) continue;
      q[t * k + t] += r[j * k + t] * r[j * k + t];
      q[t * k + j] = -r[j * k + t] * r[t * k + j];
    }
  }
  const std::size_t rounds = std::max<std::size_t>(100, k);
  const double tolerance = 0.005 / static_cast<double>(k);
  for (std::size_t round = 0; round < rounds; ++round) {
    double pqp = 0.0, error = 0.0;
    for (std::size_t t = 0; t < k; ++t) {
      qp[t] = 0.0;
      for (std::size_t j = 0; j < k; ++j) qp[t] += q[t * k + j] * p[j];
      pqp += p[t] * qp[t];
    }
    for (std::size_t t = 0; t < k; ++t) error = std::max(error, std::abs(qp[t] - pqp));
    if (error < tolerance) break;
    for (std::size_t t = 0; t < k; ++t) {
      const double diff = (-qp[t] + pqp) / q[t * k + t];
      p[t] += diff;
      pqp = (pqp + diff * (diff * q[t * k + t] + 2.0 * qp[t])) / (1.0 + diff) / (1.0 + diff);
      for (std::size_t j = 0; j < k; ++j) {
        qp[j] = (qp[j] + diff * q[t * k + j]) / (1.0 + diff);
        p[j] /= 1.0 + diff;
      }
    }
  }
}

}  // namespace

void SvmClassifier::predict(const float* signature, double* probabilities) {
  normalizeSignature(signature, size_, params_.power, scale_, query_.data());
  const std::size_t classes = labels_.size(), vectors = squares_.size();
  if (params_.kernel != SvmKernel::kLinear) {
    const float square = dot(query_.data(), query_.data(), size_);
    for (std::size_t i = 0; i < vectors; ++i) {
      const float product = dot(query_.data(), vectors_.data() + i * size_, size_);
      if (params_.kernel == SvmKernel::kPoly) {
        const double base = params_.gamma * product + 1.0;
        kernel_[i] = base * base;
      } else {
        kernel_[i] =
            std::exp(-params_.gamma * std::max(0.0f, square + squares_[i] - 2.0f * product));
      }
    }
  }
  std::size_t pair = 0, start_a = 0;
  for (std::size_t a = 0; a < classes; start_a += static_cast<std::size_t>(counts_[a]), ++a) {
    std::size_t start_b = start_a + static_cast<std::size_t>(counts_[a]);
    for (std::size_t b = a + 1; b < classes;
         start_b += static_cast<std::size_t>(counts_[b]), ++b, ++pair) {
      double sum = 0.0;
      if (params_.kernel == SvmKernel::kLinear) {
        sum = dot(query_.data(), weights_.data() + pair * size_, size_);
      } else {
        const double* of_a = coefficients_.data() + (b - 1) * vectors;
        const double* of_b = coefficients_.data() + a * vectors;
        for (std::size_t i = start_a; i < start_a + static_cast<std::size_t>(counts_[a]); ++i) {
          sum += of_a[i] * kernel_[i];
        }
        for (std::size_t i = start_b; i < start_b + static_cast<std::size_t>(counts_[b]); ++i) {
          sum += of_b[i] * kernel_[i];
        }
      }
      const double p =
          std::clamp(sigmoid(sum - rho_[pair], prob_a_[pair], prob_b_[pair]), 1e-7, 1.0 - 1e-7);
      pair_[a * classes + b] = p;
      pair_[b * classes + a] = 1.0 - p;
    }
  }
  std::fill(probabilities, probabilities + places_, 0.0);
  if (classes == 2) {
    estimate_[0] = pair_[1];
    estimate_[1] = pair_[2];
  } else {
    couple(classes, pair_, matrix_, step_, estimate_);
  }
  for (std::size_t c = 0; c < classes; ++c) probabilities[labels_[c]] = estimate_[c];
}

}  // namespace selovis
