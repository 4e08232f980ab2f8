// findModel on scenes that do not show the carton of PCL's tutorial, and on the same with the
// carton put onto the table: clouds of mOSD, learn* (on which the probability was fitted) and test*
// apart, and drawn tables. Counters: scenes without it and with it, poses found without it, scenes
// with it in which it was found at the right place (3 cm) and nothing else was. And whether the
// probability is one, over all poses that were judged: its mean squared error (Brier) beside that
// of their share that is right, and by bins of it, how many there are, its mean, and the share that
// is right.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/pcl/find_model.hpp"
#include "model_scenes.hpp"
#include "table_scenes.hpp"

namespace {

using namespace hyselam_objects;  // NOLINT: a bench, not a header
namespace fs = std::filesystem;

constexpr double kTold = 0.5;  // probability of a pose that is told
constexpr int kDrawn = 24, kPlaces = 2;

struct JudgedPose {
  double probability = 0.0;
  bool right = false;
};

struct Counts {
  int scenes = 0, false_poses = 0, with = 0, found_once = 0;
  std::vector<JudgedPose> judged;
};

struct Model {
  OrganizedCloud cloud;
  Eigen::Vector3f up;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
};

std::vector<FoundModel> judgeAll(const Model& model, const OrganizedCloud& scene) {
  FindModelParams params;
  params.min_probability = 0.0;  // those that are told come first
  return findModel(model.cloud, scene, params);
}

bool isTold(const FoundModel& found) {
  return found.probability >= kTold;
}

void countWithout(const Model& model, const OrganizedCloud& scene, Counts& counts) {
  ++counts.scenes;
  for (const FoundModel& each : judgeAll(model, scene)) {
    counts.false_poses += isTold(each);
    counts.judged.push_back({each.probability, false});
  }
}

void countWith(const Model& model, const OrganizedCloud& scene, std::uint64_t seed,
               Counts& counts) {
  hyselam::Rng rng(seed);
  const auto put = putIntoScene(model.cloud, model.up, scene, rng);
  if (!put) return;
  ++counts.with;
  bool found = false;
  int told = 0;
  for (const FoundModel& each : judgeAll(model, put->cloud)) {
    const bool right =
        (each.model_in_scene * model.middle - put->model_in_scene * model.middle).norm() < 0.03;
    told += isTold(each);
    found = found || (right && isTold(each));
    counts.judged.push_back({each.probability, right});
  }
  counts.found_once += found && told == 1;
}

void report(const Counts& counts, benchmark::State& state) {
  state.counters["scenes"] = counts.scenes;
  state.counters["false_poses"] = counts.false_poses;
  state.counters["with_model"] = counts.with;
  state.counters["found_once"] = counts.found_once;
  state.counters["items"] = counts.scenes + counts.with;
  const auto all = static_cast<double>(std::max<std::size_t>(1, counts.judged.size()));
  const auto right = static_cast<double>(std::count_if(
      counts.judged.begin(), counts.judged.end(), [](const JudgedPose& p) { return p.right; }));
  double error = 0.0;
  constexpr std::array<double, 6> kBins{0.0, 0.05, 0.3, 0.7, 0.95, 1.0 + 1e-9};
  for (std::size_t bin = 0; bin + 1 < kBins.size(); ++bin) {
    double n = 0.0, sum = 0.0, good = 0.0;
    for (const JudgedPose& pose : counts.judged) {
      if (pose.probability < kBins[bin] || pose.probability >= kBins[bin + 1]) continue;
      n += 1.0;
      sum += pose.probability;
      good += pose.right;
    }
    const std::string name = "bin" + std::to_string(bin);
    state.counters[name + "_poses"] = n;
    state.counters[name + "_told"] = n > 0.0 ? sum / n : 0.0;
    state.counters[name + "_right"] = n > 0.0 ? good / n : 0.0;
  }
  for (const JudgedPose& pose : counts.judged) {
    error += (pose.probability - pose.right) * (pose.probability - pose.right) / all;
  }
  state.counters["brier"] = error;
  state.counters["brier_of_share"] = right / all * (1.0 - right / all);
}

std::string dataFolder() {
  const char* data = std::getenv("HYSELAM_DATA");
  return std::string(data != nullptr ? data : HYSELAM_DEFAULT_DATA) + "/objects/";
}

std::vector<fs::path> cloudsOf(const std::string& folder, bool learn) {
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
  std::sort(paths.begin(), paths.end(),
            [](const fs::path& a, const fs::path& b) { return a.filename() < b.filename(); });
  return paths;
}

Model carton(const std::string& folder) {
  Model model;
  model.cloud = readPcd(folder + "pcl_tutorials/milk.pcd").cloud;
  model.up = segmentCloud(readPcd(folder + "pcl_tutorials/milk_cartoon_all_small_clorox.pcd").cloud)
                 .support.value()
                 .normal;
  for (const Point& p : model.cloud.points) {
    model.middle += p.cast<double>() / static_cast<double>(model.cloud.size());
  }
  return model;
}

void run(benchmark::State& state, std::size_t scenes,
         const std::function<OrganizedCloud(std::size_t)>& sceneAt, int places) {
  const std::string folder = dataFolder();
  if (scenes == 0 || !fs::exists(folder + "pcl_tutorials/milk.pcd")) {
    state.SetLabel("skipped=no clouds in " + folder);
    for (auto _ : state) {
    }
    return;
  }
  const Model model = carton(folder);
  Counts counts;
  for (auto _ : state) {
    counts = {};
    for (std::size_t i = 0; i < scenes; ++i) {
      const OrganizedCloud scene = sceneAt(i);
      countWithout(model, scene, counts);
      for (int place = 0; place < places; ++place) {
        countWith(model, scene, i + 1 + 1000 * static_cast<std::uint64_t>(place), counts);
      }
    }
  }
  report(counts, state);
}

/// Clouds of mOSD; the carton at one place of learn*, at two of test*.
void BM_FindModel(benchmark::State& state) {
  const bool learn = state.range(0) != 0;
  const std::vector<fs::path> paths = cloudsOf(dataFolder(), learn);
  run(
      state, paths.size(), [&](std::size_t i) { return readPcd(paths[i].string()).cloud; },
      learn ? 1 : kPlaces);
}
BENCHMARK(BM_FindModel)
    ->ArgName("learn")
    ->Arg(1)
    ->Arg(0)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

void BM_FindModelOnDrawnTables(benchmark::State& state) {
  run(
      state, kDrawn, [](std::size_t i) { return drawTable(i + 1); }, 1);
}
BENCHMARK(BM_FindModelOnDrawnTables)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
