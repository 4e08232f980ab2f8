// Weight of an edge by its squared error: DCS and GNC.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace hyselam_pose_graph {

/// Agarwal et al. 2013: the switch s = min(1, 2 phi / (phi + chi^2)) scales the error, s^2 the
/// information.
inline double dcsWeight(double squared, double phi) {
  const double s = std::min(1.0, 2.0 * phi / (phi + squared));
  return s * s;
}

/// Yang et al. 2020, Eq. 14: weights of truncated least squares made less truncated by mu. `limit`
/// is the squared error that a true edge may have.
inline double gncWeight(double squared, double limit, double mu) {
  if (squared >= (mu + 1.0) / mu * limit) return 0.0;
  if (squared <= mu / (mu + 1.0) * limit) return 1.0;
  return std::sqrt(limit * mu * (mu + 1.0) / squared) - mu;
}

/// The mu at which the costs are convex up to the largest squared error (Remark 5 there); negative
/// when no edge is an outlier.
inline double gncFirstMu(double largest_squared, double limit) {
  return limit / (2.0 * largest_squared - limit);
}

}  // namespace hyselam_pose_graph
