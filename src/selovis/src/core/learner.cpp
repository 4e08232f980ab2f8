#include "selovis/learner.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr int kGap = 100;       // frame numbers between drives: they are no neighbours in time
constexpr double kPause = 5.0;  // [s] without frames: another drive

hyselam_topo::Place* findPlace(hyselam_topo::AugmentedTopologicalMap& map,
                               const std::string& name) {
  for (auto& place : map.places) {
    if (hyselam_topo::nameOf(place) == name) return &place;
  }
  return nullptr;
}

}  // namespace

void validate(const LearnerParams& p) {
  const auto check = [](const char* name, double value, bool good, const char* allowed) {
    if (!good || !std::isfinite(value)) throw hyselam::ParameterError(name, value, allowed);
  };
  check("min_travel", p.min_travel, p.min_travel >= 0.0, "0 or more");
  check("min_turn", p.min_turn, p.min_turn >= 0.0, "0 or more");
  for (const double a : {p.aperture_x, p.aperture_y}) {
    check("aperture", a, a > 0.0 && a <= 2.0 * hyselam::kPi, "above 0, at most 2 pi");
  }
  check("max_frames", static_cast<double>(p.max_frames), p.max_frames >= 1, "1 or more");
}

Model emptyModel(const TrainingOptions& options) {
  validate(options.classifier);
  Model model;
  model.descriptor = options.descriptor;
  model.descriptor_params = options.descriptor_params;
  model.classifier = options.classifier;
  model.views = options.views;
  model.aperture = options.aperture;
  const auto descriptor = makeDescriptor(options.descriptor, options.descriptor_params);
  if (descriptor->needsTraining()) {
    throw std::invalid_argument("descriptor '" + options.descriptor +
                                "' needs a dictionary: begin with a model that `train` made");
  }
  model.samples.size = static_cast<std::size_t>(descriptor->size());
  return model;
}

void learn(Model& model, const std::vector<LearntFrame>& frames) {
  int number = model.samples.frames.empty() ? 0 : model.samples.frames.back() + kGap;
  const LearntFrame* last = nullptr;
  int last_place = -1;
  for (const LearntFrame& frame : frames) {
    int place = model.graph.find(frame.place);
    if (place < 0) {
      if (frame.place.empty()) throw std::invalid_argument("a place has no name");
      place = static_cast<int>(model.graph.places.size());
      model.graph.places.push_back(frame.place);
    }
    const double gap = last == nullptr ? 0.0 : frame.stamp - last->stamp;
    if (gap < 0.0 || gap > kPause) {
      number += kGap;
    } else if (last != nullptr && place != last_place &&
               !model.graph.connected(place, last_place)) {
      model.graph.transitions.emplace_back(std::min(place, last_place),
                                           std::max(place, last_place));
    }
    for (std::size_t v = 0; v < frame.values.size(); ++v) {
      const auto& values = frame.values[v];
      if (values.size() != model.samples.size) {
        throw std::invalid_argument("a signature has " + std::to_string(values.size()) +
                                    " values, but the model's have " +
                                    std::to_string(model.samples.size));
      }
      const double shift = v < model.views.size() ? model.views[v] : 0.0;
      model.samples.add(values.data(), place, number,
                        poseOfView(frame.camera, shift, model.aperture));
    }
    ++number;
    last = &frame;
    last_place = place;
  }
  model.state.clear();
  trainClassifier(model.samples, static_cast<int>(model.graph.places.size()), model.classifier,
                  &model.state);
}

std::size_t store(const std::vector<LearntFrame>& frames, const Model& model,
                  const LearnerParams& params, hyselam_topo::AugmentedTopologicalMap* map) {
  std::size_t lost = 0;
  for (const LearntFrame& frame : frames) {
    hyselam_topo::Place* place = findPlace(*map, frame.place);
    if (place == nullptr) {
      ++lost;
      continue;
    }
    for (std::size_t v = 0; v < frame.values.size(); ++v) {
      hyselam_topo::VisualSignature signature;
      signature.appearance = {model.descriptor, 1, static_cast<int>(frame.values[v].size()),
                              frame.values[v]};
      signature.position = {frame.camera.x, frame.camera.y, frame.height};
      // What is seen farther right is seen by a camera turned to the left.
      const double shift = v < model.views.size() ? model.views[v] : 0.0;
      signature.heading = poseOfView(frame.camera, shift, params.aperture_x).theta;
      signature.aperture_x = params.aperture_x;
      signature.aperture_y = params.aperture_y;
      signature.stamp = frame.stamp;
      place->signatures.push_back(std::move(signature));
    }
  }
  return lost;
}

