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

using Complex = std::complex<double>;
using Vector4 = Eigen::Matrix<double, 4, 1>;  // (re, im, re, im) of two complex numbers

constexpr double kPerturbation = 0.3;
constexpr int kInnerSteps = 60;         // of conjugate gradients, for one step
constexpr double kInnerGradient = 0.1;  // they end where so much of the gradient is left
constexpr double kLeastAgreement = 0.1, kPoor = 0.25, kGood = 0.75;  // of the gain with the model

/// Two complex numbers times c + i s.
Vector4 rotated(const Vector4& u, double c, double s) {
  return {c * u[0] - s * u[1], s * u[0] + c * u[1], c * u[2] - s * u[3], s * u[2] + c * u[3]};
}

/// A pose, or how it moves.
struct Lifted {
  Vector4 rotation, position;
};
using LiftedPoses = std::vector<Lifted>;

double dot(const LiftedPoses& a, const LiftedPoses& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += a[i].rotation.dot(b[i].rotation) + a[i].position.dot(b[i].position);
  return sum;
}
/// *a += s b
void add(double s, const LiftedPoses& b, LiftedPoses* a) {
  for (std::size_t i = 0; i < b.size(); ++i) {
    (*a)[i].rotation += s * b[i].rotation;
    (*a)[i].position += s * b[i].position;
  }
}

/// Hermitian 2x2 of (rotation, position): the cost is quadratic in them, and the same in each of
/// the two dimensions of C^2, which are solved together.
struct Block2 {
  struct Vector {
    Complex r[2], t[2];  // of each dimension
  };
  Complex rr, rt, tr, tt;

  static Complex times(const Complex& a, const Complex& b) { return BlockComplex::times(a, b); }
  static Complex adjoint(const Complex& a, const Complex& b) { return times(std::conj(a), b); }
  static Block2 zero() { return {}; }
  void subtractProduct(const Block2& a, const Block2& b) {
    rr -= adjoint(b.rr, a.rr) + adjoint(b.rt, a.rt);
    rt -= adjoint(b.tr, a.rr) + adjoint(b.tt, a.rt);
    tr -= adjoint(b.rr, a.tr) + adjoint(b.rt, a.tt);
    tt -= adjoint(b.tr, a.tr) + adjoint(b.tt, a.tt);
  }
  bool factor() {
    if (!(rr.real() > 0.0) || !std::isfinite(rr.real())) return false;
    rr = std::sqrt(rr.real());
    tr /= rr.real();
    rt = 0.0;
    const double d = tt.real() - std::norm(tr);
    if (!(d > 0.0) || !std::isfinite(d)) return false;
    tt = std::sqrt(d);
    return true;
  }
  void solveRight(const Block2& l) {
    const Complex back = std::conj(l.tr);
    rr /= l.rr.real();
    tr /= l.rr.real();
    rt = (rt - times(rr, back)) / l.tt.real();
    tt = (tt - times(tr, back)) / l.tt.real();
  }
  void solveLower(Vector& v) const {
    for (int k = 0; k < 2; ++k) {
      v.r[k] /= rr.real();
      v.t[k] = (v.t[k] - times(tr, v.r[k])) / tt.real();
    }
  }
  void solveUpper(Vector& v) const {
    for (int k = 0; k < 2; ++k) {
      v.t[k] /= tt.real();
      v.r[k] = (v.r[k] - adjoint(tr, v.t[k])) / rr.real();
    }
  }
  void subtractTimes(const Vector& x, Vector& y) const {
    for (int k = 0; k < 2; ++k) {
      y.r[k] -= times(rr, x.r[k]) + times(rt, x.t[k]);
      y.t[k] -= times(tr, x.r[k]) + times(tt, x.t[k]);
    }
  }
  void subtractAdjointTimes(const Vector& x, Vector& y) const {
    for (int k = 0; k < 2; ++k) {
      y.r[k] -= adjoint(rr, x.r[k]) + adjoint(tr, x.t[k]);
      y.t[k] -= adjoint(rt, x.r[k]) + adjoint(tt, x.t[k]);
    }
  }
};

