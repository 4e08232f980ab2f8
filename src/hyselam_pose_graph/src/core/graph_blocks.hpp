// The dense blocks of a pose graph's linear systems: 3x3 for poses, complex numbers for rotations.
#pragma once

#include <cmath>
#include <complex>

#include "hyselam_pose_graph/block_cholesky.hpp"

namespace hyselam_pose_graph {

/// Real 3x3 in columns of four, the last one of each being zero: a column is a register of AVX, or
/// two of SSE2 and NEON. (The vector types of GCC and clang; they need no instruction set.)
struct Block3 {
  typedef double Vector __attribute__((vector_size(32)));
  /// Code compiled for AVX would take a Vector to be aligned to 32 bytes, and all other code
  /// allocates them aligned to 16.
  typedef double Column __attribute__((vector_size(32), aligned(16)));
  Column column[3];

  static Block3 zero() { return {}; }
  void subtractProduct(const Block3& a, const Block3& b) {
    for (int j = 0; j < 3; ++j)
      column[j] -= a.column[0] * b.column[0][j] + a.column[1] * b.column[1][j] +
                   a.column[2] * b.column[2][j];
  }
  bool factor() {
    double l[3][3];
    for (int j = 0; j < 3; ++j) {
      double d = column[j][j];
      for (int k = 0; k < j; ++k) d -= l[j][k] * l[j][k];
      if (!(d > 0.0) || !std::isfinite(d)) return false;
      l[j][j] = std::sqrt(d);
      for (int i = j + 1; i < 3; ++i) {
        double v = column[j][i];
        for (int k = 0; k < j; ++k) v -= l[i][k] * l[j][k];
        l[i][j] = v / l[j][j];
      }
    }
    column[0] = Vector{l[0][0], l[1][0], l[2][0], 0.0};
    column[1] = Vector{0.0, l[1][1], l[2][1], 0.0};
    column[2] = Vector{0.0, 0.0, l[2][2], 0.0};
    return true;
  }
  void solveRight(const Block3& l) {
    column[0] *= 1.0 / l.column[0][0];
    column[1] = (column[1] - column[0] * l.column[0][1]) * (1.0 / l.column[1][1]);
    column[2] = (column[2] - column[0] * l.column[0][2] - column[1] * l.column[1][2]) *
                (1.0 / l.column[2][2]);
  }
  void solveLower(Vector& v) const {
    v[0] /= column[0][0];
    v[1] = (v[1] - column[0][1] * v[0]) / column[1][1];
    v[2] = (v[2] - column[0][2] * v[0] - column[1][2] * v[1]) / column[2][2];
  }
  void solveUpper(Vector& v) const {
    v[2] /= column[2][2];
    v[1] = (v[1] - column[1][2] * v[2]) / column[1][1];
    v[0] = (v[0] - column[0][1] * v[1] - column[0][2] * v[2]) / column[0][0];
  }
  void subtractTimes(const Vector& x, Vector& y) const {
    y -= column[0] * x[0] + column[1] * x[1] + column[2] * x[2];
  }
  void subtractAdjointTimes(const Vector& x, Vector& y) const {
    for (int j = 0; j < 3; ++j)
      y[j] -= column[j][0] * x[0] + column[j][1] * x[1] + column[j][2] * x[2];
  }
};

/// A complex number: rotations of the plane, which commute, as 1x1.
struct BlockComplex {
  using Vector = std::complex<double>;
  Vector value;

  static Vector times(const Vector& a, const Vector& b) {  // std's cares for infinities
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
  }
  static BlockComplex zero() { return {}; }
  void subtractProduct(const BlockComplex& a, const BlockComplex& b) {
    value -= times(a.value, std::conj(b.value));
  }
  bool factor() {
    const double d = value.real();
    if (!(d > 0.0) || !std::isfinite(d)) return false;
    value = std::sqrt(d);
    return true;
  }
  void solveRight(const BlockComplex& l) { value /= l.value.real(); }
  void solveLower(Vector& v) const { v /= value.real(); }
  void solveUpper(Vector& v) const { v /= value.real(); }
  void subtractTimes(const Vector& x, Vector& y) const { y -= times(value, x); }
  void subtractAdjointTimes(const Vector& x, Vector& y) const { y -= times(std::conj(value), x); }
};

/// BlockCholesky::factor, compiled also for processors with AVX2 and chosen when the program
/// starts. Without FMA: the result is the same bytes on all of them.
bool factorPoses(BlockCholesky<Block3>* matrix);

}  // namespace hyselam_pose_graph
