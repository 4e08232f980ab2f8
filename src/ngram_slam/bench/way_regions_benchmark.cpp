// Cost of the kinds of regions along a way: features of a place, and the decision over a run.
#include <benchmark/benchmark.h>

#include <memory>

#include "hyselam_common/rng.hpp"
#include "ngram_slam/semantics/way_forest.hpp"
#include "random_scan.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

constexpr int kPlaces = 200;  // 50 m of way

/// A scan of 181 beams every quarter of a metre: a place each. The time is that of a place.
void classifyWay(benchmark::State& state) {
  const WayForest forest = WayForest::shipped();
  hyselam::Rng rng(7);
  const auto shared = randomIndoorScan(rng);
  for (auto _ : state) {
    std::vector<WayPlace> run;
    SignatureSensor sensor(waySensorParams(), [&](const PlaceOnWay& at, const PlaceFeatures& f) {
      run.push_back({at.way, at.pose, wayShapeOf(f)});
    });
    for (int k = 0; k < kPlaces; ++k) sensor.add(k, {0.25 * k, 0.0, 0.0}, shared);
    sensor.finish();
    benchmark::DoNotOptimize(forest.classify(run));
  }
  state.SetItemsProcessed(state.iterations() * kPlaces);
}
BENCHMARK(classifyWay)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
