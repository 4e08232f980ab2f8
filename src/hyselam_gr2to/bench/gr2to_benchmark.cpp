// Gr2To on each grid map of the data set, and on one of 4000 x 4000 cells: wall
// times, since some steps run beside each other (OpenCV's own threads are off).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "hyselam_common/map_io.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "segmentation/chamfer_distance.hpp"

namespace {

using namespace hyselam_topo;  // NOLINT: a bench, not a header
namespace fs = std::filesystem;

void places(benchmark::State& state, const hyselam::OccupancyGrid& grid) {
  cv::setNumThreads(1);
  for (auto _ : state) benchmark::DoNotOptimize(segmentPlaces(grid).places);
}

void all(benchmark::State& state, const hyselam::OccupancyGrid& grid,
         Gr2ToParams::Mode mode = Gr2ToParams::Mode::kDefault) {
  cv::setNumThreads(1);
  Gr2ToParams params;
  params.mode = mode;
  for (auto _ : state) benchmark::DoNotOptimize(gr2to(grid, params).map.places.size());
}

/// Distances of the free cells of a map: OpenCV's and ours.
void distances(benchmark::State& state, const hyselam::OccupancyGrid& grid, bool ours) {
  cv::setNumThreads(1);
  const cv::Mat cells(grid.geometry.height, grid.geometry.width, CV_8S,
                      const_cast<std::int8_t*>(grid.cells.data()));
  const cv::Mat free = cells == 0;
  cv::Mat out;
  for (auto _ : state) {
    if (ours)
      out = chamferDistance(free);
    else
      cv::distanceTransform(free, out, cv::DIST_L2, cv::DIST_MASK_5);
    benchmark::DoNotOptimize(out.data);
  }
  if (ours) state.SetLabel("baseline=DistanceTransform_OpenCv");
}

/// Generated floors side by side until 200 m are full.
hyselam::OccupancyGrid large() {
  hyselam::GridGeometry g;
  g.width = g.height = 4000;
  g.resolution = 0.05;
  hyselam::OccupancyGrid grid(g);
  std::uint64_t seed = 1;
  for (int y = 0; y < g.height;) {
    int highest = 1;
    for (int x = 0; x < g.width;) {
      hyselam_sim::PlanParams params;
      params.furniture = seed % 2 == 0;
      const hyselam::OccupancyGrid floor =
          hyselam_sim::rasterize(hyselam_sim::generatePlan(seed++, params), g.resolution, 0.0);
      for (int v = 0; v < floor.geometry.height; ++v)
        for (int u = 0; u < floor.geometry.width; ++u)
          if (g.contains({x + u, y + v})) grid.at({x + u, y + v}) = floor.at({u, v});
      x += floor.geometry.width;
      highest = std::max(highest, floor.geometry.height);
    }
    y += highest;
  }
  return grid;
}

void addMaps() {
  const char* data = std::getenv("HYSELAM_DATA");
  const fs::path folder = fs::path(data != nullptr ? data : HYSELAM_DEFAULT_DATA) / "gridmaps";
  std::vector<fs::path> files;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  if (files.empty()) std::cerr << "left out: no maps in " << folder << " (set HYSELAM_DATA)\n";
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const auto grid = std::make_shared<hyselam::OccupancyGrid>(hyselam::loadMap(file.string()));
    const std::string name = file.stem().string();
    benchmark::RegisterBenchmark(("Gr2ToPlaces/" + name).c_str(),
                                 [grid](benchmark::State& state) { places(state, *grid); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
    benchmark::RegisterBenchmark(("Gr2ToAll/" + name).c_str(),
                                 [grid](benchmark::State& state) { all(state, *grid); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
}

const bool kAdded = [] {
  addMaps();
  const auto grid = std::make_shared<hyselam::OccupancyGrid>(large());
  for (const bool ours : {false, true})
    benchmark::RegisterBenchmark(
        ours ? "ChamferDistance" : "DistanceTransform_OpenCv",
        [grid, ours](benchmark::State& state) { distances(state, *grid, ours); })
        ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("Gr2ToPlaces/4000x4000",
                               [grid](benchmark::State& state) { places(state, *grid); })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
  benchmark::RegisterBenchmark("Gr2ToAll/4000x4000",
                               [grid](benchmark::State& state) { all(state, *grid); })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
  return true;
}();

}  // namespace
