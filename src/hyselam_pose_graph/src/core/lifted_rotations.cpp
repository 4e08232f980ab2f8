#include "lifted_rotations.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "hyselam_common/rng.hpp"

namespace hyselam_pose_graph {

namespace {

using Vector4 = Eigen::Matrix<double, 4, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;

constexpr int kSize = 7;

/// 7 unknowns per pose: 3 for the direction of its rotation on the sphere, 4 for its position. An
/// eighth row of zeros makes columns that the processor takes in pairs: all is done by columns.
struct Block7 {
  using Vector = Eigen::Matrix<double, kSize + 1, 1>;
  using Matrix = Eigen::Matrix<double, kSize + 1, kSize>;
  Matrix m;

  static Block7 zero() { return {Matrix::Zero()}; }
  void subtractProduct(const Block7& a, const Block7& b) {
    for (int j = 0; j < kSize; ++j) {
      Vector column = m.col(j);
      for (int k = 0; k < kSize; ++k) column -= b.m(j, k) * a.m.col(k);
      m.col(j) = column;
    }
  }
  /// Of the lower triangle.
  bool factor() {
    for (int j = 0; j < kSize; ++j) {
      if (!(m(j, j) > 0.0)) return false;
      m.col(j) /= std::sqrt(m(j, j));
      m.col(j).head(j).setZero();
      for (int k = j + 1; k < kSize; ++k) m.col(k) -= m(k, j) * m.col(j);
    }
    return m.allFinite();
  }
  void solveRight(const Block7& l) {
    for (int j = 0; j < kSize; ++j) {
      Vector column = m.col(j);
      for (int k = 0; k < j; ++k) column -= l.m(j, k) * m.col(k);
      m.col(j) = column / l.m(j, j);
    }
  }
  void solveLower(Vector& v) const {
    for (int j = 0; j < kSize; ++j) {
      const double x = v[j] / m(j, j);
      v -= x * m.col(j);
      v[j] = x;
    }
  }
  void solveUpper(Vector& v) const {
    for (int j = kSize - 1; j >= 0; --j) {
      double x = v[j];
      for (int k = j + 1; k < kSize; ++k) x -= m(k, j) * v[k];
      v[j] = x / m(j, j);
    }
  }
  void subtractTimes(const Vector& x, Vector& y) const {
    for (int k = 0; k < kSize; ++k) y -= x[k] * m.col(k);
  }
  void subtractAdjointTimes(const Vector& x, Vector& y) const {
    for (int k = 0; k < kSize; ++k) y[k] -= m.col(k).dot(x);
  }
};

/// (re, im, re, im) of two complex numbers times c + i s.
Vector4 rotated(const Vector4& u, double c, double s) {
  return {c * u[0] - s * u[1], s * u[0] + c * u[1], c * u[2] - s * u[3], s * u[2] + c * u[3]};
}

/// Orthonormal directions in which a unit vector of R^4 can move: its products with the quaternions
/// i, j, k.
Eigen::Matrix<double, 4, 3> tangent(const Vector4& u) {
  Eigen::Matrix<double, 4, 3> b;
  b << -u[1], -u[2], -u[3],  //
      u[0], u[3], -u[2],     //
      -u[3], u[0], u[1],     //
      u[2], -u[1], u[0];
  return b;
}

struct Lifted {
  Vector4 rotation, position;
};

struct LiftedEdge {
  int from, to;
  double kappa, tau;
  double c, s;  ///< measured rotation
  double x, y;  ///< measured position
};

class LiftedProblem {
 public:
  explicit LiftedProblem(const PoseSystem& system) : system_(system) {
    for (const SystemEdge& e : system.edges()) {
      // tau: mean information of the position, 2 / trace(inverse).
      const double determinant = e.w.xx * e.w.yy - e.w.xy * e.w.xy;
      const double trace = e.w.xx + e.w.yy;
      const double tau = trace > 0.0 ? std::max(0.0, 2.0 * determinant / trace) : 0.0;
      edges_.push_back({e.from, e.to, e.w.tt, tau, std::cos(e.theta), std::sin(e.theta), e.x, e.y});
    }
  }

  double cost(const std::vector<Lifted>& v) const {
    double sum = 0.0;
    for (const LiftedEdge& e : edges_) {
      const Residual r = residual(e, v);
      sum += e.kappa * r.rotation.squaredNorm() + e.tau * r.position.squaredNorm();
    }
    return sum;
  }

