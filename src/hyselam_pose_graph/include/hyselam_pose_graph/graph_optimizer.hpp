// The most likely poses of a pose graph: least squares on SE(2) from a start that needs no guess
// (Maffei 2017, 2.1.3.1 and appendix B, and what was learnt since).
#pragma once

#include <memory>
#include <vector>

#include "hyselam_pose_graph/pose_graph.hpp"

namespace hyselam_pose_graph {

class PoseSystem;

/// Where the descent begins.
enum class GraphStart {
  kGiven,     ///< at the poses of the graph
  kComposed,  ///< at composedPoses()
  kChordal,   ///< rotations first, by one linear system, then positions by another
  kBest       ///< kChordal; where the minimum found is doubtful, the global relaxation too
};

/// How the descent goes on.
enum class GraphMethod {
  kGaussNewton,        ///< as in the thesis: full steps, wherever they lead
  kLevenbergMarquardt  ///< undamped as long as that descends, damped when it does not
};

/// What is done about edges that contradict the others. Odometry (isOdometry) is always believed.
enum class GraphRobust {
  kNone,
  kDcs,  ///< dynamic covariance scaling (Agarwal et al. 2013): loops lose weight with their error
  kGnc   ///< graduated non-convexity with truncated least squares (Yang et al. 2020)
};

struct OptimizeParams {
  GraphStart start = GraphStart::kBest;
  GraphMethod method = GraphMethod::kLevenbergMarquardt;
  GraphRobust robust = GraphRobust::kNone;
  int max_iterations = 200;    ///< linear systems solved at most, >= 1
  double tolerance = 1e-6;     ///< stop when a step promises less than this part of the cost, > 0
  double dcs_phi = 5.0;        ///< squared error from which DCS takes weight, > 0
  double gnc_inlier = 16.266;  ///< squared error that a true edge keeps below, > 0 (chi^2, 99.9 %)
  /// kBest: an edge that is turned by more than this at the minimum [rad, > 0] makes it doubtful
  /// and asks for the global relaxation, which takes some hundred times as long.
  double doubtful_turn = 1.0;
  /// @throws hyselam::ParameterError
  void validate() const;
};

struct OptimizeResult {
  std::vector<hyselam::Pose2> poses;
  double initial_cost = 0.0;    ///< of the graph's poses, sum of e^T Omega e over all edges
  double final_cost = 0.0;      ///< the same of `poses`, weights not counted
  int iterations = 0;           ///< linear systems of poses solved
  bool converged = false;       ///< the tolerance was reached
  bool global = false;          ///< the poses come from the global relaxation
  std::vector<double> weights;  ///< of each edge, 0..1; empty without robust
};

/// Optimises one graph. The pattern of its linear system is worked out when it is made and used for
/// each optimisation after that, whatever the measurements and poses have become.
class GraphOptimizer {
 public:
  /// @throws std::invalid_argument as PoseGraph::validate does.
  explicit GraphOptimizer(PoseGraph graph);
  /// The same with the pattern of an earlier optimiser, where all edges fit into it.
  GraphOptimizer(PoseGraph graph, const GraphOptimizer& earlier);
  ~GraphOptimizer();
  GraphOptimizer(GraphOptimizer&&) noexcept;
  GraphOptimizer& operator=(GraphOptimizer&&) noexcept;

  const PoseGraph& graph() const { return graph_; }
  /// The pattern was taken from an earlier optimiser.
  bool reusesPattern() const;

  /// The first pose of each connected part stays where it is.
  /// @throws hyselam::ParameterError
  OptimizeResult optimize(const OptimizeParams& params = {}) const;

  /// Covariance of (x, y, theta) of some poses, given the first of their part, at `poses`; in the
  /// frame of the graph. Zero for a first pose. `weights`: as optimize() tells them; none: all 1.
  /// @throws std::invalid_argument for an index out of range, std::runtime_error when the edges do
  /// not determine the poses.
  std::vector<Eigen::Matrix3d> covariances(const std::vector<hyselam::Pose2>& poses,
                                           const std::vector<int>& of,
                                           const std::vector<double>& weights = {}) const;

 private:
  friend class IncrementalGraph;
  PoseGraph graph_;
  std::unique_ptr<PoseSystem> system_;
};

}  // namespace hyselam_pose_graph