struct LiftedEdge {
  int from, to;
  double kappa, tau;
  double c, s;  ///< measured rotation
  double x, y;  ///< measured position
};

/// Half the sum of kappa |r_j - z r_i|^2 + tau |t_j - t_i - m r_i|^2: v* Q v / 2.
class LiftedProblem {
 public:
  explicit LiftedProblem(const PoseSystem& system) : system_(system), factor_(system.pattern()) {
    for (const SystemEdge& e : system.edges()) {
      // tau: mean information of the position, 2 / trace(inverse).
      const double determinant = e.w.xx * e.w.yy - e.w.xy * e.w.xy;
      const double trace = e.w.xx + e.w.yy;
      const double tau = trace > 0.0 ? std::max(0.0, 2.0 * determinant / trace) : 0.0;
      edges_.push_back({e.from, e.to, e.w.tt, tau, e.c, e.s, e.x, e.y});
    }
    determined_ = factorQ();
  }

  /// Whether the edges determine all poses.
  bool determined() const { return determined_; }

  double cost(const LiftedPoses& v) const {
    double sum = 0.0;
    for (const LiftedEdge& e : edges_) {
      const Lifted r = residual(e, v);
      sum += e.kappa * r.rotation.squaredNorm() + e.tau * r.position.squaredNorm();
    }
    return 0.5 * sum;
  }

  /// Q v, zero at fixed poses.
  void multiply(const LiftedPoses& v, LiftedPoses* out) const {
    out->assign(v.size(), {Vector4::Zero(), Vector4::Zero()});
    for (const LiftedEdge& e : edges_) {
      const Lifted r = residual(e, v);
      const Vector4 rj = e.kappa * r.rotation, tj = e.tau * r.position;
      Lifted &from = (*out)[static_cast<std::size_t>(e.from)],
             &to = (*out)[static_cast<std::size_t>(e.to)];
      to.rotation += rj;
      to.position += tj;
      from.rotation -= rotated(rj, e.c, -e.s) + rotated(tj, e.x, -e.y);
      from.position -= tj;
    }
    for (std::size_t i = 0; i < v.size(); ++i)
      if (isFixed(i)) (*out)[i] = {Vector4::Zero(), Vector4::Zero()};
  }

  /// Q^-1 v.
  void divide(const LiftedPoses& v, LiftedPoses* out) {
    b_.resize(static_cast<std::size_t>(system_.rows()));
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (isFixed(i)) continue;
      const Vector4 &r = v[i].rotation, &t = v[i].position;
      b_[rowOf(i)] = {{{r[0], r[1]}, {r[2], r[3]}}, {{t[0], t[1]}, {t[2], t[3]}}};
    }
    factor_.solve(&b_);
    out->assign(v.size(), {Vector4::Zero(), Vector4::Zero()});
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (isFixed(i)) continue;
      const Block2::Vector& x = b_[rowOf(i)];
      (*out)[i] = {{x.r[0].real(), x.r[0].imag(), x.r[1].real(), x.r[1].imag()},
                   {x.t[0].real(), x.t[0].imag(), x.t[1].real(), x.t[1].imag()}};
    }
  }

  bool isFixed(std::size_t pose) const { return system_.row(static_cast<int>(pose)) < 0; }

 private:
  std::size_t rowOf(std::size_t pose) const {
    return static_cast<std::size_t>(system_.row(static_cast<int>(pose)));
  }

  static Lifted residual(const LiftedEdge& e, const LiftedPoses& v) {
    const Lifted& i = v[static_cast<std::size_t>(e.from)];
    const Lifted& j = v[static_cast<std::size_t>(e.to)];
    return {j.rotation - rotated(i.rotation, e.c, e.s),
            j.position - i.position - rotated(i.rotation, e.x, e.y)};
  }

  bool factorQ() {
    factor_.setZero();
    for (const LiftedEdge& e : edges_) {
      const int row_i = system_.row(e.from), row_j = system_.row(e.to);
      const Complex z(e.c, e.s), m(e.x, e.y);
      if (row_i >= 0) {
        Block2& d = factor_.entry(system_.pattern().diagonal(row_i));
        d.rr += e.kappa + e.tau * std::norm(m);
        d.rt += e.tau * std::conj(m);
        d.tr += e.tau * m;
        d.tt += e.tau;
      }
      if (row_j >= 0) {
        Block2& d = factor_.entry(system_.pattern().diagonal(row_j));
        d.rr += e.kappa;
        d.tt += e.tau;
      }
      if (row_i < 0 || row_j < 0) continue;
      const CholeskyPattern::Slot slot = system_.pattern().slot(row_i, row_j);
      Block2& o = factor_.entry(slot.entry);
      o.tt -= e.tau;
      o.rr -= e.kappa * (slot.transposed ? z : std::conj(z));
      (slot.transposed ? o.tr : o.rt) -= e.tau * (slot.transposed ? m : std::conj(m));
    }
    return factor_.factor();
  }

  const PoseSystem& system_;
  std::vector<LiftedEdge> edges_;
  BlockCholesky<Block2> factor_;
  std::vector<Block2::Vector> b_;
  bool determined_ = false;
};

