#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "selovis/model.hpp"

namespace selovis {
namespace {

using Load = std::function<TrainingFrame(std::size_t, std::size_t)>;

int classOf(Model& model, const std::string& place) {
  const int known = model.graph.find(place);
  if (known >= 0) return known;
  if (place.empty()) throw std::invalid_argument("a place has no name");
  model.graph.places.push_back(place);
  return static_cast<int>(model.graph.places.size()) - 1;
}

std::size_t sum(const std::vector<std::size_t>& counts) {
  std::size_t all = 0;
  for (const std::size_t n : counts) all += n;
  return all;
}

/// A dictionary is learnt from at most so many images, evenly chosen.
constexpr std::size_t kDictionaryImages = 300;

void learnDictionary(Descriptor& descriptor, const std::vector<std::size_t>& tours,
                     const Load& load, const TrainingOptions& options) {
  std::vector<cv::Mat> images;
  const std::size_t step = std::max<std::size_t>(1, sum(tours) / kDictionaryImages);
  std::size_t index = 0;
  for (std::size_t t = 0; t < tours.size(); ++t) {
    for (std::size_t i = 0; i < tours[t]; ++i, ++index) {
      if (index % step == 0) images.push_back(load(t, i).image);
    }
  }
  descriptor.train(images, options.seed);
}

void describe(Model& model, Descriptor& descriptor, const std::vector<std::size_t>& tours,
              const Load& load, const TrainingOptions& options) {
  const std::size_t all = sum(tours);
  std::vector<float> signature(static_cast<std::size_t>(descriptor.size()));
  // A gap between tours and between trainings: neighbours in number are neighbours in time.
  int frame = model.samples.frames.empty() ? 0 : model.samples.frames.back() + 100;
  std::size_t done = 0;
  for (std::size_t t = 0; t < tours.size(); ++t, frame += 100) {
    std::vector<int> tour;
    for (std::size_t i = 0; i < tours[t]; ++i, ++frame) {
      if (options.progress) options.progress("signatures", done++, all);
      const TrainingFrame f = load(t, i);
      const int place = classOf(model, f.place);
      tour.push_back(place);
      for (const double view : model.views) {
        descriptor.compute(view == 0.0 ? f.image : shifted(f.image, view), f.readings,
                           signature.data());
        model.samples.add(signature.data(), place, frame, poseOfView(f.pose, view, model.aperture));
      }
    }
    for (const auto& edge : graphOfTours(model.graph.places, {tour}).transitions) {
      if (!model.graph.connected(edge.first, edge.second)) model.graph.transitions.push_back(edge);
    }
  }
  if (options.progress) options.progress("signatures", all, all);
}

void fit(Model& model, const TrainingOptions& options) {
  const int places = static_cast<int>(model.graph.places.size());
  if (options.grid_search) {
    searchGrid(model.samples, places, options.grid, model.classifier,
               [&](std::size_t done, std::size_t all) {
                 if (options.progress) options.progress("grid search", done, all);
               });
  }
  model.state.clear();
  trainClassifier(model.samples, places, model.classifier, &model.state, options.libsvm_file);
}

void checkViews(const std::vector<double>& views) {
  if (views.empty()) throw std::invalid_argument("there must be at least one view of each image");
  for (const double v : views) {
    if (!(std::abs(v) <= 0.5)) throw std::invalid_argument("a view is shifted by more than half");
  }
}

}  // namespace

std::vector<double> exemplarViews() {
  return {0.0, -0.09, 0.09, -0.18, 0.18};
}

hyselam::Pose2 poseOfView(const hyselam::Pose2& camera, double shift, double aperture) {
  return {camera.x, camera.y, hyselam::normalizeAngle(camera.theta + shift * aperture)};
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

std::unique_ptr<Descriptor> Model::makeDescriptor() const {
  auto d = selovis::makeDescriptor(descriptor, descriptor_params);
  if (!learnt.empty() || d->needsTraining()) d->setLearnt(learnt);
  return d;
}

std::unique_ptr<Classifier> Model::makeClassifier() const {
  return restoreClassifier(samples, static_cast<int>(graph.places.size()), classifier, state);
}

Model train(const std::vector<std::size_t>& frames_of_tours, const Load& load,
            const TrainingOptions& options) {
  checkViews(options.views);
  validate(options.classifier);
  Model model;
  model.descriptor = options.descriptor;
  model.descriptor_params = options.descriptor_params;
  model.classifier = options.classifier;
  model.views = options.views;
  model.aperture = options.aperture;
  auto descriptor = makeDescriptor(options.descriptor, options.descriptor_params);
  if (descriptor->needsTraining()) {
    learnDictionary(*descriptor, frames_of_tours, load, options);
    model.learnt = descriptor->learnt();
  }
  model.samples.size = static_cast<std::size_t>(descriptor->size());
  describe(model, *descriptor, frames_of_tours, load, options);
  fit(model, options);
  return model;
}

void addTo(Model& model, const std::vector<std::size_t>& frames_of_tours, const Load& load,
           const TrainingOptions& options) {
  describe(model, *model.makeDescriptor(), frames_of_tours, load, options);
  fit(model, options);
}

}  // namespace selovis