std::vector<LearntFrame> framesOf(const hyselam_topo::AugmentedTopologicalMap& map,
                                  const Model& model) {
  std::vector<LearntFrame> frames;
  for (const auto& place : map.places) {
    const std::string name = hyselam_topo::nameOf(place);
    std::size_t first = frames.size();
    for (const auto& signature : place.signatures) {
      if (signature.appearance.type != model.descriptor ||
          signature.appearance.values.size() != model.samples.size) {
        continue;
      }
      // Views of one picture share its time.
      if (frames.size() == first || frames.back().stamp != signature.stamp) {
        LearntFrame frame;
        frame.place = name;
        frame.stamp = signature.stamp;
        // Of a heading that nobody wrote down nothing may be thought.
        frame.camera = signature.heading ? hyselam::Pose2{signature.position.x,
                                                          signature.position.y, *signature.heading}
                                         : kNoPose;
        frame.height = signature.position.z;
        frames.push_back(std::move(frame));
      }
      frames.back().values.push_back(signature.appearance.values);
    }
  }
  std::stable_sort(frames.begin(), frames.end(),
                   [](const LearntFrame& a, const LearntFrame& b) { return a.stamp < b.stamp; });
  return frames;
}

Learner::Learner(std::shared_ptr<const Model> model, const LearnerParams& params)
    : model_(std::move(model)), params_(params), descriptor_(model_->makeDescriptor()) {
  validate(params);
}

bool Learner::add(const cv::Mat& image, const Readings& readings, const std::string& place,
                  const hyselam::Pose2& camera, double height, double stamp) {
  if (frames_.size() >= params_.max_frames) return false;
  if (!frames_.empty() && frames_.back().place == place) {
    const hyselam::Pose2 moved = hyselam::between(frames_.back().camera, camera);
    if (std::hypot(moved.x, moved.y) < params_.min_travel &&
        std::abs(moved.theta) < params_.min_turn) {
      return false;
    }
  }
  LearntFrame frame;
  frame.place = place;
  frame.stamp = stamp;
  frame.camera = camera;
  frame.height = height;
  for (const double view : model_->views) {
    frame.values.push_back(
        descriptor_->compute(view == 0.0 ? image : shifted(image, view), readings));
  }
  frames_.push_back(std::move(frame));
  return true;
}

void Learner::rename(const std::vector<Renaming>& renamings) {
  for (auto& frame : frames_) {
    const auto renaming = std::find_if(renamings.begin(), renamings.end(),
                                       [&](const Renaming& r) { return r.from == frame.place; });
    if (renaming != renamings.end()) frame.place = renaming->to;
  }
}

BackgroundTraining::~BackgroundTraining() {
  if (thread_.joinable()) thread_.join();
}

bool BackgroundTraining::busy() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return busy_;
}

bool BackgroundTraining::start(std::shared_ptr<const Model> model, std::vector<LearntFrame> frames,
                               std::function<void(const Outcome&)> done) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (busy_) return false;
    busy_ = true;
  }
  if (thread_.joinable()) thread_.join();
  const auto run = [this, model = std::move(model), frames = std::move(frames),
                    done = std::move(done)] {
    Outcome outcome;
    outcome.frames = frames.size();
    try {
      auto trained = std::make_shared<Model>(*model);
      learn(*trained, frames);
      outcome.model = std::move(trained);
    } catch (const std::exception& e) {
      outcome.error = e.what();
    }
    try {
      done(outcome);
    } catch (const std::exception&) {
      // Nobody is left to be told.
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    busy_ = false;
  };
  try {
    thread_ = std::thread(run);
  } catch (const std::system_error&) {
    const std::lock_guard<std::mutex> lock(mutex_);
    busy_ = false;
    return false;
  }
  return true;
}

}  // namespace selovis
