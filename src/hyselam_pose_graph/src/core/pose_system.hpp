// The normal equations of a pose graph; which edge contributes to which block is computed once.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "graph_blocks.hpp"
#include "hyselam_pose_graph/cholesky_pattern.hpp"
#include "hyselam_pose_graph/pose_graph.hpp"

namespace hyselam_pose_graph {

/// The upper triangle of a symmetric 3x3 matrix of (x, y, theta).
struct PlanarInformation {
  double xx, xy, yy, xt, yt, tt;
};

/// An edge with the constant parts of its error. Rotating the error by the measured angle gives
/// e = (R_i^T (t_j - t_i) - t_z, wrap(theta_j - theta_i - theta_z)) with the information rotated
/// too.
struct SystemEdge {
  int from, to;
  int block = -1;         ///< entry that couples the two; -1 if one of them is fixed
  bool from_row = false;  ///< that entry holds H(from, to), not H(to, from)
  double x, y, theta;     ///< as measured
  double c, s;            ///< cosine and sine of theta
  PlanarInformation w;    ///< rotated
};

/// |c|, not by std::abs: hypot's last digit is not the same on amd64 and on arm64.
inline double magnitude(const std::complex<double>& c) {
  return std::sqrt(std::norm(c));
}

/// A pose with its sine and cosine.
struct SystemPose {
  double x, y, theta, c, s;
};

class PoseSystem {
 public:
  using Vector = Block3::Vector;

  /// Fixes the first pose of each connected component (gauge). The pattern of `earlier` is used if
  /// it contains all edges.
  explicit PoseSystem(const PoseGraph& graph, const PoseSystem* earlier = nullptr);
  /// Whether the pattern is that of an earlier system.
  bool reusesPattern() const { return reuses_pattern_; }

  const CholeskyPattern& pattern() const { return pattern_; }
  const std::vector<SystemEdge>& edges() const { return edges_; }
  /// Row of a pose among the unknowns; -1 for a fixed one.
  int row(int pose) const { return row_[static_cast<std::size_t>(pose)]; }
  int rows() const { return pattern_.size; }
  /// The connected component of a pose.
  int component(int pose) const { return component_[static_cast<std::size_t>(pose)]; }

  static std::vector<SystemPose> system(const std::vector<hyselam::Pose2>& poses);
  static std::vector<hyselam::Pose2> poses(const std::vector<SystemPose>& poses);

  /// Sum of weight_i e^T Omega e; `weights` empty: all 1.
  double cost(const std::vector<SystemPose>& poses, const std::vector<double>& weights) const;
  /// Errors squared by information, edge by edge.
  void edgeCosts(const std::vector<SystemPose>& poses, std::vector<double>* costs) const;
  /// The same of the rotations alone.
  void rotationCosts(const std::vector<SystemPose>& poses, std::vector<double>* costs) const;
  /// Error of an edge, turned as SystemEdge has it, and its derivatives by the two poses.
  struct Jacobian {
    Eigen::Vector3d error;
    Eigen::Matrix3d from, to, information;
  };
  static Jacobian jacobian(const SystemEdge& edge, const SystemPose& from, const SystemPose& to);

  /// H = J^T Omega J + damping diag(H), b = -J^T Omega e at `poses`.
  void linearize(const std::vector<SystemPose>& poses, const std::vector<double>& weights,
                 double damping, BlockCholesky<Block3>* h, std::vector<Vector>* b) const;
  /// That b alone.
  void gradient(const std::vector<SystemPose>& poses, const std::vector<double>& weights,
                std::vector<Vector>* b) const;
  /// H and b with unknown positions, and rotations near those of `poses`; the positions of `poses`
  /// are used for fixed poses only.
  void linearizeFromRotations(const std::vector<SystemPose>& poses,
                              const std::vector<double>& weights, BlockCholesky<Block3>* h,
                              std::vector<Vector>* b) const;
  /// poses + x.
  std::vector<SystemPose> moved(const std::vector<SystemPose>& poses,
                                const std::vector<Vector>& x) const;

  /// Chordal relaxation: rotations as unconstrained complex numbers that fit the measured ones best
  /// (one linear system). Fixed poses keep theirs. False if the measurements do not determine them.
  bool relaxRotations(const std::vector<double>& weights, std::vector<SystemPose>* poses) const;

  /// The largest rotation error of an edge, 0..pi [rad].
  double maxRotationError(const std::vector<SystemPose>& poses) const;

 private:
  template <bool kFromRotations>
  void fill(const std::vector<SystemPose>& poses, const std::vector<double>& weights,
            BlockCholesky<Block3>* h, std::vector<Vector>* b) const;

  std::vector<int> row_;
  std::vector<int> component_;
  std::vector<int> diagonal_;  ///< entry of each row's diagonal block
  std::vector<SystemEdge> edges_;
  CholeskyPattern pattern_;
  bool reuses_pattern_ = false;
};

}  // namespace hyselam_pose_graph
