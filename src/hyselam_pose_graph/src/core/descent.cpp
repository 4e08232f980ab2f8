#include "descent.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace hyselam_pose_graph {

namespace {
constexpr double kNearMinimum =
    1e-2;  // of the cost, predicted for a step: the next one may be the last
constexpr int kOldFactorSteps = 2;
constexpr double kOldFactorTolerance = 1e-4;  // of that of other steps
constexpr int kFullSteps = 8;                 // tried at once where a damped step does not descend
}  // namespace

bool Descent::solvePositions(Poses* poses) {
  Poses placed = *poses;
  for (std::size_t i = 0; i < placed.size(); ++i)
    if (system_.row(static_cast<int>(i)) >= 0) placed[i].x = placed[i].y = 0.0;
  system_.linearizeFromRotations(placed, weights, &h_, &b_);
  ++iterations_;
  if (!factorPoses(&h_)) return false;
  h_.solve(&b_);
  *poses = system_.moved(placed, b_);
  return true;
}

bool Descent::initializeChordal(Poses* poses) {
  Poses relaxed = *poses;
  if (!system_.relaxRotations(weights, &relaxed) || !solvePositions(&relaxed)) return false;
  *poses = std::move(relaxed);
  return true;
}

/// The step at `poses`, in b_, and the decrease of the cost that it predicts. False if there is
/// none.
bool Descent::step(const Poses& poses, double damping, double* predicted) {
  system_.linearize(poses, weights, damping, &h_, &b_);
  ++iterations_;
  if (!factorPoses(&h_)) return false;
  *predicted = solve();
  return std::isfinite(*predicted);
}

/// The step of the gradient in b_ by the factor in h_, in b_, and the decrease that it predicts.
double Descent::solve() {
  gradient_ = b_;
  h_.solve(&b_);
  double sum = 0.0;
  for (std::size_t i = 0; i < b_.size(); ++i) {
    const PoseSystem::Vector p = b_[i] * gradient_[i];
    sum += p[0] + p[1] + p[2];
  }
  return sum;
}

/// Steps by the factor of the last one, where few will do: after a step by a factor of its own most
/// often nothing is left to gain. An old factor leaves part of what there is, more in directions
/// that the edges hardly determine: the tolerance is a smaller one. True when it was reached.
bool Descent::finish(int steps, double* cost, Poses* poses) {
  for (int done = 0; done < std::min(steps, kOldFactorSteps); ++done) {
    system_.gradient(*poses, weights, &b_);
    ++iterations_;
    const double gain = solve();
    const bool converged = gain <= kOldFactorTolerance * params_.tolerance * *cost;
    if (!converged && (done + 1 == kOldFactorSteps || gain > params_.tolerance * *cost))
      return false;
    Poses next = system_.moved(*poses, b_);
    const double next_cost = system_.cost(next, weights);
    // Rounding may increase the cost slightly at the minimum.
    if (!(next_cost <= *cost * (1.0 + (converged ? 1e-9 : 0.0)))) return false;
    *poses = std::move(next);
    *cost = next_cost;
    if (converged) return true;
  }
  return false;
}

/// Undamped steps, even where they increase the cost: along a curved valley they climb before they
/// converge, where damped ones would be very small.
bool Descent::takeFullSteps(Poses* poses, int steps) {
  for (int done = 0; done < steps; ++done) {
    double predicted = 0.0;
    if (!step(*poses, 0.0, &predicted)) return false;
    *poses = system_.moved(*poses, b_);
    if (predicted <= params_.tolerance * system_.cost(*poses, weights)) return true;
  }
  return false;
}

bool Descent::descend(Poses* poses, int steps) {
  if (params_.method == GraphMethod::kGaussNewton) return takeFullSteps(poses, steps);
  double cost = system_.cost(*poses, weights), damping = 0.0;
  bool full_steps_tried = false;
  for (int done = 0; done < steps; ++done) {
    double predicted = 0.0;
    if (step(*poses, damping, &predicted)) {
      Poses next = system_.moved(*poses, b_);
      const double next_cost = system_.cost(next, weights);
      const bool converged = predicted <= params_.tolerance * cost;
      // Rounding may increase the cost slightly at the minimum.
      if (next_cost <= cost || (converged && next_cost <= cost * (1.0 + 1e-9))) {
        *poses = std::move(next);
        cost = next_cost;
        if (converged && damping == 0.0) return true;
        if (damping == 0.0 && predicted <= kNearMinimum * cost &&
            finish(steps - done - 1, &cost, poses))
          return true;
        damping = damping > 1e-6 ? damping / 10.0 : 0.0;
        continue;
      }
      if (!full_steps_tried && steps - done > kFullSteps) {
        full_steps_tried = true;
        if (takeFullSteps(&next, kFullSteps) && system_.cost(next, weights) <= cost) {
          *poses = std::move(next);
          return true;
        }
      }
    }
    damping = damping > 0.0 ? damping * 10.0 : 1e-4;
    if (damping > 1e12) return false;
  }
  return false;
}

bool Descent::factorAt(const Poses& poses) {
  system_.linearize(poses, weights, 0.0, &h_, &b_);
  return factorPoses(&h_);
}

double Descent::innovation(const SystemEdge& edge, const Poses& poses) const {
  if (system_.component(edge.from) != system_.component(edge.to))
    return 0.0;  // nothing connects them
  const PoseSystem::Jacobian j = PoseSystem::jacobian(
      edge, poses[static_cast<std::size_t>(edge.from)], poses[static_cast<std::size_t>(edge.to)]);
  const int from = system_.row(edge.from), to = system_.row(edge.to);
  Eigen::Matrix3d graph_covariance = Eigen::Matrix3d::Zero();  // of the error
  std::vector<PoseSystem::Vector> x(static_cast<std::size_t>(system_.rows()));
  for (int c = 0; c < 3; ++c) {
    std::fill(x.begin(), x.end(), PoseSystem::Vector{});
    for (int k = 0; k < 3; ++k) {
      if (from >= 0) x[static_cast<std::size_t>(from)][k] = j.from(c, k);
      if (to >= 0) x[static_cast<std::size_t>(to)][k] = j.to(c, k);
    }
    h_.solve(&x);
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) {
        if (from >= 0)
          graph_covariance(r, c) += j.from(r, k) * x[static_cast<std::size_t>(from)][k];
        if (to >= 0) graph_covariance(r, c) += j.to(r, k) * x[static_cast<std::size_t>(to)][k];
      }
  }
  // e^T (S + W^-1)^-1 e = e^T W (S W + 1)^-1 e, which needs no inverse of W.
  const Eigen::Matrix3d spread = j.information * graph_covariance + Eigen::Matrix3d::Identity();
  return j.error.dot(spread.partialPivLu().solve(j.information * j.error));
}

}  // namespace hyselam_pose_graph
