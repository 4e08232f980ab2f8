// Maximum-likelihood poses of a pose graph: least squares on SE(2) that needs no initial guess
// (Maffei 2017, 2.1.3.1 and appendix B; chordal initialization: Carlone et al. 2015; global
// relaxation: Rosen et al. 2019).
#pragma once

#include <memory>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_pose_graph/pose_graph.hpp"

namespace hyselam_pose_graph {

class PoseSystem;

/// Initial poses of the descent.
enum class GraphStart {
  kGiven,     ///< at the poses of the graph
  kComposed,  ///< edges chained from the first pose, odometry first (composedPoses())
  kChordal,   ///< rotations first, by one linear system, then positions by another
  /// kGiven if the edges fit there on average as they say, else kChordal; then the global
  /// relaxation if max_rotation_error is exceeded.
  kBest
};

/// Steps of the descent.
enum class GraphMethod {
  kGaussNewton,        ///< as in the thesis: always full steps
  kLevenbergMarquardt  ///< damped only where a full step does not descend
};

/// How false loops are rejected. Odometry edges, those between successive poses
/// of the list (isOdometry), always have full weight.
enum class GraphRobust {
  kNone,
  kDcs,  ///< dynamic covariance scaling (Agarwal et al. 2013): loops lose weight with their error
  kGnc   ///< graduated non-convexity with truncated least squares (Yang et al. 2020)
};

/// Other starts of robust modes, tried where loops lose their weight. A loop that closes after
/// hundreds of meters looks wrong from odometry, however right it is.
enum class FollowLoops {
  kNone,  ///< only the start that is asked for
  kAll,  ///< the poses at which all loops have full weight: of two results the one that agrees with
         ///< more edges. For loops that were verified before
  kBest  ///< those that the loops lead to which confirm one another and, where most loops or the
         ///< odometry are doubtful even so, as kAll: the likeliest result, with odometry that may
         ///< be worse than it says
};

/// Below this weight an edge contradicts the others so much that it is not used.
constexpr double kAgreeingWeight = 0.3;

struct OptimizeParams {
  GraphStart start = GraphStart::kBest;
  GraphMethod method = GraphMethod::kLevenbergMarquardt;
  GraphRobust robust = GraphRobust::kNone;
  int max_iterations = 200;  ///< linear systems solved at most, >= 1
  double tolerance = 1e-6;   ///< stop below this predicted relative decrease of the cost, 0..1
  double dcs_phi = 5.0;      ///< squared error above which DCS reduces the weight, > 0
  /// Squared error that a true edge stays below, > 0 (chi^2 with 3 degrees of freedom, 99.9 %).
  double gnc_inlier_threshold = 16.266;
  FollowLoops follow = FollowLoops::kBest;
  /// kBest: a larger rotation error of an edge at the minimum [rad], > 0, starts the global
  /// relaxation, which takes some twenty times as long.
  double max_rotation_error = 1.0;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

struct OptimizeResult {
  std::vector<hyselam::Pose2> poses;
  double initial_cost = 0.0;    ///< sum of e^T Omega e over all edges, at the graph's poses
  double final_cost = 0.0;      ///< the same at `poses`, without weights
  int iterations = 0;           ///< linear systems solved
  bool converged = false;       ///< the tolerance was reached
  bool global = false;          ///< the poses come from the global relaxation
  std::vector<double> weights;  ///< of each edge, 0..1; empty without robust
  /// Edges that keep at least kAgreeingWeight; all of them without robust.
  std::size_t agreeing_edges = 0;
  bool followed_all = false;  ///< the poses come from those with all loops at full weight
};

/// Optimizes one graph. The sparsity pattern of its linear system is computed by the constructor
/// and used by every optimization.
class GraphOptimizer {
 public:
  /// @throws hyselam::InputError as PoseGraph::validate().
  explicit GraphOptimizer(PoseGraph graph);
  /// The same with the pattern of an earlier optimizer if it contains all edges.
  GraphOptimizer(PoseGraph graph, const GraphOptimizer& earlier);
  ~GraphOptimizer();
  GraphOptimizer(GraphOptimizer&&) noexcept;
  GraphOptimizer& operator=(GraphOptimizer&&) noexcept;

  const PoseGraph& graph() const { return graph_; }
  /// Whether the pattern was taken from the earlier optimizer.
  bool reusesPattern() const;

  /// The first pose of each connected component is fixed (gauge).
  /// @throws hyselam::ParameterError
  OptimizeResult optimize(const OptimizeParams& params = {}) const;

  /// Marginal covariances of (x, y, theta) of the poses `of`, given the first pose of their
  /// component, linearized at `poses`; in the frame of the graph. Zero for a first pose.
  /// `weights`: OptimizeResult::weights; empty: all 1.
  /// @throws hyselam::InputError for an index out of range or vectors of wrong length, and when the
  /// edges do not determine the poses.
  std::vector<Eigen::Matrix3d> covariances(const std::vector<hyselam::Pose2>& poses,
                                           const std::vector<int>& of,
                                           const std::vector<double>& weights = {}) const;

 private:
  friend class IncrementalGraph;
  PoseGraph graph_;
  std::unique_ptr<PoseSystem> system_;
};

}  // namespace hyselam_pose_graph
