// Every published graph by us and by the peers that are there: GTSAM and g2o in the Python that
// HYSELAM_PEER_PYTHON names (default: python3), Ceres if the program was built with it. The
// baseline of our time is the fastest peer that reaches the lowest cost known.
#include <benchmark/benchmark.h>
#include <stdio.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "../test/published_graphs.hpp"
#include "hyselam_pose_graph/g2o_file.hpp"
#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "hyselam_pose_graph/incremental_graph.hpp"
#include "peer.hpp"

namespace {

using namespace pose_graph_bench;    // NOLINT: a bench, not a header
using namespace hyselam_pose_graph;  // NOLINT
using published_graphs::Published;

/// Where the graphs are: in $HYSELAM_DATA, else where they were when this was configured.
std::string folder() {
  const char* data = getenv("HYSELAM_DATA");
  return std::string(data != nullptr ? data : HYSELAM_DEFAULT_DATA) + "/posegraphs/";
}

std::string path(const Published& graph) {
  return folder() + graph.name + ".g2o.gz";
}

/// The runs of one Python peer on one graph.
std::vector<PeerRun> runScript(const std::string& peer, const Published& graph) {
  const char* python = getenv("HYSELAM_PEER_PYTHON");
  const std::string command = std::string("'") + (python != nullptr ? python : "python3") +
                              "' '" POSE_GRAPH_PEERS "' '" + path(graph) + "' --peer " + peer +
                              " --best " + std::to_string(graph.cost) + " 2>/dev/null";
  std::string text;
  FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  char buffer[4096];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  pclose(pipe);
  const auto none = [&](const std::string& why) {
    PeerRun run;
    run.failed = why;
    return std::vector<PeerRun>{run};
  };
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) return none("crashed");
  if (json.at(peer).is_string()) return none(json.at(peer).get<std::string>());
  std::vector<PeerRun> runs;
  for (const auto& entry : json.at(peer)) {
    PeerRun run;
    run.setting = entry.at("setting").get<std::string>();
    run.failed = entry.value("failed", std::string());
    if (run.failed.empty()) {
      run.seconds = entry.at("seconds").get<double>();
      run.iterations = entry.at("iterations").get<int>();
      // JSON has no infinity: a diverged solution may come as null.
      run.cost = entry.at("cost").is_number() ? entry.at("cost").get<double>() : HUGE_VAL;
    }
    runs.push_back(run);
  }
  return runs;
}

bool reached(const PeerRun& run, const Published& graph) {
  return run.failed.empty() && run.cost <= published_graphs::kReached * graph.cost;
}

/// The best of a peer's settings: the fastest that reaches the lowest cost, else the lowest cost.
const PeerRun& best(const std::vector<PeerRun>& runs, const Published& graph) {
  const PeerRun* chosen = &runs.front();
  for (const PeerRun& run : runs) {
    if (!run.failed.empty()) continue;
    const bool better = reached(run, graph) != reached(*chosen, graph) ? reached(run, graph)
                        : reached(run, graph) ? run.seconds < chosen->seconds
                                              : !chosen->failed.empty() || run.cost < chosen->cost;
    if (better) chosen = &run;
  }
  return *chosen;
}

constexpr const char* kPeers[] = {"gtsam", "g2o", "ceres"};

/// Measured once per program: repetitions of a benchmark find it here.
const PeerRun& peerOn(const std::string& peer, const Published& graph) {
  static std::map<std::string, PeerRun> known;
  const std::string key = peer + "/" + graph.name;
  const auto it = known.find(key);
  if (it != known.end()) return it->second;
  std::vector<PeerRun> runs =
      peer == "ceres" ? runCeres(readG2o(path(graph))) : runScript(peer, graph);
  if (runs.empty()) {
    runs.emplace_back();
    runs.back().failed = "not installed when this program was built";
  }
  return known.emplace(key, best(runs, graph)).first->second;
}

std::string benchmarkName(const Published& graph, const std::string& who) {
  return std::string("pose_graph/") + graph.name + "/" + who;
}

void addCounters(benchmark::State& state, const Published& graph, double cost, int iterations) {
  state.counters["cost"] = cost;
  // Rounding alone is no excess.
  const double excess = 100.0 * (cost / graph.cost - 1.0);
  state.counters["above_best_percent"] = excess < 1e-4 ? 0.0 : excess;
  state.counters["steps"] = iterations;  // "iterations" is the library's own
}

