#include "selovis/recogniser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr double kTimeBack = 0.5;  // [s] frames may be so late

}  // namespace

Recogniser::Recogniser(const Model& model, const PlaceGraph& graph, const RecogniserParams& params)
    : params_(params),
      places_(model.graph.places),
      descriptor_(model.makeDescriptor()),
      classifier_(model.makeClassifier()),
      descriptive_(params.descriptive),
      graph_(graph),
      filter_(graph, params.filter),
      last_stamp_(std::numeric_limits<double>::quiet_NaN()),
      signature_(static_cast<std::size_t>(descriptor_->size())),
      frame_(places_.size(), 0.0) {
  if (graph.places != places_) {
    throw std::invalid_argument("the graph's places are not those of the model");
  }
  if (!(params.novelty_max >= 0.0)) {
    throw hyselam::ParameterError("novelty_max", params.novelty_max, "0 or more");
  }
  if (params.filter.kind == FilterKind::kPoses) {
    if (classifier_->distances() == nullptr) {
      throw std::invalid_argument("the filter 'poses' needs a model with the exemplar kernel");
    }
    poses_ =
        std::make_unique<PoseFilter>(model.samples, static_cast<int>(places_.size()), params.poses);
  }
}

void Recogniser::reset() {
  filter_.reset();
  if (poses_) poses_->reset();
  last_stamp_ = std::numeric_limits<double>::quiet_NaN();
}

Recognition Recogniser::update(const cv::Mat& image, const Readings& readings) {
  if (!descriptive_.accepts(image)) {
    Recognition result;
    result.descriptive = false;
    result.estimate = estimate();
    filter_.skip();
    return result;
  }
  descriptor_->compute(image, readings, signature_.data());
  return updateWithSignature(signature_.data(), readings);
}

Recognition Recogniser::updateWithSignature(const float* signature, const Readings& readings) {
  Recognition result;
  classifier_->predict(signature, frame_.data());
  result.novelty = classifier_->novelty();
  if (params_.novelty_max > 0.0 && result.novelty > params_.novelty_max) {
    result.novel = true;
    filter_.skip();
    return result;  // the place is unknown
  }
  result.frame_place =
      static_cast<int>(std::max_element(frame_.begin(), frame_.end()) - frame_.begin());
  if (poses_) {
    const double seconds = readings.stamp - last_stamp_;
    if (seconds < -kTimeBack) poses_->reset();  // another drive
    poses_->update(*classifier_->distances(), readings.odometry,
                   std::isfinite(seconds) ? seconds : 1.0);
    // A late frame's time is no step back: the next would count twice.
    if (!(seconds < 0.0 && seconds >= -kTimeBack)) last_stamp_ = readings.stamp;
  } else {
    filter_.update(frame_.data());
  }
  result.estimate = estimate();
  return result;
}

}  // namespace selovis
