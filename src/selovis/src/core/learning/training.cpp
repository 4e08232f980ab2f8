#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "empty_model.hpp"
#include "hyselam_common/errors.hpp"
#include "selovis/learning/error_source.hpp"
#include "selovis/learning/place_model.hpp"

namespace selovis {

using hyselam::InputError;

namespace {

int classOf(PlaceModel& model, const std::string& place) {
  const int known = model.transitions.indexOf(place);
  if (known >= 0) return known;
  if (place.empty()) throw InputError("training frame", "", "has no place");
  model.transitions.places.push_back(place);
  return static_cast<int>(model.transitions.places.size()) - 1;
}

std::size_t sum(const std::vector<std::size_t>& counts) {
  std::size_t all = 0;
  for (const std::size_t n : counts) all += n;
  return all;
}

// A dictionary is learned from at most so many images, evenly chosen.
constexpr std::size_t kDictionaryImages = 300;

void learnDictionary(Descriptor& descriptor, const std::vector<std::size_t>& tours,
                     const LoadFrame& load, const TrainingOptions& options) {
  std::vector<cv::Mat> images;
  const std::size_t step = std::max<std::size_t>(1, sum(tours) / kDictionaryImages);
  std::size_t index = 0;
  for (std::size_t t = 0; t < tours.size(); ++t) {
    for (std::size_t i = 0; i < tours[t]; ++i, ++index) {
      if (index % step == 0) images.push_back(load(t, i).image);
    }
  }
  descriptor.learnDictionary(images, options.seed);
}

void addSignatures(PlaceModel& model, Descriptor& descriptor, const std::vector<std::size_t>& tours,
                   const LoadFrame& load, const TrainingOptions& options) {
  const std::size_t all = sum(tours);
  std::vector<float> signature(static_cast<std::size_t>(descriptor.size()));
  int frame = model.samples.frames.empty() ? 0 : model.samples.frames.back() + kTourGap;
  std::size_t done = 0;
  for (std::size_t t = 0; t < tours.size(); ++t, frame += kTourGap) {
    std::vector<int> tour;
    for (std::size_t i = 0; i < tours[t]; ++i, ++frame) {
      if (options.progress) options.progress("signatures", done++, all);
      const TrainingFrame f = load(t, i);
      const int place = classOf(model, f.place);
      tour.push_back(place);
      withSource(f.source.empty() ? "training frame" : f.source, [&] {
        for (const double view : model.views) {
          descriptor.compute(view == 0.0 ? f.image : shifted(f.image, view), f.readings,
                             signature.data());
          model.samples.add(signature.data(), place, frame,
                            poseOfView(f.pose, view, model.horizontal_fov));
        }
      });
    }
    for (const auto& edge : transitionsOfTours(model.transitions.places, {tour}).pairs) {
      if (!model.transitions.connected(edge.first, edge.second))
        model.transitions.pairs.push_back(edge);
    }
  }
  if (options.progress) options.progress("signatures", all, all);
}

void fitClassifier(PlaceModel& model, const TrainingOptions& options) {
  const int places = static_cast<int>(model.transitions.places.size());
  if (options.grid_search) {
    const auto progress = [&](std::size_t done, std::size_t all) {
      if (options.progress) options.progress("grid search", done, all);
    };
    model.classifier =
        searchGrid(model.samples, places, options.grid, model.classifier, progress).params;
  }
  model.svm = trainClassifier(model.samples, places, model.classifier, options.libsvm_file).state;
}

void checkViews(const std::vector<double>& views) {
  for (const double v : views) {
    if (!(std::abs(v) <= 0.5)) throw InputError("views", "", "one is shifted by more than half");
  }
}

}  // namespace

std::vector<double> exemplarViews() {
  return {0.0, -0.09, 0.09, -0.18, 0.18};
}

std::vector<double> viewsFor(SvmKernel kernel) {
  return comparesExemplars(kernel) ? exemplarViews() : std::vector<double>{0.0};
}

hyselam::Pose2 poseOfView(const hyselam::Pose2& camera, double shift, double horizontal_fov) {
  return {camera.x, camera.y, hyselam::normalizeAngle(camera.theta + shift * horizontal_fov)};
}

cv::Mat shifted(const cv::Mat& image, double shift) {
  const int pixels = static_cast<int>(std::lround(shift * image.cols));
  if (pixels == 0 || std::abs(pixels) >= image.cols) return image;
  cv::Mat out;
  if (pixels > 0) {
    cv::copyMakeBorder(image.colRange(0, image.cols - pixels), out, 0, 0, pixels, 0,
                       cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
  } else {
    cv::copyMakeBorder(image.colRange(-pixels, image.cols), out, 0, 0, 0, -pixels,
                       cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
  }
  return out;
}

std::unique_ptr<Descriptor> PlaceModel::makeDescriptor() const {
  auto d = selovis::makeDescriptor(descriptor, descriptor_params);
  if (!dictionary.empty() || d->needsDictionary()) d->setDictionary(dictionary);
  return d;
}

std::unique_ptr<Classifier> PlaceModel::makeClassifier() const {
  return restoreClassifier(samples, static_cast<int>(transitions.places.size()), classifier, svm);
}

PlaceModel trainPlaceModel(const std::vector<std::size_t>& frames_of_tours, const LoadFrame& load,
                           const TrainingOptions& options) {
  checkViews(options.views);
  PlaceModel model = emptyModel(options);
  auto descriptor = makeDescriptor(options.descriptor, options.descriptor_params);
  if (descriptor->needsDictionary()) {
    learnDictionary(*descriptor, frames_of_tours, load, options);
    model.dictionary = descriptor->dictionary();
  }
  model.samples.size = static_cast<std::size_t>(descriptor->size());
  model.samples.parts = descriptor->parts();
  addSignatures(model, *descriptor, frames_of_tours, load, options);
  fitClassifier(model, options);
  return model;
}

PlaceModel extendPlaceModel(PlaceModel model, const std::vector<std::size_t>& frames_of_tours,
                            const LoadFrame& load, const TrainingOptions& options) {
  addSignatures(model, *model.makeDescriptor(), frames_of_tours, load, options);
  model.learned_until = std::numeric_limits<double>::quiet_NaN();
  model.reliability = {};
  fitClassifier(model, options);
  return model;
}

}  // namespace selovis
