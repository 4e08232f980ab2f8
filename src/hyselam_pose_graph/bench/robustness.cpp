// False loops among the true ones of M3500 and intel: what each robust mode makes of them. For
// `bench/pose_graphs robust`.
#include <chrono>
#include <iostream>

#include "../test/false_loops.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_pose_graph/g2o_file.hpp"
#include "hyselam_pose_graph/graph_optimizer.hpp"

namespace {

using namespace hyselam_pose_graph;  // NOLINT: a program, not a header

struct Options {
  std::string folder;
  int seeds = 5;
  std::vector<double> shares = {0.0, 0.1, 0.2, 0.5};
};

/// One line per graph, share, seed and mode.
nlohmann::json run(const Options& o) {
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string name : {"M3500", "intel"}) {
    const PoseGraph clean = readG2o(o.folder + "/" + name + ".g2o.gz");
    const OptimizeResult best = GraphOptimizer(clean).optimize();
    const bool truth_known = name == "M3500";
    const std::vector<hyselam::Pose2> truth =
        truth_known ? false_loops::manhattanTruth(clean) : best.poses;
    for (const double share : o.shares)
      for (int seed = 1; seed <= (share > 0.0 ? o.seeds : 1); ++seed) {
        PoseGraph lying = clean;
        false_loops::add(&lying, share, static_cast<std::uint64_t>(seed));
        const GraphOptimizer optimizer(lying);
        for (const auto& [mode, robust] :
             {std::pair{"none", GraphRobust::kNone}, std::pair{"dcs", GraphRobust::kDcs},
              std::pair{"gnc", GraphRobust::kGnc}}) {
          OptimizeParams params;
          params.robust = robust;
          // With full weights of many false loops the system is dense: minutes without a new
          // result.
          if (robust == GraphRobust::kNone && share > 0.1) continue;
          // False loops leave large rotation errors at any minimum.
          if (robust == GraphRobust::kNone && share > 0.0) params.start = GraphStart::kChordal;
          const clock_t begin = clock();
          const OptimizeResult r = optimizer.optimize(params);
          const double ms = 1e3 * static_cast<double>(clock() - begin) / CLOCKS_PER_SEC;
          int false_kept = 0, true_lost = 0;
          for (std::size_t k = 0; k < r.weights.size(); ++k) {
            if (k >= clean.edges.size() && r.weights[k] >= 0.5) ++false_kept;
            if (k < clean.edges.size() && r.weights[k] < 0.5) ++true_lost;
          }
          const double error = false_loops::trajectoryError(r.poses, truth);
          const double clean_error = false_loops::trajectoryError(best.poses, truth);
          nlohmann::json row = {{"graph", name},
                                {"share", share},
                                {"seed", seed},
                                {"mode", mode},
                                {"false_loops", lying.edges.size() - clean.edges.size()},
                                {"false_kept", false_kept},
                                {"true_lost", true_lost},
                                {"from_clean_m", false_loops::trajectoryError(r.poses, best.poses)},
                                {"true_cost_ratio", graphCost(clean, r.poses) / best.final_cost},
                                {"ms", ms}};
          if (truth_known) {
            row["error_m"] = error;
            row["clean_error_m"] = clean_error;
          }

          rows.push_back(row);
        }
      }
  }
  std::cout << rows.dump(1) << "\n";
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Optimises M3500 and intel with false loops added.",
               "hyselam_pose_graph_robustness");
  Options o;
  app.add_option("folder", o.folder, "where M3500.g2o.gz and intel.g2o.gz are")->required();
  app.add_option("--seeds", o.seeds, "graphs per share of false loops")->capture_default_str();
  app.add_option("--shares", o.shares, "false loops per true loop")->delimiter(',');
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
