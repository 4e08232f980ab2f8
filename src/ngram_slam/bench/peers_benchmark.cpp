// What it costs to compare two places: by ICP over 150 points of the local map (the thesis' peer),
// by a descriptor of single scans, and as two words of a text.
#include <benchmark/benchmark.h>

#include <memory>

#include "hyselam_sim/data.hpp"
#include "hyselam_sim/simulation.hpp"
#include "ngram_slam/words/density_word.hpp"
#include "peers/icp_distance.hpp"
#include "peers/polar_context.hpp"

namespace {

using namespace ngram_slam_peers;  // NOLINT: a bench, not a header

const std::vector<Station>& stations() {
  static const std::vector<Station> all = [] {
    const auto plan = hyselam_sim::loadFloorPlan(hyselam_sim::planFile("university"));
    const auto route = hyselam_sim::parseRoute(
        "route: bench\nstart: D\ndirect: true\nsteps: [E, A, D, E, B, C]\n", "bench");
    return stationsOf(hyselam_sim::simulate(plan, route, 1).log, {});
  }();
  return all;
}

void PairOfPlaces_Icp(benchmark::State& state) {
  std::vector<Cloud::Ptr> clouds;
  for (const Station& s : stations()) clouds.push_back(cloudOf(s.points));
  IcpDistance icp;
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(icp(clouds[i % clouds.size()], clouds[i * 7 % clouds.size()]));
    ++i;
  }
}
BENCHMARK(PairOfPlaces_Icp)->Unit(benchmark::kMicrosecond);

void PairOfPlaces_Context(benchmark::State& state) {
  std::vector<PolarContext> contexts;
  for (const Station& s : stations())
    contexts.push_back(contextOf(returnsOf(s.scan), kContextRange));
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        contextDistance(contexts[i % contexts.size()], contexts[i * 7 % contexts.size()]));
    ++i;
  }
  state.SetLabel("baseline=PairOfPlaces_Icp");
}
BENCHMARK(PairOfPlaces_Context)->Unit(benchmark::kMicrosecond);

void PairOfPlaces_Words(benchmark::State& state) {
  std::vector<ngram_slam::Syllables> words;
  for (unsigned i = 0; i < 997; ++i) {
    words.push_back({static_cast<int>(i % 5), 5 + i * 37 % 90, static_cast<float>(i % 3) - 1.0F});
  }
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        ngram_slam::wordsMatch(words[i % words.size()], words[i * 7 % words.size()], {}));
    ++i;
  }
  state.SetLabel("baseline=PairOfPlaces_Icp");
}
BENCHMARK(PairOfPlaces_Words)->Unit(benchmark::kMicrosecond);

}  // namespace
