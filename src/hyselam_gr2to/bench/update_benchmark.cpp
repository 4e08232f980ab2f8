// Distance map and Voronoi diagram of a floor: from scratch, and after 1 % of the cells has
// changed.
#include <benchmark/benchmark.h>

#include <opencv2/imgproc.hpp>

#include "hyselam_common/rng.hpp"
#include "hyselam_gr2to/gr2to_updater.hpp"
#include "hyselam_gr2to/thesis/thesis.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterize.hpp"

namespace {

using namespace hyselam_topo;  // NOLINT: a bench, not a header

// About 29 x 13 m, in cells of 2 cm: nearly a million.
const cv::Mat& floorMap() {
  static const cv::Mat map = [] {
    hyselam_sim::PlanParams params;
    params.layout = hyselam_sim::PlanParams::Layout::kCorridor;
    params.furniture = true;
    return obstaclesOf(hyselam_sim::rasterize(hyselam_sim::generatePlan(6, params), 0.02, 0.0), 25,
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
    const VoronoiDiagram voronoi{DistanceMap(floorMap())};
    auto* lines = voronoi.lines().data;
    benchmark::DoNotOptimize(lines);
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
    auto* lines = voronoi.lines().data;
    benchmark::DoNotOptimize(lines);
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

// ---- all of Gr2To: nine floors side by side, 5 cm, where a block of 1 % is cluttered and cleared
// ----

const hyselam::OccupancyGrid& nineFloors() {
  static const hyselam::OccupancyGrid map = [] {
    std::vector<hyselam::OccupancyGrid> floors;
    int width = 0, height = 0;
    for (std::uint64_t seed = 1; seed <= 9; ++seed) {
      floors.push_back(hyselam_sim::rasterize(hyselam_sim::generatePlan(seed), 0.05, 0.0));
      width = std::max(width, floors.back().geometry.width);
      height = std::max(height, floors.back().geometry.height);
    }
    hyselam::GridGeometry g;
    g.width = 3 * width;
    g.height = 3 * height;
    g.resolution = 0.05;
    hyselam::OccupancyGrid out(g);
    for (int k = 0; k < 9; ++k) {
      const auto& floor = floors[static_cast<std::size_t>(k)];
      for (int y = 0; y < floor.geometry.height; ++y) {
        for (int x = 0; x < floor.geometry.width; ++x) {
          out.at({x + k % 3 * width, y + k / 3 * height}) = floor.at({x, y});
        }
      }
    }
    return out;
  }();
  return map;
}

// Windows of 1 % of the cells all over the map, each with a few things put on the floor.
std::vector<hyselam::OccupancyGrid> cluttered() {
  std::vector<hyselam::OccupancyGrid> out;
  hyselam::Rng rng(9);
  const auto& map = nineFloors();
  const auto upTo = [&](int n) {
    return static_cast<int>(rng.below(static_cast<std::uint32_t>(n)));
  };
  const int w = map.geometry.width / 10, h = map.geometry.height / 10;
  while (out.size() < 12) {
    hyselam::OccupancyGrid next = map;
    const int x0 = upTo(9 * w), y0 = upTo(9 * h);
    int put = 0;
    for (int k = 0; k < 8; ++k) {
      // The first and the last in opposite corners.
      const int bx = k == 0   ? x0
                     : k == 7 ? x0 + w - 8
                              : x0 + upTo(w - 8),
                by = k == 0   ? y0
                     : k == 7 ? y0 + h - 8
                              : y0 + upTo(h - 8);
      for (int y = by; y < by + 8; ++y) {
        for (int x = bx; x < bx + 8; ++x) {
          if (map.at({x, y}) != 0) continue;
          next.at({x, y}) = hyselam::OccupancyGrid::kOccupied;
          ++put;
        }
      }
    }
    if (put > 100) out.push_back(std::move(next));
  }
  return out;
}

void Gr2ToMap_FromScratch(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(gr2to(nineFloors()).map.places.size());
}
BENCHMARK(Gr2ToMap_FromScratch)->Unit(benchmark::kMillisecond);

void Gr2ToMap_Update(benchmark::State& state) {
  const auto maps = cluttered();
  Gr2ToUpdater updater;
  updater.update(nineFloors());
  std::size_t i = 0;
  double partial = 0.0, all = 0.0;
  for (auto _ : state) {
    const bool clear = i % 2 == 1;
    benchmark::DoNotOptimize(
        updater.update(clear ? nineFloors() : maps[i / 2 % maps.size()]).map.places.size());
    ++i;
    all += 1.0;
    partial += updater.lastUpdate() == Gr2ToUpdater::UpdateKind::kPartial ? 1.0 : 0.0;
  }
  state.counters["in_part_share"] = partial / all;
  state.SetLabel("baseline=Gr2ToMap_FromScratch");
}
BENCHMARK(Gr2ToMap_Update)->Unit(benchmark::kMillisecond);

}  // namespace