void runPeer(benchmark::State& state, const Published& graph, const std::string& peer) {
  const PeerRun& run = peerOn(peer, graph);
  for (auto _ : state) state.SetIterationTime(run.seconds);
  if (!run.failed.empty()) {
    state.SetLabel("skipped=" + run.failed);
    return;
  }
  addCounters(state, graph, run.cost, run.iterations);
  state.SetLabel(run.setting + (reached(run, graph) ? "" : ", ends elsewhere"));
}

void runOurs(benchmark::State& state, const Published& graph) {
  const PoseGraph read = readG2o(path(graph));
  double cost = 0.0;
  int iterations = 0;
  for (auto _ : state) {
    const OptimizeResult result = GraphOptimizer(read).optimize();
    cost = result.final_cost;
    iterations = result.iterations;
  }
  addCounters(state, graph, cost, iterations);
  std::optional<std::string> baseline;
  double seconds = 0.0;
  for (const std::string peer : kPeers) {
    const PeerRun& run = peerOn(peer, graph);
    if (!reached(run, graph) || (baseline && run.seconds >= seconds)) continue;
    baseline = benchmarkName(graph, peer) + "/iterations:1/manual_time";
    seconds = run.seconds;
  }
  if (baseline) state.SetLabel("baseline=" + *baseline);
}

// ---- a graph that grows: M3500 without its last loop

struct Growing {
  IncrementalGraph graph;
  PoseEdge loop;
};

Growing almostWhole() {
  PoseGraph whole = readG2o(folder() + "M3500.g2o.gz");
  whole.poses = GraphOptimizer(whole).optimize().poses;
  Growing g{IncrementalGraph{}, whole.edges.back()};
  whole.edges.pop_back();
  g.graph = IncrementalGraph(std::move(whole));
  g.graph.optimize();
  return g;
}

void appendPose(benchmark::State& state) {
  Growing g = almostWhole();
  for (auto _ : state) g.graph.append({1.0, 0.0, 0.0}, Eigen::Matrix3d::Identity());
}

void takeLoop(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    Growing g = almostWhole();
    state.ResumeTiming();
    g.graph.addEdge(g.loop);
    benchmark::DoNotOptimize(g.graph.optimize());
  }
  state.SetLabel("baseline=pose_graph_incremental/batch");
}

void solveBatch(benchmark::State& state) {
  const PoseGraph whole = readG2o(folder() + "M3500.g2o.gz");
  for (auto _ : state) benchmark::DoNotOptimize(GraphOptimizer(whole).optimize());
}

void oneCovariance(benchmark::State& state) {
  Growing g = almostWhole();
  g.graph.covariance(1);  // the factorisation
  const int n = static_cast<int>(g.graph.graph().poses.size());
  int i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(g.graph.covariance(i = (i + 619) % n));
}

[[maybe_unused]] const bool registered = [] {
  if (!std::filesystem::is_directory(folder())) {
    benchmark::RegisterBenchmark("pose_graph", [](benchmark::State& state) {
      for (auto _ : state) {
      }
      state.SetLabel("skipped=no data: set HYSELAM_DATA");
    });
    return true;
  }
  const std::string growing = "pose_graph_incremental/";
  benchmark::RegisterBenchmark((growing + "batch").c_str(), solveBatch)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark((growing + "append").c_str(), appendPose)
      ->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark((growing + "loop").c_str(), takeLoop)
      ->Unit(benchmark::kMillisecond)
      ->Iterations(20);
  benchmark::RegisterBenchmark((growing + "covariance").c_str(), oneCovariance)
      ->Unit(benchmark::kMicrosecond);
  for (const Published& graph : published_graphs::kGraphs) {
    for (const std::string peer : kPeers)
      benchmark::RegisterBenchmark(
          benchmarkName(graph, peer).c_str(),
          [&graph, peer](benchmark::State& state) { runPeer(state, graph, peer); })
          ->UseManualTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(benchmarkName(graph, "ours").c_str(),
                                 [&graph](benchmark::State& state) { runOurs(state, graph); })
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
