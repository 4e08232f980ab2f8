// Points and vectors in space, and covariances of them.
#pragma once

#include <array>

namespace hyselam {

/// [m], or a direction of length 1.
struct Point3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

/// Row-major, symmetric, positive semidefinite.
using Covariance2 = std::array<double, 4>;
using Covariance3 = std::array<double, 9>;

}  // namespace hyselam
