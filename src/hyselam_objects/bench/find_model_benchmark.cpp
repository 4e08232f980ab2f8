// findModel on the clouds of mOSD, which do not show the carton of PCL's tutorial, and on the same
// with the carton put onto the table. Counters, apart for learn* (on which the probability was
// fitted) and test*: scenes, poses found without it, scenes with it in which it was found at the
// right place (3 cm) and nothing else was found.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/pcl/find_model.hpp"
#include "model_scenes.hpp"

namespace {

using namespace hyselam_objects;  // NOLINT: a bench, not a header
namespace fs = std::filesystem;

struct Counts {
  int scenes = 0, false_poses = 0, with = 0, found_once = 0;
};

void count(const OrganizedCloud& model, const Eigen::Vector3f& up, const OrganizedCloud& scene,
           std::uint64_t seed, Counts& counts) {
  ++counts.scenes;
  counts.false_poses += static_cast<int>(findModel(model, scene).size());
  hyselam::Rng rng(seed);
  const auto put = putIntoScene(model, up, scene, rng);
  if (!put) return;
  ++counts.with;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Point& p : model.points) middle += p.cast<double>();
  middle /= static_cast<double>(model.size());
  const auto found = findModel(model, put->cloud);
  counts.found_once +=
      found.size() == 1 &&
      (found[0].model_in_scene * middle - put->model_in_scene * middle).norm() < 0.03;
}

void BM_FindModel(benchmark::State& state) {
  const bool learn = state.range(0) != 0;
  const char* data = std::getenv("HYSELAM_DATA");
  const std::string folder =
      std::string(data != nullptr ? data : HYSELAM_DEFAULT_DATA) + "/objects/";
  std::vector<fs::path> paths;
  std::error_code none;
  for (const char* set : {"mosd", "mosd_piles"}) {
    for (fs::directory_iterator entry(folder + set, none), end; !none && entry != end;
         entry.increment(none)) {
      const fs::path path = entry->path();
      const bool is_learn = path.filename().string().compare(0, 5, "learn") == 0;
      if (path.extension() == ".pcd" && is_learn == learn) paths.push_back(path);
    }
  }
  if (paths.empty()) {
    state.SetLabel("skipped=no clouds in " + folder);
    for (auto _ : state) {
    }
    return;
  }
  std::sort(paths.begin(), paths.end(),
            [](const fs::path& a, const fs::path& b) { return a.filename() < b.filename(); });
  const OrganizedCloud model = readPcd(folder + "pcl_tutorials/milk.pcd").cloud;
  const auto table =
      segmentCloud(readPcd(folder + "pcl_tutorials/milk_cartoon_all_small_clorox.pcd").cloud)
          .support;
  Counts counts;
  for (auto _ : state) {
    counts = {};
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const OrganizedCloud scene = readPcd(paths[i].string()).cloud;
      if (scene.height > 1) count(model, table.value().normal, scene, i + 1, counts);
    }
  }
  state.counters["scenes"] = counts.scenes;
  state.counters["false_poses"] = counts.false_poses;
  state.counters["with_model"] = counts.with;
  state.counters["found_once"] = counts.found_once;
  state.counters["items"] = counts.scenes + counts.with;
}
BENCHMARK(BM_FindModel)
    ->ArgName("learn")
    ->Arg(1)
    ->Arg(0)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
