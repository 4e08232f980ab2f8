#include "pose_system.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace hyselam_pose_graph {

namespace {

struct Residual {
  double px, py;      // t_j in i
  double ex, ey, et;  // error
  double wx, wy, wt;  // Omega e
};

/// The error of an edge for t_j in i at (x, y).
void setError(const SystemEdge& e, double x, double y, const SystemPose& i, const SystemPose& j,
              Residual* r) {
  r->ex = x - e.x;
  r->ey = y - e.y;
  r->et = hyselam::normalizeAngle(j.theta - i.theta - e.theta);
  r->wx = e.w.xx * r->ex + e.w.xy * r->ey + e.w.xt * r->et;
  r->wy = e.w.xy * r->ex + e.w.yy * r->ey + e.w.yt * r->et;
  r->wt = e.w.xt * r->ex + e.w.yt * r->ey + e.w.tt * r->et;
}

Residual residual(const SystemEdge& e, const SystemPose& i, const SystemPose& j) {
  Residual r{};
  const double dx = j.x - i.x, dy = j.y - i.y;
  r.px = i.c * dx + i.s * dy;
  r.py = -i.s * dx + i.c * dy;
  setError(e, r.px, r.py, i, j, &r);
  return r;
}

/// The residual with unknown positions: they are counted from the origin, those of fixed poses are
/// known. The derivative by the angle is taken at the measurement.
Residual residualOfRotations(const SystemEdge& e, const SystemPose& i, bool i_fixed,
                             const SystemPose& j, bool j_fixed) {
  Residual r{};
  const double dx = (j_fixed ? j.x : 0.0) - (i_fixed ? i.x : 0.0);
  const double dy = (j_fixed ? j.y : 0.0) - (i_fixed ? i.y : 0.0);
  setError(e, i.c * dx + i.s * dy, -i.s * dx + i.c * dy, i, j, &r);
  r.px = e.x;
  r.py = e.y;
  return r;
}

double rotationError(const SystemEdge& e, const std::vector<SystemPose>& poses) {
  return hyselam::normalizeAngle(poses[static_cast<std::size_t>(e.to)].theta -
                                 poses[static_cast<std::size_t>(e.from)].theta - e.theta);
}

/// What an edge adds to the normal equations. J_j = (R_i^T 0; 0 1), J_i = -(R_i^T q; 0 1) with
/// q = (-py, px): d(R_i^T d)/dtheta = -q.
struct EdgeTerms {
  double hxx, hxy, hyy, hxt, hyt, htt;  ///< J_j^T Omega J_j
  double mx, my, mt;                    ///< the column of theta in J_i^T Omega J_i
  double m2;                            ///< theta, theta in -J_i^T Omega J_j
  double gx, gy;                        ///< J_j^T Omega e, and the negative of J_i^T Omega e
  double gt_from, gt_to;                ///< the same of theta
};

EdgeTerms edgeTerms(const SystemEdge& e, const SystemPose& i, const Residual& r, double weight) {
  const double w00 = weight * e.w.xx, w01 = weight * e.w.xy, w11 = weight * e.w.yy;
  const double w02 = weight * e.w.xt, w12 = weight * e.w.yt, w22 = weight * e.w.tt;
  EdgeTerms t{};
  // u = Omega J_j, its columns of x and y.
  const double ux0 = w00 * i.c - w01 * i.s, ux1 = w01 * i.c - w11 * i.s;
  const double uy0 = w00 * i.s + w01 * i.c, uy1 = w01 * i.s + w11 * i.c;
  t.hxx = i.c * ux0 - i.s * ux1;
  t.hxy = i.c * uy0 - i.s * uy1;
  t.hyy = i.s * uy0 + i.c * uy1;
  t.hxt = i.c * w02 - i.s * w12;
  t.hyt = i.s * w02 + i.c * w12;
  t.htt = w22;
  // m = Omega (q, 1): the negative column of theta in Omega J_i.
  const double qx = -r.py, qy = r.px;
  const double m0 = w00 * qx + w01 * qy + w02, m1 = w01 * qx + w11 * qy + w12;
  t.m2 = w02 * qx + w12 * qy + w22;
  t.mx = i.c * m0 - i.s * m1;
  t.my = i.s * m0 + i.c * m1;
  t.mt = qx * m0 + qy * m1 + t.m2;
  t.gx = weight * (i.c * r.wx - i.s * r.wy);
  t.gy = weight * (i.s * r.wx + i.c * r.wy);
  t.gt_to = weight * r.wt;
  t.gt_from = weight * (qx * r.wx + qy * r.wy) + t.gt_to;
  return t;
}

double squared(const Residual& r) {
  return r.ex * r.wx + r.ey * r.wy + r.et * r.wt;
}

}  // namespace

