#include "hyselam_pose_graph/incremental_graph.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "marginals.hpp"

namespace hyselam_pose_graph {

using hyselam::InputError;
using hyselam::Pose2;

IncrementalGraph::IncrementalGraph(const OptimizeParams& params) : params_(params) {
  params_.validate();
  params_.start = GraphStart::kGiven;
}

IncrementalGraph::IncrementalGraph(PoseGraph graph, const OptimizeParams& params)
    : IncrementalGraph(params) {
  graph.validate();
  graph_ = std::move(graph);
  appended_by_.assign(graph_.poses.size(), -1);
  pending_ = !graph_.edges.empty();
}

IncrementalGraph::~IncrementalGraph() = default;
IncrementalGraph::IncrementalGraph(IncrementalGraph&&) noexcept = default;
IncrementalGraph& IncrementalGraph::operator=(IncrementalGraph&&) noexcept = default;

int IncrementalGraph::addPose(const Pose2& pose) {
  if (!pose.isFinite()) throw InputError("pose graph", "new pose", "is not finite");
  std::int64_t id = 0;
  if (!graph_.ids.empty()) id = graph_.ids.back() + 1;
  graph_.ids.push_back(id);
  graph_.poses.push_back(pose);
  appended_by_.push_back(-1);
  return static_cast<int>(graph_.poses.size()) - 1;
}

int IncrementalGraph::append(const Pose2& measured, const Eigen::Matrix3d& information) {
  if (graph_.poses.empty()) throw InputError("pose graph", "", "there is no pose to append to");
  PoseEdge edge;
  edge.from = static_cast<int>(graph_.poses.size()) - 1;
  edge.to = edge.from + 1;
  edge.measured = measured;
  edge.information = information;
  validateEdge(edge, graph_.poses.size() + 1, "odometry");
  addPose(graph_.poses.back() * measured);
  appended_by_.back() = static_cast<int>(graph_.edges.size());
  graph_.edges.push_back(edge);
  return edge.to;
}

void IncrementalGraph::addEdge(const PoseEdge& edge) {
  validateEdge(edge, graph_.poses.size(), "edge");
  graph_.edges.push_back(edge);
  pending_ = true;
}

OptimizeResult IncrementalGraph::optimize() {
  marginals_.reset();  // refers to the system that is replaced
  optimizer_ = optimizer_ ? GraphOptimizer(graph_, *optimizer_) : GraphOptimizer(graph_);
  pattern_analyses_ += optimizer_->reusesPattern() ? 0 : 1;
  OptimizeResult result = optimizer_->optimize(params_);
  if (params_.robust == GraphRobust::kNone) {
    double rotation_error = 0.0;
    for (const PoseEdge& e : graph_.edges) {
      const Pose2 &from = result.poses[static_cast<std::size_t>(e.from)],
                  &to = result.poses[static_cast<std::size_t>(e.to)];
      rotation_error = std::max(rotation_error, std::abs(edgeError(e, from, to)[2]));
    }
    if (rotation_error > params_.max_rotation_error) {
      OptimizeParams again = params_;
      again.start = GraphStart::kBest;
      OptimizeResult other = optimizer_->optimize(again);
      const int iterations = result.iterations + other.iterations;
      if (other.final_cost < result.final_cost) result = std::move(other);
      result.iterations = iterations;
    }
  }
  graph_.poses = result.poses;
  weights_ = result.weights;
  pending_ = false;
  return result;
}

Eigen::Matrix3d IncrementalGraph::covariance(int pose) const {
  if (pose < 0 || pose >= static_cast<int>(graph_.poses.size()))
    throw InputError("covariance", "pose " + std::to_string(pose), "does not exist");
  const int known = optimizer_ ? static_cast<int>(optimizer_->graph().poses.size()) : 0;
  int from = pose;  // the newest pose not after it whose covariance is known
  for (; from > 0 && from >= known; --from)
    if (appended_by_[static_cast<std::size_t>(from)] < 0)
      throw InputError("covariance", "pose " + std::to_string(from), "is not optimized yet");
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of pose 0, which is fixed
  if (from < known) {
    if (!marginals_)
      marginals_ = std::make_unique<Marginals>(*optimizer_->system_, optimizerPoses(), weights_);
    covariance = marginals_->covariance(from);
  }
  while (from < pose) covariance = propagated(covariance, ++from);
  return covariance;
}

/// First-order propagation of the covariance of the previous pose along the edge of odometry.
Eigen::Matrix3d IncrementalGraph::propagated(const Eigen::Matrix3d& before, int pose) const {
  const auto at = static_cast<std::size_t>(pose);
  const PoseEdge& edge = graph_.edges[static_cast<std::size_t>(appended_by_[at])];
  const Pose2 &from = graph_.poses[at - 1], &to = graph_.poses[at];
  const Eigen::LDLT<Eigen::Matrix3d> information(edge.information);
  if (!(information.vectorD().minCoeff() > 0.0))
    throw InputError("pose graph", "", "the edges do not determine the poses");
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity(), rotation = jacobian;
  jacobian(0, 2) = from.y - to.y;
  jacobian(1, 2) = to.x - from.x;
  const double c = std::cos(to.theta), s = std::sin(to.theta);
  rotation.topLeftCorner<2, 2>() << c, -s, s, c;
  return jacobian * before * jacobian.transpose() +
         rotation * information.solve(Eigen::Matrix3d::Identity()) * rotation.transpose();
}

std::vector<Pose2> IncrementalGraph::optimizerPoses() const {
  const auto n = static_cast<std::ptrdiff_t>(optimizer_->graph().poses.size());
  return {graph_.poses.begin(), graph_.poses.begin() + n};
}

}  // namespace hyselam_pose_graph
