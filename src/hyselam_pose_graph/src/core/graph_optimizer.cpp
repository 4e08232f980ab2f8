#include "hyselam_pose_graph/graph_optimizer.hpp"

#include "hyselam_common/errors.hpp"
#include "marginals.hpp"
#include "pose_system.hpp"
#include "robust_solution.hpp"
#include "solution.hpp"

namespace hyselam_pose_graph {

using hyselam::InputError;
using hyselam::Range;

void OptimizeParams::describe(hyselam::ParameterVisitor& visit) {
  visit("start", start,
        {{"given", GraphStart::kGiven},
         {"composed", GraphStart::kComposed},
         {"chordal", GraphStart::kChordal},
         {"best", GraphStart::kBest}},
        "initial poses");
  visit("method", method,
        {{"gauss-newton", GraphMethod::kGaussNewton},
         {"levenberg-marquardt", GraphMethod::kLevenbergMarquardt}},
        "steps of the descent");
  visit("robust", robust,
        {{"none", GraphRobust::kNone}, {"dcs", GraphRobust::kDcs}, {"gnc", GraphRobust::kGnc}},
        "how false loops are rejected");
  visit("max_iterations", max_iterations, Range::atLeast(1), "", "linear systems solved at most");
  visit("tolerance", tolerance, Range::inside(0.0, 1.0), "",
        "stop below this predicted relative decrease of the cost");
  visit("dcs_phi", dcs_phi, Range::above(0.0), "",
        "squared error above which DCS reduces the weight");
  visit("gnc_inlier_threshold", gnc_inlier_threshold, Range::above(0.0), "",
        "squared error that a true edge stays below");
  visit("follow", follow,
        {{"none", FollowLoops::kNone}, {"all", FollowLoops::kAll}, {"best", FollowLoops::kBest}},
        "which loops robust modes follow at full weight to get other starts");
  visit("max_rotation_error", max_rotation_error, Range::above(0.0), "rad",
        "rotation error at the minimum above which the global relaxation starts");
}

void OptimizeParams::validate() const {
  hyselam::checkParameters(*this);
}

GraphOptimizer::GraphOptimizer(PoseGraph graph) : graph_(std::move(graph)) {
  graph_.validate();
  system_ = std::make_unique<PoseSystem>(graph_);
}
GraphOptimizer::GraphOptimizer(PoseGraph graph, const GraphOptimizer& earlier)
    : graph_(std::move(graph)) {
  graph_.validate();
  system_ = std::make_unique<PoseSystem>(graph_, earlier.system_.get());
}
GraphOptimizer::~GraphOptimizer() = default;
GraphOptimizer::GraphOptimizer(GraphOptimizer&&) noexcept = default;
GraphOptimizer& GraphOptimizer::operator=(GraphOptimizer&&) noexcept = default;

bool GraphOptimizer::reusesPattern() const {
  return system_->reusesPattern();
}

OptimizeResult GraphOptimizer::optimize(const OptimizeParams& params) const {
  params.validate();
  OptimizeResult result;
  if (params.robust == GraphRobust::kNone) {
    result = solveGraph(graph_, *system_, params, graph_.poses);
    result.agreeing_edges = graph_.edges.size();
  } else {
    result = solveRobust(graph_, *system_, params);
  }
  result.initial_cost = system_->cost(PoseSystem::system(graph_.poses), {});
  result.final_cost = system_->cost(PoseSystem::system(result.poses), {});
  return result;
}

std::vector<Eigen::Matrix3d> GraphOptimizer::covariances(const std::vector<hyselam::Pose2>& poses,
                                                         const std::vector<int>& of,
                                                         const std::vector<double>& weights) const {
  if (poses.size() != graph_.poses.size())
    throw InputError("covariances", "poses", "are not as many as the graph has");
  if (!weights.empty() && weights.size() != graph_.edges.size())
    throw InputError("covariances", "weights", "are not as many as the graph has edges");
  const Marginals marginals(*system_, poses, weights);
  std::vector<Eigen::Matrix3d> result;
  result.reserve(of.size());
  for (const int pose : of) result.push_back(marginals.covariance(pose));
  return result;
}

}  // namespace hyselam_pose_graph
