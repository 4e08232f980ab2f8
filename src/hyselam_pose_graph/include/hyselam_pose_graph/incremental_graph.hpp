// A pose graph that grows while it is used: what an online SLAM asks of the optimiser.
#pragma once

#include <memory>
#include <optional>

#include "hyselam_pose_graph/graph_optimizer.hpp"

namespace hyselam_pose_graph {

class Marginals;

/// Poses come one by one and cost nothing but their place; a loop is taken in at once and counts
/// from the next optimise() on, which starts where the last one ended. Not to be used by two
/// threads at a time.
class IncrementalGraph {
 public:
  /// `params.start` has no effect. @throws hyselam::ParameterError
  explicit IncrementalGraph(const OptimizeParams& params = {});
  /// Goes on with a graph that is known. @throws as GraphOptimizer does.
  explicit IncrementalGraph(PoseGraph graph, const OptimizeParams& params = {});
  ~IncrementalGraph();
  IncrementalGraph(IncrementalGraph&&) noexcept;
  IncrementalGraph& operator=(IncrementalGraph&&) noexcept;

  /// A pose that nothing ties to the others yet; its index. Its id is one more than that of the
  /// pose before it, 0 for the first.
  int addPose(const hyselam::Pose2& pose);
  /// The pose after the newest one, where odometry has it; `information` as in PoseEdge.
  /// @throws std::invalid_argument without a first pose, and as PoseGraph::validate does; nothing
  /// is changed then.
  int append(const hyselam::Pose2& measured, const Eigen::Matrix3d& information);
  /// Any other edge. @throws std::invalid_argument as PoseGraph::validate does.
  void addEdge(const PoseEdge& edge);

  /// With the poses as they are estimated now.
  const PoseGraph& graph() const { return graph_; }
  /// There are edges that poses do not know of yet: optimise() is worth while.
  bool pending() const { return pending_; }

  /// Descends from the poses as they are. Where an edge is turned far at the end
  /// (OptimizeParams::doubtful_turn; without robust only) all is solved anew, as without a guess.
  OptimizeResult optimise();
  /// Covariance of (x, y, theta) of a pose given the first one, in the frame of the graph, as of
  /// the last optimise(); poses appended since then add their odometry's. The first one asked for
  /// after optimise() costs a factorisation, the others little: a pose of the graph optimised last
  /// a way up the tree of elimination, one appended since a product for each pose in between.
  /// @throws std::invalid_argument for a pose that is not there or was not tied to a pose before it
  /// by append() since the last optimise(); std::runtime_error when edges do not determine poses.
  Eigen::Matrix3d covariance(int pose) const;

  /// How often the pattern of the linear system was worked out, of all optimisations.
  int analyses() const { return analyses_; }

 private:
  std::vector<hyselam::Pose2> optimizerPoses() const;
  Eigen::Matrix3d carriedOver(const Eigen::Matrix3d& before, int pose) const;

  OptimizeParams params_;
  PoseGraph graph_;
  std::optional<GraphOptimizer> optimizer_;
  std::vector<double> weights_;   ///< of the last optimisation
  std::vector<int> appended_by_;  ///< edge that append() made for each pose; -1
  mutable std::unique_ptr<Marginals> marginals_;
  bool pending_ = false;
  int analyses_ = 0;
};

}  // namespace hyselam_pose_graph