  /// Newton's equations on the spheres, damped. False where they have no minimum.
  bool step(const std::vector<Lifted>& v, double damping, BlockCholesky<Block7>* h,
            std::vector<Block7::Vector>* x) const {
    h->setZero();
    x->assign(static_cast<std::size_t>(system_.rows()), Block7::Vector::Zero());
    std::vector<double> multipliers(v.size(), 0.0);  // of the unit spheres: Lambda
    for (const LiftedEdge& e : edges_) addEdge(e, v, h, x, &multipliers);
    for (std::size_t i = 0; i < v.size(); ++i) {
      const int row = system_.row(static_cast<int>(i));
      if (row < 0) continue;
      Block7& d = h->entry(system_.pattern().diagonal(row));
      const Eigen::Matrix<double, kSize, 1> scale = d.m.diagonal();
      d.m.topLeftCorner<3, 3>().diagonal().array() -= multipliers[i];
      d.m.diagonal() += damping * scale;
    }
    if (!h->factor()) return false;
    h->solve(x);
    return true;
  }

  std::vector<Lifted> moved(const std::vector<Lifted>& v,
                            const std::vector<Block7::Vector>& x) const {
    std::vector<Lifted> result = v;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const int row = system_.row(static_cast<int>(i));
      if (row < 0) continue;
      const Block7::Vector& d = x[static_cast<std::size_t>(row)];
      result[i].rotation = (v[i].rotation + tangent(v[i].rotation) * d.head<3>()).normalized();
      result[i].position += d.segment<4>(3);
    }
    return result;
  }

 private:
  struct Residual {
    Vector4 rotation, position;
  };

  void addEdge(const LiftedEdge& e, const std::vector<Lifted>& v, BlockCholesky<Block7>* h,
               std::vector<Block7::Vector>* x, std::vector<double>* multipliers) const {
    const Lifted& vi = v[static_cast<std::size_t>(e.from)];
    const Lifted& vj = v[static_cast<std::size_t>(e.to)];
    const Residual r = residual(e, v);
    // Gradients with respect to the rotations in R^4 and the positions.
    const Vector4 rj = e.kappa * r.rotation, tj = e.tau * r.position;
    const Vector4 ri = -rotated(rj, e.c, -e.s) - rotated(tj, e.x, -e.y);
    (*multipliers)[static_cast<std::size_t>(e.from)] += ri.dot(vi.rotation);
    (*multipliers)[static_cast<std::size_t>(e.to)] += rj.dot(vj.rotation);
    const int row_i = system_.row(e.from), row_j = system_.row(e.to);
    const Eigen::Matrix<double, 4, 3> bi = tangent(vi.rotation), bj = tangent(vj.rotation);
    Eigen::Matrix<double, 4, 3> zb, yb;  // derivatives of the residuals by rotation i, negative
    for (int k = 0; k < 3; ++k) {
      zb.col(k) = rotated(bi.col(k), e.c, e.s);
      yb.col(k) = rotated(bi.col(k), e.x, e.y);
    }
    if (row_i >= 0) {
      Block7& d = h->entry(system_.pattern().diagonal(row_i));
      d.m.topLeftCorner<3, 3>() += e.kappa * zb.transpose() * zb + e.tau * yb.transpose() * yb;
      d.m.block<3, 4>(0, 3) += e.tau * yb.transpose();
      d.m.block<4, 3>(3, 0) += e.tau * yb;
      d.m.block<4, 4>(3, 3) += e.tau * Matrix4::Identity();
      (*x)[static_cast<std::size_t>(row_i)].head<3>() -= bi.transpose() * ri;
      (*x)[static_cast<std::size_t>(row_i)].segment<4>(3) += tj;
    }
    if (row_j >= 0) {
      Block7& d = h->entry(system_.pattern().diagonal(row_j));
      d.m.topLeftCorner<3, 3>() += e.kappa * Eigen::Matrix3d::Identity();
      d.m.block<4, 4>(3, 3) += e.tau * Matrix4::Identity();
      (*x)[static_cast<std::size_t>(row_j)].head<3>() -= bj.transpose() * rj;
      (*x)[static_cast<std::size_t>(row_j)].segment<4>(3) -= tj;
    }
    if (row_i < 0 || row_j < 0) return;
    Eigen::Matrix<double, kSize, kSize> o;  // H(i, j)
    o.setZero();
    o.topLeftCorner<3, 3>() = -e.kappa * zb.transpose() * bj;
    o.topRightCorner<3, 4>() = -e.tau * yb.transpose();
    o.bottomRightCorner<4, 4>() = -e.tau * Matrix4::Identity();
    const CholeskyPattern::Slot slot = system_.pattern().slot(row_i, row_j);
    if (slot.transposed) {
      h->entry(slot.entry).m.topRows<kSize>() += o.transpose();
    } else {
      h->entry(slot.entry).m.topRows<kSize>() += o;
    }
  }