/// Takes from `v` what would change the lengths of the rotations of `at`.
void project(const LiftedPoses& at, LiftedPoses* v) {
  for (std::size_t i = 0; i < at.size(); ++i)
    (*v)[i].rotation -= at[i].rotation.dot((*v)[i].rotation) * at[i].rotation;
}

LiftedPoses moved(const LiftedPoses& v, const LiftedPoses& step) {
  LiftedPoses result = v;
  add(1.0, step, &result);
  for (Lifted& p : result) p.rotation.normalize();
  return result;
}

/// The direction of C^2 with the largest share of the rotations (first principal component).
Eigen::Vector2cd dominantDirection(const LiftedPoses& v) {
  Eigen::Matrix2cd gram = Eigen::Matrix2cd::Zero();
  for (const Lifted& p : v) {
    Eigen::Vector2cd u;  // two pairs of braces would be taken for two rows
    u << Complex(p.rotation[0], p.rotation[1]), Complex(p.rotation[2], p.rotation[3]);
    gram += u * u.adjoint();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2cd>(gram).eigenvectors().col(1);
}

}  // namespace

struct LiftedRotations::State {
  explicit State(const PoseSystem& s) : system(s), problem(s) {}

  const PoseSystem& system;
  LiftedProblem problem;
  LiftedPoses v;
  std::vector<SystemPose> poses;  // at the start
  double cost = 0.0, radius = 0.0;
  int iterations = 0;

  // Of one step.
  LiftedPoses gradient, step, rest, direction, curved, scaled;
  std::vector<double> multipliers;  // of the unit spheres

  void multiply();
  double findStep();
};

/// What the cost's second derivative makes of the direction.
void LiftedRotations::State::multiply() {
  problem.multiply(direction, &curved);
  for (std::size_t i = 0; i < curved.size(); ++i)
    curved[i].rotation -= multipliers[i] * direction[i].rotation;
  project(v, &curved);
}