PoseSystem::PoseSystem(const PoseGraph& graph, const PoseSystem* earlier)
    : row_(graph.poses.size(), -1), component_(connectedComponents(graph)) {
  int rows = 0, components = 0;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (component_[i] == components)
      ++components;  // first of its component: fixed (gauge)
    else
      row_[i] = rows++;
  }
  std::vector<std::pair<int, int>> couplings;
  couplings.reserve(graph.edges.size());
  for (const PoseEdge& edge : graph.edges)
    if (row(edge.from) >= 0 && row(edge.to) >= 0)
      couplings.emplace_back(row(edge.from), row(edge.to));
  reuses_pattern_ = earlier != nullptr && earlier->row_ == row_ &&
                    std::all_of(couplings.begin(), couplings.end(), [&](const auto& pair) {
                      return earlier->pattern_.holds(pair.first, pair.second);
                    });
  pattern_ = reuses_pattern_ ? earlier->pattern_ : analyzePattern(rows, couplings);
  diagonal_.resize(static_cast<std::size_t>(rows));
  for (int i = 0; i < rows; ++i) diagonal_[static_cast<std::size_t>(i)] = pattern_.diagonal(i);

  edges_.reserve(graph.edges.size());
  for (const PoseEdge& edge : graph.edges) {
    SystemEdge e{};
    e.from = edge.from;
    e.to = edge.to;
    e.block = -1;
    if (row(e.from) >= 0 && row(e.to) >= 0) {
      const CholeskyPattern::Slot slot = pattern_.slot(row(e.from), row(e.to));
      e.block = slot.entry;
      e.from_row = !slot.transposed;
    }
    e.x = edge.measured.x;
    e.y = edge.measured.y;
    e.theta = edge.measured.theta;
    e.c = std::cos(e.theta);
    e.s = std::sin(e.theta);
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    rotation.topLeftCorner<2, 2>() << e.c, -e.s, e.s, e.c;
    const Eigen::Matrix3d w = rotation * edge.information * rotation.transpose();
    e.w = {w(0, 0), w(0, 1), w(1, 1), w(0, 2), w(1, 2), w(2, 2)};
    edges_.push_back(e);
  }
}

std::vector<SystemPose> PoseSystem::system(const std::vector<hyselam::Pose2>& poses) {
  std::vector<SystemPose> result;
  result.reserve(poses.size());
  for (const hyselam::Pose2& p : poses)
    result.push_back({p.x, p.y, p.theta, std::cos(p.theta), std::sin(p.theta)});
  return result;
}

std::vector<hyselam::Pose2> PoseSystem::poses(const std::vector<SystemPose>& poses) {
  std::vector<hyselam::Pose2> result;
  result.reserve(poses.size());
  for (const SystemPose& p : poses) result.push_back({p.x, p.y, hyselam::normalizeAngle(p.theta)});
  return result;
}

double PoseSystem::cost(const std::vector<SystemPose>& poses,
                        const std::vector<double>& weights) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const SystemEdge& e = edges_[k];
    const double squares = squared(residual(e, poses[static_cast<std::size_t>(e.from)],
                                            poses[static_cast<std::size_t>(e.to)]));
    sum += weights.empty() ? squares : weights[k] * squares;
  }
  return sum;
}

void PoseSystem::edgeCosts(const std::vector<SystemPose>& poses, std::vector<double>* costs) const {
  costs->resize(edges_.size());
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const SystemEdge& e = edges_[k];
    (*costs)[k] = squared(residual(e, poses[static_cast<std::size_t>(e.from)],
                                   poses[static_cast<std::size_t>(e.to)]));
  }
}

