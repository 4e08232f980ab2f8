// Cost of the kinds of regions along a way: features of a place, and the decision over a run.
#include <benchmark/benchmark.h>

#include <memory>

#include "hyselam_common/rng.hpp"
#include "ngram_slam/semantics/way_forest.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

constexpr int kPlaces = 200;  // 50 m of way

/// A scan of 181 beams every quarter of a metre: a place each. The time is that of a place.
void classifyWay(benchmark::State& state) {
  const WayForest forest = WayForest::shipped();
  hyselam::Rng rng(7);
  hyselam::LaserScan scan;
  scan.angle_min = -hyselam::kPi / 2;
  scan.angle_increment = hyselam::radians(1.0);
  scan.range_min = 0.05;
  scan.range_max = 80.0;
  for (int i = 0; i < 181; ++i) scan.ranges.push_back(static_cast<float>(rng.uniform(1.0, 15.0)));
  const auto shared = std::make_shared<const hyselam::LaserScan>(scan);
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
