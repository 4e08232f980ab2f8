// Two tours through a simulated flat with 35 objects, five of which have been moved in between.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <iostream>

#include "flat_show.hpp"

namespace {

using hyselam_objects::simulated::Furnished;

void run(benchmark::State& state, const Furnished& furnished) {
  using namespace hyselam_objects::simulated;  // NOLINT: a program, not a header
  const char* every = std::getenv("HYSELAM_FLAT_EVERY");
  FlatScores scores;
  for (auto _ : state) {
    FlatShow show(furnished, learnKinds(), every != nullptr ? std::atoi(every) : 1);
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
  if (std::getenv("HYSELAM_FLAT_FAULTS") == nullptr) return;
  for (const std::string& fault : scores.faults) std::cerr << fault << "\n";
}

void BM_ObjectsOfAFlat(benchmark::State& state) {
  run(state, hyselam_objects::simulated::flatOf(HYSELAM_FLAT_PLAN));
}
BENCHMARK(BM_ObjectsOfAFlat)->Unit(benchmark::kMillisecond)->Iterations(1);

/// Flats that nothing was tuned on.
void BM_ObjectsOfADrawnFlat(benchmark::State& state) {
  run(state, hyselam_objects::simulated::drawnFlat(HYSELAM_FLAT_PLAN,
                                                   static_cast<std::uint64_t>(state.range(0))));
}
BENCHMARK(BM_ObjectsOfADrawnFlat)->DenseRange(1, 5)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