void PoseSystem::rotationCosts(const std::vector<SystemPose>& poses,
                               std::vector<double>* costs) const {
  costs->resize(edges_.size());
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const SystemEdge& e = edges_[k];
    const double turn = rotationError(e, poses);
    (*costs)[k] = e.w.tt * turn * turn;
  }
}

PoseSystem::Jacobian PoseSystem::jacobian(const SystemEdge& edge, const SystemPose& from,
                                          const SystemPose& to) {
  const Residual r = residual(edge, from, to);
  Jacobian j;
  j.error << r.ex, r.ey, r.et;
  j.from << -from.c, -from.s, r.py, from.s, -from.c, -r.px, 0.0, 0.0, -1.0;
  j.to << from.c, from.s, 0.0, -from.s, from.c, 0.0, 0.0, 0.0, 1.0;
  j.information << edge.w.xx, edge.w.xy, edge.w.xt, edge.w.xy, edge.w.yy, edge.w.yt, edge.w.xt,
      edge.w.yt, edge.w.tt;
  return j;
}

template <bool kFromRotations>
void PoseSystem::fill(const std::vector<SystemPose>& poses, const std::vector<double>& weights,
                      BlockCholesky<Block3>* h, std::vector<Vector>* b) const {
  h->setZero();
  b->assign(static_cast<std::size_t>(rows()), Vector{});
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const SystemEdge& e = edges_[k];
    const double weight = weights.empty() ? 1.0 : weights[k];
    if (weight == 0.0) continue;
    const SystemPose& i = poses[static_cast<std::size_t>(e.from)];
    const SystemPose& j = poses[static_cast<std::size_t>(e.to)];
    const int ri = row(e.from), rj = row(e.to);
    const Residual r =
        kFromRotations ? residualOfRotations(e, i, ri < 0, j, rj < 0) : residual(e, i, j);
    const EdgeTerms t = edgeTerms(e, i, r, weight);
    if (rj >= 0) {
      Block3& d = h->entry(diagonal_[static_cast<std::size_t>(rj)]);
      d.column[0] += Vector{t.hxx, t.hxy, t.hxt, 0.0};
      d.column[1] += Vector{t.hxy, t.hyy, t.hyt, 0.0};
      d.column[2] += Vector{t.hxt, t.hyt, t.htt, 0.0};
      (*b)[static_cast<std::size_t>(rj)] -= Vector{t.gx, t.gy, t.gt_to, 0.0};
    }
    if (ri >= 0) {
      Block3& d = h->entry(diagonal_[static_cast<std::size_t>(ri)]);
      d.column[0] += Vector{t.hxx, t.hxy, t.mx, 0.0};
      d.column[1] += Vector{t.hxy, t.hyy, t.my, 0.0};
      d.column[2] += Vector{t.mx, t.my, t.mt, 0.0};
      (*b)[static_cast<std::size_t>(ri)] += Vector{t.gx, t.gy, t.gt_from, 0.0};
    }
    if (e.block >= 0) {
      // H(i, j) = J_i^T Omega J_j.
      Block3& o = h->entry(e.block);
      if (e.from_row) {  // the entry's row is i
        o.column[0] -= Vector{t.hxx, t.hxy, t.mx, 0.0};
        o.column[1] -= Vector{t.hxy, t.hyy, t.my, 0.0};
        o.column[2] -= Vector{t.hxt, t.hyt, t.m2, 0.0};
      } else {
        o.column[0] -= Vector{t.hxx, t.hxy, t.hxt, 0.0};
        o.column[1] -= Vector{t.hxy, t.hyy, t.hyt, 0.0};
        o.column[2] -= Vector{t.mx, t.my, t.m2, 0.0};
      }
    }
  }
}

