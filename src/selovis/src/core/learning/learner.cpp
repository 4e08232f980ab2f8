#include "selovis/learning/learner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "empty_model.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {

using hyselam::InputError;

namespace {

constexpr double kMaxPause = 5.0;  // [s] between two frames that are consecutive
// A robot that has collected nothing for so long [s] begins another tour: the light may be another.
constexpr double kTourPause = 600.0;

hyselam_topo::Place* findPlace(hyselam_topo::AugmentedTopologicalMap& map,
                               const std::string& name) {
  for (auto& place : map.places) {
    if (hyselam_topo::nameOf(place) == name) return &place;
  }
  return nullptr;
}

void addSamples(PlaceModel& model, const LearnedFrame& frame, int place, int number) {
  for (std::size_t v = 0; v < frame.signatures.size(); ++v) {
    const auto& signature = frame.signatures[v];
    if (signature.size() != model.samples.size) {
      throw InputError("learned frame", "",
                       "has a signature of " + std::to_string(signature.size()) +
                           " values, but the model's have " + std::to_string(model.samples.size));
    }
    const double shift = v < model.views.size() ? model.views[v] : 0.0;
    model.samples.add(signature.data(), place, number,
                      poseOfView(frame.camera, shift, model.horizontal_fov));
  }
}

}  // namespace

void LearnerParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("min_travel", min_travel, Range::between(0.0, 100.0), "m", "between learned frames");
  visit("min_turn", min_turn, Range::between(0.0, 7.0), "rad", "or so much turn");
  visit("horizontal_fov", horizontal_fov, Range::between(0.01, 2.0 * hyselam::kPi), "rad",
        "field of view of a camera without camera_info");
  visit("vertical_fov", vertical_fov, Range::between(0.01, 2.0 * hyselam::kPi), "rad",
        "field of view of a camera without camera_info");
  visit("max_frames", max_frames, Range::between(1, 1e6), "", "frames collected at most");
}

void LearnerParams::validate() const {
  hyselam::checkParameters(*this);
}

PlaceModel untrainedPlaceModel(const TrainingOptions& options) {
  PlaceModel model = emptyModel(options);
  const auto descriptor = makeDescriptor(options.descriptor, options.descriptor_params);
  if (descriptor->needsDictionary()) {
    throw InputError("descriptor '" + options.descriptor + "'", "",
                     "needs a dictionary: begin with a model that `train` made");
  }
  model.samples.size = static_cast<std::size_t>(descriptor->size());
  model.samples.parts = descriptor->parts();
  return model;
}

PlaceModel learnFrames(PlaceModel model, const std::vector<LearnedFrame>& frames) {
  model.reliability = {};
  PlaceTransitions& transitions = model.transitions;
  int number = model.samples.frames.empty() ? 0 : model.samples.frames.back() + 1;
  int last_place = model.samples.places.empty() ? -1 : model.samples.places.back();
  for (const LearnedFrame& frame : frames) {
    if (frame.place.empty()) throw InputError("learned frame", "", "has no place");
    int place = transitions.indexOf(frame.place);
    if (place < 0) {
      place = static_cast<int>(transitions.places.size());
      transitions.places.push_back(frame.place);
    }
    // Not known (NaN) after a model was loaded: what is learned now is another tour.
    const double elapsed = frame.stamp - model.learned_until;
    if (last_place < 0) {
      // The first frame.
    } else if (!(elapsed >= 0.0 && elapsed <= kTourPause)) {
      number += kTourGap;
    } else if (elapsed > kMaxPause) {
      number += kPauseGap;
    } else if (place != last_place && !transitions.connected(place, last_place)) {
      transitions.pairs.emplace_back(std::min(place, last_place), std::max(place, last_place));
    }
    addSamples(model, frame, place, number);
    ++number;
    model.learned_until = frame.stamp;
    last_place = place;
  }
  model.svm =
      trainClassifier(model.samples, static_cast<int>(transitions.places.size()), model.classifier)
          .state;
  return model;
}

