// Two tours through a simulated flat with 35 objects, five of which have been moved in between; and
// through drawn flats, by default of the seeds 1 to 5, else of those in HYSELAM_FLAT_SEEDS
// ("7,11-14"). ObjectsOfDrawnFlats tells the mean over the drawn flats that were run before it, the
// worst and the standard deviation of precisions and recalls, and sums of what is counted.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "flat_show.hpp"
#include "hyselam_common/errors.hpp"

namespace {

using namespace hyselam_objects::simulated;  // NOLINT: a program, not a header

constexpr std::uint64_t kMostSeeds = 1000;

FlatScores run(benchmark::State& state, const Furnished& furnished) {
  const char* every = std::getenv("HYSELAM_FLAT_EVERY");
  static const hyselam_objects::ObjectDictionary kinds = learnKinds();
  FlatScores scores;
  for (auto _ : state) {
    FlatShow show(furnished, kinds, every != nullptr ? std::atoi(every) : 1);
    scores = show.run();
  }
  state.counters["objects"] = scores.objects;
  state.counters["precision"] = scores.precision;
  state.counters["recall"] = scores.recall;
  state.counters["hidden"] = scores.hidden;
  state.counters["recall_of_seen"] = scores.recall_of_seen;
  state.counters["kinds_right"] = scores.kinds;
  state.counters["relation_precision"] = scores.relation_precision;
  state.counters["relation_recall"] = scores.relation_recall;
  state.counters["moved_refound"] = scores.refound;
  state.counters["movability_auc"] = scores.movability_auc;
  state.counters["moved"] = static_cast<double>(furnished.moved.size());
  state.counters["noticed_1m"] = scores.noticed;
  state.counters["of_displaced"] = scores.displaced;
  state.counters["false_alarms"] = scores.false_alarms;
  state.counters["of_in_place"] = scores.in_place;
  state.counters["frame_ms"] = scores.milliseconds;
  if (std::getenv("HYSELAM_FLAT_FAULTS") != nullptr) {
    for (const std::string& fault : scores.faults) std::cerr << fault << "\n";
  }
  return scores;
}

void BM_ObjectsOfAFlat(benchmark::State& state) {
  run(state, flatOf(HYSELAM_FLAT_PLAN));
}
BENCHMARK(BM_ObjectsOfAFlat)->Unit(benchmark::kMillisecond)->Iterations(1);

struct DrawnFlat {
  FlatScores scores;
  int moved = 0;
};

std::vector<DrawnFlat>& drawnFlats() {
  static std::vector<DrawnFlat> flats;
  return flats;
}

void drawn(benchmark::State& state, std::uint64_t seed) {
  if (std::getenv("HYSELAM_FLAT_FAULTS") != nullptr) std::cerr << "drawn flat " << seed << "\n";
  const Furnished furnished = drawnFlat(HYSELAM_FLAT_PLAN, seed);
  drawnFlats().push_back({run(state, furnished), static_cast<int>(furnished.moved.size())});
}

void tellSpread(benchmark::State& state) {
  for (auto _ : state) {
  }
  const std::vector<DrawnFlat>& all = drawnFlats();
  if (all.empty()) {
    state.SetLabel("skipped=no drawn flat was run before");
    return;
  }
  const auto n = static_cast<double>(all.size());
  const auto spread = [&](const std::string& name, double FlatScores::*value) {
    double mean = 0.0, squares = 0.0, worst = 1.0;
    for (const DrawnFlat& each : all) {
      const double x = each.scores.*value;
      mean += x / n;
      squares += x * x / n;
      worst = std::min(worst, x);
    }
    state.counters[name] = mean;
    state.counters[name + "_worst"] = worst;
    state.counters[name + "_deviation"] = std::sqrt(std::max(0.0, squares - mean * mean));
  };
  spread("precision", &FlatScores::precision);
  spread("recall", &FlatScores::recall);
  spread("kinds_right", &FlatScores::kinds);
  spread("relation_precision", &FlatScores::relation_precision);
  spread("relation_recall", &FlatScores::relation_recall);
  const auto sum = [&](const std::string& name, int FlatScores::*value) {
    for (const DrawnFlat& each : all) state.counters[name] += each.scores.*value;
  };
  sum("objects", &FlatScores::objects);
  sum("moved_refound", &FlatScores::refound);
  sum("noticed_1m", &FlatScores::noticed);
  sum("of_displaced", &FlatScores::displaced);
  sum("false_alarms", &FlatScores::false_alarms);
  sum("of_in_place", &FlatScores::in_place);
  for (const DrawnFlat& each : all) state.counters["moved"] += each.moved;
  state.counters["flats"] = n;
}

/// Of "7,11-14". @throws hyselam::InputError.
std::vector<std::uint64_t> seedsOf(const std::string& text) {
  std::vector<std::uint64_t> seeds;
  std::istringstream in(text);
  const auto fail = [&text] {
    throw hyselam::InputError("HYSELAM_FLAT_SEEDS", text, "is no list as 7,11-14");
  };
  while (in && in.peek() != EOF) {
    std::uint64_t first = 0;
    if (!(in >> first)) fail();
    std::uint64_t last = first;
    if (in.peek() == '-' && !(in.ignore() >> last)) fail();
    if (last < first || last - first >= kMostSeeds) fail();
    for (std::uint64_t seed = first; seed <= last; ++seed) seeds.push_back(seed);
    if (in.peek() != EOF && in.get() != ',') fail();
  }
  if (seeds.empty()) fail();
  return seeds;
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const char* seeds = std::getenv("HYSELAM_FLAT_SEEDS");
  try {
    for (const std::uint64_t seed : seedsOf(seeds != nullptr ? seeds : "1-5")) {
      benchmark::RegisterBenchmark(("BM_ObjectsOfADrawnFlat/" + std::to_string(seed)).c_str(),
                                   [seed](benchmark::State& state) { drawn(state, seed); })
          ->Unit(benchmark::kMillisecond)
          ->Iterations(1);
    }
  } catch (const hyselam::InputError& e) {
    std::cerr << "error: " << e.what() << "\n";
    return 2;
  }
  benchmark::RegisterBenchmark("BM_ObjectsOfDrawnFlats", tellSpread)
      ->Unit(benchmark::kMillisecond)
      ->Iterations(1);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
