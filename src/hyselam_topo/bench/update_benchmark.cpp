// Distance map and Voronoi diagram of a floor: from scratch, and after 1 % of the cells has
// changed.
#include <benchmark/benchmark.h>

#include <opencv2/imgproc.hpp>

#include "hyselam_common/rng.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterise.hpp"
#include "hyselam_topo/thesis.hpp"

namespace {

using namespace hyselam_topo;  // NOLINT: a bench, not a header

// About 29 x 13 m, in cells of 2 cm: nearly a million.
const cv::Mat& floorMap() {
  static const cv::Mat map = [] {
    hyselam_sim::PlanParams params;
    params.layout = hyselam_sim::PlanParams::Layout::kCorridor;
    params.furniture = true;
    return obstaclesOf(hyselam_sim::rasterise(hyselam_sim::generatePlan(6, params), 0.02, 0.0), 25,
                       65, true);
  }();
  return map;
}

// 1 % of the cells turned over: in one block in the middle, or in blocks of 10 x 10 everywhere.
cv::Mat changed(bool scattered) {
  cv::Mat map = floorMap().clone();
  const auto flip = [&](const cv::Rect& r) { cv::bitwise_not(map(r), map(r)); };
  if (!scattered) {
    const int w = map.cols / 10, h = map.rows / 10;
    flip({map.cols / 2, map.rows / 4, w, h});
    return map;
  }
  hyselam::Rng rng(5);
  for (int k = map.rows * map.cols / 10000; k > 0; --k) {
    flip({static_cast<int>(rng.below(static_cast<std::uint32_t>(map.cols - 10))),
          static_cast<int>(rng.below(static_cast<std::uint32_t>(map.rows - 10))), 10, 10});
  }
  return map;
}

void Gr2ToDistance_OpenCvPrecise(benchmark::State& state) {
  const cv::Mat open = floorMap() == 0;
  cv::Mat distance;
  for (auto _ : state) {
    cv::distanceTransform(open, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    benchmark::DoNotOptimize(distance.data);
  }
}
BENCHMARK(Gr2ToDistance_OpenCvPrecise)->Unit(benchmark::kMillisecond);

void Gr2ToDistance_FromScratch(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(DistanceMap(floorMap()).squared({5, 5}));
  state.SetLabel("baseline=Gr2ToDistance_OpenCvPrecise");
}
BENCHMARK(Gr2ToDistance_FromScratch)->Unit(benchmark::kMillisecond);

// The change comes and goes: half of the updates take it away.
void distanceUpdate(benchmark::State& state, bool scattered) {
  DistanceMap map(floorMap());
  const cv::Mat other = changed(scattered);
  bool there = false;
  for (auto _ : state) {
    there = !there;
    benchmark::DoNotOptimize(map.update(there ? other : floorMap()).size());
  }
  state.SetLabel("baseline=Gr2ToDistance_FromScratch");
}
void Gr2ToDistance_UpdateBlock(benchmark::State& state) {
  distanceUpdate(state, false);
}
BENCHMARK(Gr2ToDistance_UpdateBlock)->Unit(benchmark::kMillisecond);
void Gr2ToDistance_UpdateScattered(benchmark::State& state) {
  distanceUpdate(state, true);
}
BENCHMARK(Gr2ToDistance_UpdateScattered)->Unit(benchmark::kMillisecond);

void Gr2ToVoronoi_FromScratch(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(VoronoiDiagram(DistanceMap(floorMap())).lines().data);
  }
}
BENCHMARK(Gr2ToVoronoi_FromScratch)->Unit(benchmark::kMillisecond);

void voronoiUpdate(benchmark::State& state, bool scattered) {
  DistanceMap map(floorMap());
  VoronoiDiagram voronoi(map);
  const cv::Mat other = changed(scattered);
  bool there = false;
  for (auto _ : state) {
    there = !there;
    voronoi.update(map, map.update(there ? other : floorMap()));
    benchmark::DoNotOptimize(voronoi.lines().data);
  }
  state.SetLabel("baseline=Gr2ToVoronoi_FromScratch");
}
void Gr2ToVoronoi_UpdateBlock(benchmark::State& state) {
  voronoiUpdate(state, false);
}
BENCHMARK(Gr2ToVoronoi_UpdateBlock)->Unit(benchmark::kMillisecond);
void Gr2ToVoronoi_UpdateScattered(benchmark::State& state) {
  voronoiUpdate(state, true);
}
BENCHMARK(Gr2ToVoronoi_UpdateScattered)->Unit(benchmark::kMillisecond);

}  // namespace