std::size_t storeSignatures(const std::vector<LearnedFrame>& frames, const PlaceModel& model,
                            const LearnerParams& params,
                            hyselam_topo::AugmentedTopologicalMap& map) {
  std::size_t unknown = 0;
  for (const LearnedFrame& frame : frames) {
    hyselam_topo::Place* place = findPlace(map, frame.place);
    if (place == nullptr) {
      ++unknown;
      continue;
    }
    for (std::size_t v = 0; v < frame.signatures.size(); ++v) {
      hyselam_topo::VisualSignature signature;
      signature.appearance = {model.descriptor, 1, static_cast<int>(frame.signatures[v].size()),
                              frame.signatures[v]};
      signature.position = {frame.camera.x, frame.camera.y, frame.height};
      const double shift = v < model.views.size() ? model.views[v] : 0.0;
      signature.heading = poseOfView(frame.camera, shift, params.horizontal_fov).theta;
      signature.aperture_x = params.horizontal_fov;
      signature.aperture_y = params.vertical_fov;
      signature.stamp = frame.stamp;
      place->signatures.push_back(std::move(signature));
    }
  }
  return unknown;
}

std::vector<LearnedFrame> framesFromMap(const hyselam_topo::AugmentedTopologicalMap& map,
                                        const PlaceModel& model) {
  std::vector<LearnedFrame> frames;
  for (const auto& place : map.places) {
    const std::string name = hyselam_topo::nameOf(place);
    std::size_t first = frames.size();
    for (const auto& signature : place.signatures) {
      if (signature.appearance.type != model.descriptor ||
          signature.appearance.values.size() != model.samples.size) {
        continue;
      }
      // Views of one image share its time.
      if (frames.size() == first || frames.back().stamp != signature.stamp) {
        LearnedFrame frame;
        frame.place = name;
        frame.stamp = signature.stamp;
        // Without a heading the pose is not known.
        frame.camera = signature.heading ? hyselam::Pose2{signature.position.x,
                                                          signature.position.y, *signature.heading}
                                         : kNoPose;
        frame.height = signature.position.z;
        frames.push_back(std::move(frame));
      }
      frames.back().signatures.push_back(signature.appearance.values);
    }
  }
  std::stable_sort(frames.begin(), frames.end(),
                   [](const LearnedFrame& a, const LearnedFrame& b) { return a.stamp < b.stamp; });
  return frames;
}

Learner::Learner(std::shared_ptr<const PlaceModel> model, const LearnerParams& params)
    : model_(std::move(model)), params_(params), descriptor_(model_->makeDescriptor()) {
  params.validate();
}

bool Learner::add(const cv::Mat& image, const SensorReadings& readings, const std::string& place,
                  const hyselam::Pose2& camera, double height, double stamp) {
  if (frames_.size() >= params_.max_frames) return false;
  if (!frames_.empty() && frames_.back().place == place) {
    const hyselam::Pose2 moved = hyselam::between(frames_.back().camera, camera);
    if (std::hypot(moved.x, moved.y) < params_.min_travel &&
        std::abs(moved.theta) < params_.min_turn) {
      return false;
    }
  }
  LearnedFrame frame;
  frame.place = place;
  frame.stamp = stamp;
  frame.camera = camera;
  frame.height = height;
  for (const double view : model_->views) {
    frame.signatures.push_back(
        descriptor_->compute(view == 0.0 ? image : shifted(image, view), readings));
  }
  frames_.push_back(std::move(frame));
  return true;
}

void Learner::rename(const std::vector<PlaceRenaming>& renamings) {
  for (auto& frame : frames_) {
    const auto renaming =
        std::find_if(renamings.begin(), renamings.end(),
                     [&](const PlaceRenaming& r) { return r.from == frame.place; });
    if (renaming != renamings.end()) frame.place = renaming->to;
  }
}

}  // namespace selovis