void PoseSystem::gradient(const std::vector<SystemPose>& poses, const std::vector<double>& weights,
                          std::vector<Vector>* b) const {
  b->assign(static_cast<std::size_t>(rows()), Vector{});
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const SystemEdge& e = edges_[k];
    const double weight = weights.empty() ? 1.0 : weights[k];
    if (weight == 0.0) continue;
    const SystemPose& i = poses[static_cast<std::size_t>(e.from)];
    const Residual r = residual(e, i, poses[static_cast<std::size_t>(e.to)]);
    const EdgeTerms t = edgeTerms(e, i, r, weight);
    const int ri = row(e.from), rj = row(e.to);
    if (rj >= 0) (*b)[static_cast<std::size_t>(rj)] -= Vector{t.gx, t.gy, t.gt_to, 0.0};
    if (ri >= 0) (*b)[static_cast<std::size_t>(ri)] += Vector{t.gx, t.gy, t.gt_from, 0.0};
  }
}

void PoseSystem::linearize(const std::vector<SystemPose>& poses, const std::vector<double>& weights,
                           double damping, BlockCholesky<Block3>* h, std::vector<Vector>* b) const {
  fill<false>(poses, weights, h, b);
  if (damping > 0.0)
    for (const int d : diagonal_)
      for (int k = 0; k < 3; ++k) h->entry(d).column[k][k] *= 1.0 + damping;
}

void PoseSystem::linearizeFromRotations(const std::vector<SystemPose>& poses,
                                        const std::vector<double>& weights,
                                        BlockCholesky<Block3>* h, std::vector<Vector>* b) const {
  fill<true>(poses, weights, h, b);
}

std::vector<SystemPose> PoseSystem::moved(const std::vector<SystemPose>& poses,
                                          const std::vector<Vector>& x) const {
  std::vector<SystemPose> result = poses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (row_[i] < 0) continue;
    const Vector& d = x[static_cast<std::size_t>(row_[i])];
    SystemPose& p = result[i];
    p.x += d[0];
    p.y += d[1];
    p.theta += d[2];
    p.c = std::cos(p.theta);
    p.s = std::sin(p.theta);
  }
  return result;
}

bool PoseSystem::relaxRotations(const std::vector<double>& weights,
                                std::vector<SystemPose>* poses) const {
  using Complex = std::complex<double>;
  BlockCholesky<BlockComplex> h(pattern_);
  h.setZero();
  std::vector<Complex> b(static_cast<std::size_t>(rows()));
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    // kappa |r_j - z r_i|^2
    const SystemEdge& e = edges_[k];
    const double kappa = (weights.empty() ? 1.0 : weights[k]) * e.w.tt;
    if (kappa == 0.0) continue;
    const Complex z{e.c, e.s};
    const int ri = row(e.from), rj = row(e.to);
    if (ri >= 0) h.entry(diagonal_[static_cast<std::size_t>(ri)]).value += kappa;
    if (rj >= 0) h.entry(diagonal_[static_cast<std::size_t>(rj)]).value += kappa;
    // H(j, i) = -kappa z, H(i, j) its conjugate.
    if (e.block >= 0) h.entry(e.block).value -= kappa * (e.from_row ? std::conj(z) : z);
    const auto fixed = [&](int pose) {
      const SystemPose& p = (*poses)[static_cast<std::size_t>(pose)];
      return Complex{p.c, p.s};
    };
    if (ri < 0 && rj >= 0) b[static_cast<std::size_t>(rj)] += kappa * z * fixed(e.from);
    if (rj < 0 && ri >= 0) b[static_cast<std::size_t>(ri)] += kappa * std::conj(z) * fixed(e.to);
  }
  if (!h.factor()) return false;
  h.solve(&b);
  for (std::size_t i = 0; i < poses->size(); ++i) {
    if (row_[i] < 0) continue;
    const Complex& r = b[static_cast<std::size_t>(row_[i])];
    const double length = magnitude(r);
    SystemPose& p = (*poses)[i];
    p.theta = std::arg(r);
    p.c = length > 0.0 ? r.real() / length : 1.0;
    p.s = length > 0.0 ? r.imag() / length : 0.0;
  }
  return true;
}

double PoseSystem::maxRotationError(const std::vector<SystemPose>& poses) const {
  double largest = 0.0;
  for (const SystemEdge& e : edges_) largest = std::max(largest, std::abs(rotationError(e, poses)));
  return largest;
}

}  // namespace hyselam_pose_graph
