// optimize_graph: the most likely poses of a g2o graph of the plane.
#include <chrono>
#include <iostream>
#include <map>

#include "hyselam_common/tool.hpp"
#include "hyselam_pose_graph/g2o_file.hpp"
#include "hyselam_pose_graph/graph_optimizer.hpp"

namespace {

using namespace hyselam_pose_graph;  // NOLINT: a program, not a header

/// Edges of less weight are counted as refused; more than those that are not used any more at all,
/// which begin at kAgreeingWeight.
constexpr double kRefusedWeight = 0.5;

struct Options {
  std::string in, out;
  OptimizeParams params;
};

nlohmann::json run(const Options& o) {
  PoseGraph graph = readG2o(o.in);
  const std::size_t vertices = graph.poses.size(), edges = graph.edges.size();
  const auto begin = std::chrono::steady_clock::now();
  const GraphOptimizer optimizer(std::move(graph));
  const OptimizeResult result = optimizer.optimize(o.params);
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
  PoseGraph solved = optimizer.graph();
  solved.poses = result.poses;
  writeG2o(o.out, solved);
  nlohmann::json j = {{"vertices", vertices},
                      {"edges", edges},
                      {"initial_cost", result.initial_cost},
                      {"final_cost", result.final_cost},
                      {"iterations", result.iterations},
                      {"converged", result.converged},
                      {"global_relaxation", result.global},
                      {"solve_ms", time.count()}};
  if (!result.weights.empty()) {
    int refused = 0;
    for (const double w : result.weights) refused += w < kRefusedWeight ? 1 : 0;
    j["refused_edges"] = refused;
    j["followed_all"] = result.followed_all;
  }
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Finds the most likely poses of a graph of the plane (VERTEX_SE2, EDGE_SE2; plain or gzip). "
      "The "
      "first pose of each connected part stays where it is.",
      "optimize_graph");
  Options o;
  app.add_option("in", o.in, "graph to read (.g2o, .g2o.gz)")->required();
  app.add_option("out", o.out, "file for the graph with its new poses")->required();
  const std::map<std::string, GraphRobust> robust = {
      {"none", GraphRobust::kNone}, {"dcs", GraphRobust::kDcs}, {"gnc", GraphRobust::kGnc}};
  app.add_option("--robust", o.params.robust,
                 "against false loops: none, dcs (dynamic covariance scaling), gnc (graduated "
                 "non-convexity)")
      ->transform(CLI::CheckedTransformer(robust))
      ->default_str("none");
  const std::map<std::string, FollowLoops> follow = {
      {"none", FollowLoops::kNone}, {"all", FollowLoops::kAll}, {"best", FollowLoops::kBest}};
  app.add_option("--follow", o.params.follow,
                 "other starts of --robust, where loops lose their weight: none, all (all loops at "
                 "full weight first; for verified ones), best (first those that confirm one "
                 "another; the likeliest result)")
      ->transform(CLI::CheckedTransformer(follow))
      ->default_str("best");
  const std::map<std::string, GraphStart> start = {{"given", GraphStart::kGiven},
                                                   {"composed", GraphStart::kComposed},
                                                   {"chordal", GraphStart::kChordal},
                                                   {"best", GraphStart::kBest}};
  app.add_option(
         "--start", o.params.start,
         "given (the file's poses), composed (along the edges), chordal (rotations first), "
         "best (given where the edges fit, else chordal; and the global relaxation where that is "
         "doubtful)")
      ->transform(CLI::CheckedTransformer(start))
      ->default_str("best");
  const std::map<std::string, GraphMethod> method = {
      {"gauss-newton", GraphMethod::kGaussNewton},
      {"levenberg-marquardt", GraphMethod::kLevenbergMarquardt}};
  app.add_option("--method", o.params.method, "gauss-newton (full steps), levenberg-marquardt")
      ->transform(CLI::CheckedTransformer(method))
      ->default_str("levenberg-marquardt");
  app.add_option("--max-iterations", o.params.max_iterations, "linear systems solved at most")
      ->capture_default_str();
  app.add_option("--tolerance", o.params.tolerance,
                 "stop when a step promises less than this part of the cost")
      ->capture_default_str();
  app.add_option("--gnc-inlier", o.params.gnc_inlier_threshold,
                 "squared error that true edges stay below")
      ->capture_default_str();
  app.add_option("--dcs-phi", o.params.dcs_phi, "squared error from which DCS takes weight")
      ->capture_default_str();
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
