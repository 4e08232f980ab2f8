// TopoMerg's solvers: the thesis' problem, floors of 20 names in 30 places and 40 in 60. One
// thread.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

#include "../test/random_matches.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace {

using namespace random_matches;  // NOLINT: a bench, not a header

MatchProblem scenario() {
  const std::string data = std::string(HYSELAM_PACKAGE_DIR) + "/test/data/";
  return compileMatch(loadDescription(data + "scenario_532_human.xml"),
                      hyselam_topo::loadXml(data + "scenario_532_map.xml"), {4, 0.0});
}

SolverParams thesis(bool connected) {
  SolverParams params;
  params.fitness = FitnessParams::equation52();
  params.dummy = false;
  params.connected = connected;
  return params;
}

void explorer(benchmark::State& state) {
  const MatchProblem problem = scenario();
  for (auto _ : state) {
    double fitness = exploreAll(problem, thesis(false)).best().fitness;
    benchmark::DoNotOptimize(fitness);
  }
}

void tree(benchmark::State& state) {
  const MatchProblem problem = scenario();
  for (auto _ : state) {
    double fitness = treeSearch(problem, thesis(true)).best().fitness;
    benchmark::DoNotOptimize(fitness);
  }
  state.SetLabel("baseline=TopoMerg/7x8/explorer");
}

void exact(benchmark::State& state, bool connected) {
  const MatchProblem problem = scenario();
  for (auto _ : state) {
    double fitness = solveExact(problem, thesis(connected)).best().fitness;
    benchmark::DoNotOptimize(fitness);
  }
  state.SetLabel("baseline=TopoMerg/7x8/explorer");
}

/// Floors 1 .. 21: 60 % of the sizes are told, every tenth of them half or twice what it is.
std::vector<MatchProblem> floors(int names, int places) {
  std::vector<MatchProblem> out;
  FloorOptions options;
  options.wrong_size = 0.1;
  for (std::uint64_t seed = 1; seed <= 21; ++seed)
    out.push_back(compile(floor(seed, names, places, options)));
  return out;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// One iteration solves all floors; the counters tell the CPU time of the median floor.
void many(benchmark::State& state, int names, int places, double limit) {
  const std::vector<MatchProblem> problems = floors(names, places);
  SolverParams params;
  if (limit > 0.0) params.time_limit = limit;
  std::vector<double> ms, gaps;
  double proven = 0.0;
  for (auto _ : state) {
    ms.clear();
    gaps.clear();
    proven = 0.0;
    for (const MatchProblem& problem : problems) {
      const std::clock_t start = std::clock();
      const PlaceAssignment match = solveExact(problem, params);
      ms.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
      gaps.push_back(match.gap);
      proven += match.optimal ? 1.0 : 0.0;
    }
  }
  state.counters["median_ms"] = median(ms);
  state.counters["slowest_ms"] = *std::max_element(ms.begin(), ms.end());
  state.counters["median_gap"] = median(gaps);
  state.counters["proven_best_percent"] = 100.0 * proven / static_cast<double>(problems.size());
}

/// Not by the macro, whose Name() Google Benchmark has since 1.6 only.
bool registerAll() {
  using benchmark::RegisterBenchmark;
  RegisterBenchmark("TopoMerg/7x8/explorer", explorer)->Unit(benchmark::kMicrosecond);
  RegisterBenchmark("TopoMerg/7x8/treesearch", tree)->Unit(benchmark::kMicrosecond);
  RegisterBenchmark("TopoMerg/7x8/exact", exact, true)->Unit(benchmark::kMicrosecond);
  RegisterBenchmark("TopoMerg/7x8/exact_any_sets", exact, false)->Unit(benchmark::kMicrosecond);
  RegisterBenchmark("TopoMerg/20x30/exact", many, 20, 30, 2.0)->Unit(benchmark::kMillisecond);
  RegisterBenchmark("TopoMerg/40x60/exact_100ms", many, 40, 60, 0.1)->Unit(benchmark::kMillisecond);
  return true;
}
[[maybe_unused]] const bool kRegistered = registerAll();

}  // namespace