  static Residual residual(const LiftedEdge& e, const std::vector<Lifted>& v) {
    const Lifted& i = v[static_cast<std::size_t>(e.from)];
    const Lifted& j = v[static_cast<std::size_t>(e.to)];
    return {j.rotation - rotated(i.rotation, e.c, e.s),
            j.position - i.position - rotated(i.rotation, e.x, e.y)};
  }

  const PoseSystem& system_;
  std::vector<LiftedEdge> edges_;
};

/// The direction of C^2 with the largest share of the rotations (first principal component).
Eigen::Vector2cd dominantDirection(const std::vector<Lifted>& v) {
  Eigen::Matrix2cd gram = Eigen::Matrix2cd::Zero();
  for (const Lifted& p : v) {
    Eigen::Vector2cd u;  // two pairs of braces would be taken for two rows
    u << std::complex<double>(p.rotation[0], p.rotation[1]),
        std::complex<double>(p.rotation[2], p.rotation[3]);
    gram += u * u.adjoint();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2cd>(gram).eigenvectors().col(1);
}

}  // namespace

struct LiftedRotations::State {
  explicit State(const PoseSystem& s) : system(s), problem(s), h(s.pattern()) {}

  const PoseSystem& system;
  LiftedProblem problem;
  BlockCholesky<Block7> h;
  std::vector<Block7::Vector> x;
  std::vector<Lifted> v;
  std::vector<SystemPose> poses;  // at the start
  double cost = 0.0, damping = 1e-2;
  int iterations = 0;
};

LiftedRotations::LiftedRotations(const PoseSystem& system, std::vector<SystemPose> poses)
    : state_(std::make_unique<State>(system)) {
  // A random perturbation into the second dimension leads away from the local minimum of the first.
  hyselam::Rng rng(1);
  state_->v.reserve(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const SystemPose& p = poses[i];
    const double perturbation = system.row(static_cast<int>(i)) < 0 ? 0.0 : 0.3;
    const double a = perturbation * (2.0 * rng.uniform() - 1.0),
                 b = perturbation * (2.0 * rng.uniform() - 1.0);
    state_->v.push_back({Vector4(p.c, p.s, a, b).normalized(), Vector4(p.x, p.y, 0.0, 0.0)});
  }
  state_->poses = std::move(poses);
  state_->cost = state_->problem.cost(state_->v);
}
LiftedRotations::~LiftedRotations() = default;

void LiftedRotations::descend(double tolerance, int max_iterations) {
  State& s = *state_;
  for (; s.iterations < max_iterations && s.damping < 1e9; ++s.iterations) {
    if (!s.problem.step(s.v, s.damping, &s.h, &s.x)) {
      s.damping *= 4.0;
      continue;
    }
    std::vector<Lifted> next = s.problem.moved(s.v, s.x);
    const double next_cost = s.problem.cost(next);
    if (!(next_cost < s.cost)) {
      s.damping *= 4.0;
      continue;
    }
    const double gain = s.cost - next_cost;
    s.v = std::move(next);
    s.cost = next_cost;
    s.damping = std::max(s.damping / 4.0, 1e-9);
    if (gain < tolerance * s.cost) break;
  }
}

std::vector<SystemPose> LiftedRotations::poses() const {
  const PoseSystem& system = state_->system;
  std::vector<SystemPose> poses = state_->poses;
  const std::vector<Lifted>& v = state_->v;
  const Eigen::Vector2cd direction = dominantDirection(v);
  // Fixed poses keep their rotation: each component is rotated back by that of its first pose,
  // which precedes the others.
  std::vector<std::complex<double>> alignment;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vector4& u = v[i].rotation;
    const std::complex<double> r = std::conj(direction[0]) * std::complex<double>(u[0], u[1]) +
                                   std::conj(direction[1]) * std::complex<double>(u[2], u[3]);
    const double length = std::abs(r);
    const std::complex<double> unit = length > 0.0 ? r / length : std::complex<double>(1.0, 0.0);
    SystemPose& p = poses[i];
    if (system.row(static_cast<int>(i)) < 0) {
      alignment.push_back(std::complex<double>(p.c, p.s) / unit);
      continue;
    }
    const std::complex<double> rotation =
        unit * alignment[static_cast<std::size_t>(system.component(static_cast<int>(i)))];
    p.c = rotation.real();
    p.s = rotation.imag();
    p.theta = std::arg(rotation);
  }
  return poses;
}

}  // namespace hyselam_pose_graph
