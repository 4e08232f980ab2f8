// Two tours through a simulated flat with 35 objects, five of which have been moved in between.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <iostream>

#include "flat_show.hpp"

namespace {

void BM_ObjectsOfAFlat(benchmark::State& state) {
  using namespace hyselam_objects::simulated;
  const char* every = std::getenv("HYSELAM_FLAT_EVERY");
  FlatScores scores;
  for (auto _ : state) {
    FlatShow show(HYSELAM_FLAT_PLAN, learnKinds(), every != nullptr ? std::atoi(every) : 1);
    scores = show.run();
  }
  state.counters["objects"] = scores.objects;
  state.counters["precision"] = scores.precision;
  state.counters["recall"] = scores.recall;
  state.counters["kinds_right"] = scores.kinds;
  state.counters["relation_precision"] = scores.relation_precision;
  state.counters["relation_recall"] = scores.relation_recall;
  state.counters["moved_refound"] = scores.refound;
  state.counters["movability_auc"] = scores.movability_auc;
  state.counters["frame_ms"] = scores.milliseconds;
  if (std::getenv("HYSELAM_FLAT_FAULTS") == nullptr) return;
  for (const std::string& fault : scores.faults) std::cerr << fault << "\n";
}
BENCHMARK(BM_ObjectsOfAFlat)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