/// The step that the quadratic model at v promises most of within the radius, by conjugate
/// gradients (Steihaug, Toint), and that gain. Lengths are measured by Q, whose inverse is near
/// that of the second derivative.
double LiftedRotations::State::findStep() {
  problem.multiply(v, &gradient);
  multipliers.resize(v.size());
  for (std::size_t i = 0; i < v.size(); ++i)
    multipliers[i] = v[i].rotation.dot(gradient[i].rotation);
  project(v, &gradient);
  rest = gradient;
  const auto scale = [&] {
    problem.divide(rest, &scaled);
    project(v, &scaled);
    return dot(rest, scaled);
  };
  double size = scale(), step_step = 0.0, step_direction = 0.0, direction_direction = size;
  if (radius <= 0.0) radius = std::sqrt(size);
  const double enough = kInnerGradient * kInnerGradient * size;
  step.assign(v.size(), {Vector4::Zero(), Vector4::Zero()});
  direction = step;
  add(-1.0, scaled, &direction);
  double gain = 0.0;
  for (int k = 0; k < kInnerSteps && size > enough; ++k) {
    multiply();
    const double curvature = dot(direction, curved);
    const double alpha = size / curvature;
    const double after =
        step_step + 2.0 * alpha * step_direction + alpha * alpha * direction_direction;
    if (!(curvature > 0.0) || after >= radius * radius) {  // to the edge of the region
      const double free = radius * radius - step_step;
      const double length =
          (std::sqrt(step_direction * step_direction + direction_direction * free) -
           step_direction) /
          direction_direction;
      add(length, direction, &step);
      return gain + length * (size - 0.5 * length * curvature);
    }
    add(alpha, direction, &step);
    add(alpha, curved, &rest);
    gain += 0.5 * alpha * size;
    const double before = size;
    size = scale();
    const double beta = size / before;
    for (std::size_t i = 0; i < v.size(); ++i) {
      direction[i].rotation = beta * direction[i].rotation - scaled[i].rotation;
      direction[i].position = beta * direction[i].position - scaled[i].position;
    }
    step_step = after;
    step_direction = beta * (step_direction + alpha * direction_direction);
    direction_direction = size + beta * beta * direction_direction;
  }
  return gain;
}

LiftedRotations::LiftedRotations(const PoseSystem& system, std::vector<SystemPose> poses)
    : state_(std::make_unique<State>(system)) {
  // A random perturbation into the second dimension leads away from the local minimum of the first.
  hyselam::Rng rng(1);
  state_->v.reserve(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const SystemPose& p = poses[i];
    const double perturbation = system.row(static_cast<int>(i)) < 0 ? 0.0 : kPerturbation;
    const double a = perturbation * (2.0 * rng.uniform() - 1.0),
                 b = perturbation * (2.0 * rng.uniform() - 1.0);
    state_->v.push_back({Vector4(p.c, p.s, a, b).normalized(), Vector4(p.x, p.y, 0.0, 0.0)});
  }
  state_->poses = std::move(poses);
  state_->cost = state_->problem.cost(state_->v);
}
LiftedRotations::~LiftedRotations() = default;

bool LiftedRotations::descend(double tolerance, int max_iterations) {
  State& s = *state_;
  if (!s.problem.determined()) return false;
  for (; s.iterations < max_iterations; ++s.iterations) {
    const double promised = s.findStep();
    LiftedPoses next = moved(s.v, s.step);
    const double next_cost = s.problem.cost(next);
    const double gain = s.cost - next_cost;
    const double agreement = gain / promised;
    if (!(agreement >= kPoor)) s.radius *= 0.25;
    if (agreement > kGood) s.radius *= 2.0;
    if (!(agreement > kLeastAgreement)) {
      if (!(promised > 1e-12 * s.cost)) break;
      continue;
    }
    s.v = std::move(next);
    s.cost = next_cost;
    if (gain < tolerance * s.cost) break;
  }
  return true;
}

std::vector<SystemPose> LiftedRotations::poses() const {
  const PoseSystem& system = state_->system;
  std::vector<SystemPose> poses = state_->poses;
  const LiftedPoses& v = state_->v;
  const Eigen::Vector2cd direction = dominantDirection(v);
  // Fixed poses keep their rotation: each component is rotated back by that of its first pose,
  // which precedes the others.
  std::vector<Complex> alignment;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vector4& u = v[i].rotation;
    const Complex r = std::conj(direction[0]) * Complex(u[0], u[1]) +
                      std::conj(direction[1]) * Complex(u[2], u[3]);
    const double length = magnitude(r);
    const Complex unit = length > 0.0 ? r / length : Complex(1.0, 0.0);
    SystemPose& p = poses[i];
    if (system.row(static_cast<int>(i)) < 0) {
      alignment.push_back(Complex(p.c, p.s) / unit);
      continue;
    }
    const Complex rotation =
        unit * alignment[static_cast<std::size_t>(system.component(static_cast<int>(i)))];
    p.c = rotation.real();
    p.s = rotation.imag();
    p.theta = std::arg(rotation);
  }
  return poses;
}

}  // namespace hyselam_pose_graph
