// Time from a frame to its place with 7000 learned frames, five views each: by the index of each
// part, and by a full scan of all views; and from there to the poses that the frame may show
// instead.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "../src/core/classifiers/fusion_classifier.hpp"
#include "drawn_scene.hpp"
#include "hyselam_common/rng.hpp"
#include "selovis/descriptors/descriptor.hpp"
#include "selovis/filters/learned_views.hpp"

namespace {

using namespace selovis;  // NOLINT: a program, not a header

constexpr int kFrames = 7000, kViews = 5, kPlaces = 70, kScenes = 140, kCalibrated = 400;

cv::Mat scene(std::uint64_t seed, const cv::Size& size) {
  hyselam::Rng rng(seed);
  cv::Mat sized;
  cv::resize(drawnScene(rng), sized, size, 0.0, 0.0, cv::INTER_AREA);
  return sized;
}

/// Frames between two scenes of their place, each view and value a little different.
Samples learned(int frames) {
  const auto descriptor = makeDescriptor("FUSION-LEARNT");
  std::vector<std::vector<float>> scenes;
  for (int i = 0; i < kScenes; ++i) {
    scenes.push_back(descriptor->compute(scene(static_cast<std::uint64_t>(i) + 1, {160, 120})));
  }
  Samples samples;
  samples.size = static_cast<std::size_t>(descriptor->size());
  samples.parts = descriptor->parts();
  samples.values.reserve(samples.size * static_cast<std::size_t>(frames * kViews));
  hyselam::Rng rng(1);
  std::vector<float> noise(4096), signature(samples.size);
  for (float& n : noise) n = static_cast<float>(1.0 + 0.2 * rng.gaussian());
  for (int f = 0; f < frames; ++f) {
    const int place = f * kPlaces / frames;
    const auto &a = scenes[static_cast<std::size_t>(2 * place)],
               &b = scenes[static_cast<std::size_t>(2 * place + 1)];
    for (int v = 0; v < kViews; ++v) {
      const float share = static_cast<float>(rng.uniform());
      const std::size_t offset = rng.below(4096);
      for (std::size_t k = 0; k < signature.size(); ++k) {
        signature[k] = (share * a[k] + (1.0f - share) * b[k]) * noise[(offset + 7 * k) % 4096];
      }
      samples.add(signature.data(), place, f, {0.2 * f, 0.0, 0.1 * v});
    }
  }
  return samples;
}

ClassifierParams fusion() {
  ClassifierParams params;
  params.kernel = SvmKernel::kFusion;
  return params;
}

const Samples& many() {
  static const Samples samples = learned(kFrames);
  return samples;
}

const std::string& calibration() {
  static const std::string state =
      FusionClassifier(learned(kCalibrated), kPlaces, fusion()).state();
  return state;
}

/// Signature, places, and the distances that the filter over poses takes.
void frameToPlace(benchmark::State& state, bool full_scan) {
  FusionClassifier classifier(many(), kPlaces, fusion(), calibration(), full_scan);
  const auto descriptor = makeDescriptor("FUSION-LEARNT");
  const cv::Mat image = scene(3, {640, 480});
  std::vector<float> signature(static_cast<std::size_t>(descriptor->size()));
  std::vector<double> probabilities(kPlaces);
  for (auto _ : state) {
    descriptor->compute(image, {}, signature.data());
    classifier.predict(signature.data(), probabilities.data());
    benchmark::DoNotOptimize(classifier.distances());
  }
  if (!full_scan) state.SetLabel("baseline=fusion/frame_to_place_7000/full_scan");
}

/// The same, without the signature.
void search(benchmark::State& state, bool full_scan) {
  FusionClassifier classifier(many(), kPlaces, fusion(), calibration(), full_scan);
  const auto signature = makeDescriptor("FUSION-LEARNT")->compute(scene(3, {640, 480}));
  std::vector<double> probabilities(kPlaces);
  for (auto _ : state) {
    classifier.predict(signature.data(), probabilities.data());
    benchmark::DoNotOptimize(classifier.distances());
  }
  if (!full_scan) state.SetLabel("baseline=fusion/search_7000/full_scan");
}

/// The 40 views elsewhere that look most like a frame: among all in order, or with a position asked
/// for only where it matters.
void rivals(benchmark::State& state, bool all) {
  FusionClassifier classifier(many(), kPlaces, fusion(), calibration(), false);
  const auto signature = makeDescriptor("FUSION-LEARNT")->compute(scene(3, {640, 480}));
  std::vector<double> probabilities(kPlaces);
  classifier.predict(signature.data(), probabilities.data());
  LearnedViews views(many(), 2.0, hyselam::radians(18.0));
  const hyselam::Pose2 camera{700.0, 0.0, 0.0};
  const auto elsewhere = [&](const LearnedViews::View& v) {
    const hyselam::Pose2 pose = views.poseOf(v);
    return hyselam::distance(pose, camera) >= 3.0 ||
           std::abs(hyselam::normalizeAngle(pose.theta - camera.theta)) >= 1.0;
  };
  std::vector<std::uint32_t> found;
  for (auto _ : state) {
    views.compare(*classifier.distances(), 1.5);
    if (all) {
      found.clear();
      for (std::uint32_t v = 0; v < views.views().size(); ++v) {
        if (elsewhere(views.views()[v])) found.push_back(v);
      }
      std::partial_sort(found.begin(), found.begin() + 40, found.end(),
                        [&](std::uint32_t a, std::uint32_t b) {
                          const double s = views.similarity(views.views()[a]),
                                       t = views.similarity(views.views()[b]);
                          return s != t ? s > t : a < b;
                        });
      found.resize(40);
    } else {
      views.mostSimilar(40, elsewhere, &found);
    }
    benchmark::DoNotOptimize(found.data());
  }
  if (!all) state.SetLabel("baseline=fusion/rivals_7000/all");
}

const int registered = [] {
  using benchmark::kMillisecond;
  for (const bool full_scan : {true, false}) {
    const std::string kind = full_scan ? "full_scan" : "index";
    benchmark::RegisterBenchmark(("fusion/frame_to_place_7000/" + kind).c_str(),
                                 [full_scan](benchmark::State& s) { frameToPlace(s, full_scan); })
        ->Unit(kMillisecond);
    benchmark::RegisterBenchmark(("fusion/search_7000/" + kind).c_str(), [full_scan](
                                                                             benchmark::State& s) {
      search(s, full_scan);
    })->Unit(kMillisecond);
  }
  for (const bool all : {true, false}) {
    benchmark::RegisterBenchmark(
        (std::string("fusion/rivals_7000/") + (all ? "all" : "most_similar")).c_str(),
        [all](benchmark::State& s) { rivals(s, all); })
        ->Unit(kMillisecond);
  }
  return 0;
}();

}  // namespace
