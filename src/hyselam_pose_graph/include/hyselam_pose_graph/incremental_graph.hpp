// A pose graph that grows while it is used: a back end for online SLAM with covariances at any
// time. ngram_slam does not use it: it optimizes copies of its graph on another thread
// (GraphOptimizer).
#pragma once

#include <memory>
#include <optional>

#include "hyselam_pose_graph/graph_optimizer.hpp"

namespace hyselam_pose_graph {

class Marginals;

/// Appending a pose costs no linear algebra; a loop takes effect at the next optimize(), which
/// starts from the present poses. Not thread-safe.
class IncrementalGraph {
 public:
  /// `params.start` has no effect. @throws hyselam::ParameterError
  explicit IncrementalGraph(const OptimizeParams& params = {});
  /// Continues with a known graph. @throws hyselam::InputError as PoseGraph::validate().
  explicit IncrementalGraph(PoseGraph graph, const OptimizeParams& params = {});
  ~IncrementalGraph();
  IncrementalGraph(IncrementalGraph&&) noexcept;
  IncrementalGraph& operator=(IncrementalGraph&&) noexcept;

  /// Adds a pose without edges and returns its index. Its id is one more than that of the previous
  /// pose, 0 for the first. @throws hyselam::InputError if it is not finite.
  int addPose(const hyselam::Pose2& pose);
  /// Adds the pose at `measured` from the newest one with an edge of odometry, and returns its
  /// index; `information` as in PoseEdge.
  /// @throws hyselam::InputError without a first pose, and as PoseGraph::validate(); the graph is
  /// unchanged then.
  int append(const hyselam::Pose2& measured, const Eigen::Matrix3d& information);
  /// Adds any other edge. @throws hyselam::InputError as PoseGraph::validate().
  void addEdge(const PoseEdge& edge);

  /// The graph at the present estimate.
  const PoseGraph& graph() const { return graph_; }
  /// Whether edges were added since the last optimize().
  bool pending() const { return pending_; }

  /// Descends from the present poses. Without robust: if the rotation error of an edge exceeds
  /// OptimizeParams::max_rotation_error at the minimum, solves again from GraphStart::kBest.
  OptimizeResult optimize();
  /// Marginal covariance of (x, y, theta) of a pose given the first one, in the frame of the graph,
  /// at the last optimize(); for poses appended since, that of odometry is added. The first call
  /// after optimize() factorizes; further calls cost a path of the elimination tree for a pose of
  /// the optimized graph, a product per pose for those appended since.
  /// @throws hyselam::InputError for a pose that does not exist or was not added by append() since
  /// the last optimize(), and when the edges do not determine the poses.
  Eigen::Matrix3d covariance(int pose) const;

  /// How often the sparsity pattern was computed, in all optimizations.
  int patternAnalyses() const { return pattern_analyses_; }

 private:
  std::vector<hyselam::Pose2> optimizerPoses() const;
  Eigen::Matrix3d propagated(const Eigen::Matrix3d& before, int pose) const;

  OptimizeParams params_;
  PoseGraph graph_;
  std::optional<GraphOptimizer> optimizer_;
  std::vector<double> weights_;   ///< of the last optimization
  std::vector<int> appended_by_;  ///< edge made by append() for each pose; -1: none
  mutable std::unique_ptr<Marginals> marginals_;
  bool pending_ = false;
  int pattern_analyses_ = 0;
};

}  // namespace hyselam_pose_graph
