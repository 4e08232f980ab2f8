#include "selovis/recognition/image_recognizer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr double kMaxLateness = 0.5;  // [s] a frame that is older than the last by more: a new run
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void ImageRecognizerParams::describe(hyselam::ParameterVisitor& visit) {
  visit.group("", descriptive);
  visit.group("", filter);
  visit("max_novelty", max_novelty, hyselam::Range::atLeast(0.0), "",
        "distance to the nearest learned image, in typical ones, above which the place is "
        "unknown; 0: never");
  visit.group("pose_", poses);
}

void ImageRecognizerParams::validate() const {
  hyselam::checkParameters(*this);
}

ImageRecognizer::ImageRecognizer(const PlaceModel& model, const PlaceTransitions& transitions,
                                 const ImageRecognizerParams& params)
    : params_(params),
      places_(model.transitions.places),
      descriptor_(model.makeDescriptor()),
      classifier_(model.makeClassifier()),
      descriptive_(params.descriptive),
      transitions_(transitions),
      filter_(transitions, params.filter),
      last_stamp_(kNaN),
      signature_(static_cast<std::size_t>(descriptor_->size())),
      frame_(places_.size(), 0.0) {
  params.validate();
  if (transitions.places != places_) {
    throw hyselam::InputError("transitions", "", "their places are not those of the model");
  }
  if (params.filter.kind == PlaceFilterKind::kPoses) {
    if (!comparesExemplars(model.classifier.kernel)) {
      throw hyselam::InputError("filter 'poses'", "",
                                "needs a model with the kernel fusion or exemplar");
    }
    by_poses_ = true;
  }
  const auto& learned = model.samples.poses;
  const bool has_poses =
      comparesExemplars(model.classifier.kernel) &&
      std::any_of(learned.begin(), learned.end(), [](const auto& p) { return p.isFinite(); });
  const bool automatic = params.filter.kind == PlaceFilterKind::kAuto && has_poses;
  if (automatic) poses_problem_ = PoseFilter::whyNot(model.samples);
  if (by_poses_ || (automatic && poses_problem_.empty())) {
    poses_ =
        std::make_unique<PoseFilter>(model.samples, static_cast<int>(places_.size()), params.poses);
  }
}

void ImageRecognizer::reset() {
  filter_.reset();
  if (poses_) poses_->reset();
  last_stamp_ = kNaN;
}

Recognition ImageRecognizer::update(const cv::Mat& image, const SensorReadings& readings) {
  if (!descriptive_.accepts(image)) {
    Recognition result;
    result.descriptive = false;
    result.estimate = estimate();
    return result;
  }
  descriptor_->compute(image, readings, signature_.data());
  return updateWithSignature(signature_.data(), readings);
}

Recognition ImageRecognizer::updateWithSignature(const float* signature,
                                                 const SensorReadings& readings) {
  Recognition result;
  classifier_->predict(signature, frame_.data());
  result.novelty = classifier_->novelty();
  if (params_.max_novelty > 0.0 && result.novelty > params_.max_novelty) {
    result.novel = true;
    return result;
  }
  result.frame_place =
      static_cast<int>(std::max_element(frame_.begin(), frame_.end()) - frame_.begin());
  const bool choose = params_.filter.kind == PlaceFilterKind::kAuto;
  if (choose) by_poses_ = poses_ && readings.odometry && readings.odometry->isFinite();
  if (by_poses_) updatePoses(readings);
  if (choose || !by_poses_) filter_.update(frame_.data());
  result.estimate = estimate();
  return result;
}

bool ImageRecognizer::lightIsUnlearned() const {
  const std::vector<PartOpinion>* opinions = classifier_->opinions();
  if (opinions == nullptr) return false;
  int colors = 0, others = 0, colors_out = 0, others_out = 0;
  for (const PartOpinion& o : *opinions) {
    (o.absolute_color ? colors : others) += 1;
    (o.absolute_color ? colors_out : others_out) += o.out_of_range;
  }
  return 2 * colors_out > colors && 2 * others_out < others;
}

void ImageRecognizer::updatePoses(const SensorReadings& readings) {
  const double seconds = readings.stamp - last_stamp_;
  if (seconds < -kMaxLateness) poses_->reset();
  poses_->update(*classifier_->distances(), readings.odometry,
                 std::isfinite(seconds) ? seconds : 1.0);
  // The time of a late frame is not taken: the interval to the next frame would count twice.
  if (!(seconds < 0.0 && seconds >= -kMaxLateness)) last_stamp_ = readings.stamp;
}

}  // namespace selovis
