// Time of a signature and of a whole frame, 640 x 480, one thread.
#include <benchmark/benchmark.h>

#include <opencv2/imgproc.hpp>

#include "../test/transcription/plain_lbp.hpp"
#include "drawn_scene.hpp"
#include "hyselam_common/rng.hpp"
#include "selovis/recognition/image_recognizer.hpp"

namespace {

using namespace selovis;  // NOLINT: a program, not a header

/// Walls of several colours with soft shades, noise and sharp edges: a room as far as histograms
/// go.
cv::Mat scene(std::uint64_t seed) {
  hyselam::Rng rng(seed);
  cv::Mat image = drawnScene(rng);
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.0);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < 3 * image.cols; ++x) {
      std::uint8_t& v = image.ptr<std::uint8_t>(y)[x];
      const int slope = x / 60;
      v = cv::saturate_cast<std::uint8_t>(v + slope + rng.gaussian(0.0, 2.0));
    }
  }
  return image;
}

void describe(benchmark::State& state, const std::string& name) {
  const cv::Mat image = scene(1);
  SensorReadings readings;
  for (int i = 0; i < 60; ++i) readings.ranges.push_back(0.5f + 0.05f * static_cast<float>(i));
  readings.scan.assign(181, 2.0f);
  const auto d = makeDescriptor(name);
  std::vector<float> out(static_cast<std::size_t>(d->size()));
  for (auto _ : state) {
    d->compute(image, readings, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  if (name != "HSV-LBP") state.SetLabel("baseline=lbpbyhsv/HSV-LBP_transcription");
}

/// HSV-LBP as one would write it down: a mean and eight comparisons per pixel and channel.
void plainHsvLbp(benchmark::State& state) {
  const cv::Mat image = scene(1);
  cv::Mat hsv;
  std::vector<int> h(768);
  for (auto _ : state) {
    cv::cvtColor(image, hsv, cv::COLOR_BGR2HSV);
    for (int c = 0; c < 3; ++c) {
      for (int y = 3; y < hsv.rows - 3; ++y) {
        for (int x = 3; x < hsv.cols - 3; ++x) {
          int sum = 0;
          for (int dy = -3; dy <= 3; ++dy) {
            for (int dx = -3; dx <= 3; ++dx) {
              if (dx * dx + dy * dy <= 9) sum += hsv.ptr<cv::Vec3b>(y + dy)[x + dx][c];
            }
          }
          static const int kX[8] = {3, 2, 0, -2, -3, -2, 0, 2}, kY[8] = {0, -2, -3, -2, 0, 2, 3, 2};
          int code = 0;
          for (int p = 0; p < 8; ++p) {
            code |= (29 * hsv.ptr<cv::Vec3b>(y + kY[p])[x + kX[p]][c] >= sum) << p;
          }
          ++h[static_cast<std::size_t>(c * 256 + code)];
        }
      }
    }
    benchmark::DoNotOptimize(h.data());
  }
}

/// HSV-LBP out of OpenCV's own functions: filter2D, compare, bitwise_or, calcHist.
void openCvHsvLbp(benchmark::State& state) {
  const cv::Mat image = scene(1);
  cv::Mat kernel(7, 7, CV_32F);
  for (int y = -3; y <= 3; ++y) {
    for (int x = -3; x <= 3; ++x)
      kernel.at<float>(y + 3, x + 3) = x * x + y * y <= 9 ? 1.0f / 29 : 0.0f;
  }
  const int dx[8] = {3, 2, 0, -2, -3, -2, 0, 2}, dy[8] = {0, -2, -3, -2, 0, 2, 3, 2};
  cv::Mat hsv, mean, bit, code;
  std::vector<cv::Mat> channels;
  cv::Mat histogram;
  for (auto _ : state) {
    cv::cvtColor(image, hsv, cv::COLOR_BGR2HSV);
    cv::split(hsv, channels);
    for (const cv::Mat& channel : channels) {
      cv::filter2D(channel, mean, CV_8U, kernel);
      const cv::Rect inner(3, 3, channel.cols - 6, channel.rows - 6);
      code = cv::Mat::zeros(inner.size(), CV_8U);
      for (int p = 0; p < 8; ++p) {
        cv::compare(channel(inner + cv::Point(dx[p], dy[p])), mean(inner), bit, cv::CMP_GE);
        cv::bitwise_and(bit, cv::Scalar(1 << p), bit);
        cv::bitwise_or(code, bit, code);
      }
      const int size = 256;
      const float range[] = {0.0f, 256.0f};
      const float* ranges = range;
      cv::calcHist(&code, 1, nullptr, cv::Mat(), histogram, 1, &size, &ranges);
      benchmark::DoNotOptimize(histogram.data);
    }
  }
  state.SetLabel("baseline=lbpbyhsv/HSV-LBP_transcription");
}

/// Frame to place: descriptor, classifier, chain over 14 places, 700 training frames.
void frameToPlace(benchmark::State& state, const std::string& name, SvmKernel kernel) {
  constexpr int kPlaces = 14, kPerPlace = 50;
  TrainingOptions options;
  options.descriptor = name;
  options.classifier.kernel = kernel;
  if (kernel == SvmKernel::kExemplar) options.views = {0.0, -0.09, 0.09, -0.18, 0.18};
  std::vector<cv::Mat> scenes;  // small: training needs no more
  for (std::size_t place = 0; place < kPlaces; ++place) {
    scenes.emplace_back();
    cv::resize(scene(place), scenes.back(), cv::Size(160, 120), 0.0, 0.0, cv::INTER_AREA);
  }
  const PlaceModel model = trainPlaceModel(
      {kPlaces * kPerPlace},
      [&](std::size_t, std::size_t i) {
        // One scene per place, turned a little from frame to frame, some pixels new each time.
        const std::size_t place = i / kPerPlace;
        cv::Mat image = shifted(scenes[place], 0.004 * static_cast<double>(i % kPerPlace)).clone();
        hyselam::Rng rng(i);
        for (int k = 0; k < 4000; ++k) {
          image.ptr<std::uint8_t>(static_cast<int>(rng.below(120)))[rng.below(480)] =
              static_cast<std::uint8_t>(rng.below(256));
        }
        return TrainingFrame{image, {}, "place " + std::to_string(place)};
      },
      options);
  ImageRecognizer recognizer(model, model.transitions, {});
  const cv::Mat image = scene(3);
  for (auto _ : state) benchmark::DoNotOptimize(recognizer.update(image));
  state.counters["frames_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

const int registered = [] {
  using benchmark::kMillisecond;
  benchmark::RegisterBenchmark("lbpbyhsv/HSV-LBP_transcription", plainHsvLbp)->Unit(kMillisecond);
  benchmark::RegisterBenchmark("lbpbyhsv/HSV-LBP_OpenCV", openCvHsvLbp)->Unit(kMillisecond);
  for (const char* name :
       {"LBPbyHSV-U8N", "LBPbyHSV-U8U", "LBPbyHSV-U8S", "LBPbyHSV-U16N", "LBPbyHSV-U16S",
        "LBPbyHSV-U8N-D", "LBPbyHSV-U8N-IRIS", "LBPbyHSV-U8N-IRIS-VP", "sLBP-(N)LRF20",
        "sLBP-(A)LRF20", "sLBP-(S)LRF20", "HSV-LBP", "SLBP", "CENTRIST", "HSV-GIST", "LGOP",
        "GLANCE"}) {
    benchmark::RegisterBenchmark((std::string("lbpbyhsv/") + name).c_str(),
                                 [name](benchmark::State& s) { describe(s, name); })
        ->Unit(kMillisecond);
  }
  for (const SvmKernel kernel : {SvmKernel::kLinear, SvmKernel::kPoly, SvmKernel::kRbf}) {
    benchmark::RegisterBenchmark(
        (std::string("lbpbyhsv/frame_to_place/hLBP/") + toString(kernel)).c_str(),
        [kernel](benchmark::State& s) { frameToPlace(s, "hLBP", kernel); })
        ->Unit(kMillisecond);
  }
  benchmark::RegisterBenchmark("lbpbyhsv/frame_to_place/GLANCE/exemplar", [](benchmark::State& s) {
    frameToPlace(s, "GLANCE", SvmKernel::kExemplar);
  })->Unit(kMillisecond);
  return 0;
}();

}  // namespace
