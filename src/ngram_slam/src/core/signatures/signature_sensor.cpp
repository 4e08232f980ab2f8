#include "ngram_slam/signatures/signature_sensor.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/robot_log.hpp"

namespace ngram_slam {

using hyselam::Pose2;

SignatureSensor::SignatureSensor(const SignatureSensorParams& params, Use use)
    : params_((params.validate(), params)),
      use_(std::move(use)),
      map_(params.resolution, PlaceFeatures::kRange, 2.0 * params.half_window),
      extractor_(params.resolution, map_.reach()),
      view_(map_.emptyView()) {}

void SignatureSensor::add(std::int64_t keyframe, const Pose2& base,
                          std::shared_ptr<const hyselam::LaserScan> scan) {
  if (!base.isFinite() || scan == nullptr) {
    throw hyselam::InputError("keyframe", std::to_string(keyframe), "has no finite pose and scan");
  }
  double way = 0.0;
  if (!keyframes_.empty()) {
    const double step = distance(keyframes_.back().base, base);
    if (step > kMaxStep) finish();
    if (!keyframes_.empty()) way = keyframes_.back().way + step;
  }
  keyframes_.push_back({keyframe, way, base, std::move(scan)});
  makePlacesUpTo(way - params_.half_window);
}

void SignatureSensor::finish() {
  if (!keyframes_.empty()) makePlacesUpTo(keyframes_.back().way);
  keyframes_.clear();
  map_.clear();
  out_ = in_map_ = 0;
  places_ = 0;
}

void SignatureSensor::makePlacesUpTo(double last) {
  for (; static_cast<double>(places_) * params_.spacing <= last; ++places_) {
    const double way = static_cast<double>(places_) * params_.spacing;
    for (; in_map_ < keyframes_.size() && keyframes_[in_map_].way <= way + params_.half_window;
         ++in_map_) {
      map_.insert(keyframes_[in_map_].base, *keyframes_[in_map_].scan);
    }
    for (; out_ < in_map_ && keyframes_[out_].way < way - params_.half_window; ++out_) {
      map_.remove(keyframes_[out_].base, *keyframes_[out_].scan);
    }
    const PlaceOnWay place = placeAt(way);
    map_.view({place.pose.x, place.pose.y}, &view_);
    PlaceFeatures features;
    extractor_.extract(&view_, &features);
    use_(place, features);
  }
  // Two keyframes stay, between which the next place may lie.
  while (out_ > 2 && keyframes_[1].way < static_cast<double>(places_ - 1) * params_.spacing) {
    keyframes_.pop_front();
    --out_;
    --in_map_;
  }
}

PlaceOnWay SignatureSensor::placeAt(double way) const {
  const auto after = std::upper_bound(keyframes_.begin(), keyframes_.end(), way,
                                      [](double w, const Keyframe& k) { return w < k.way; });
  const Keyframe& b = after == keyframes_.end() ? keyframes_.back() : *after;
  const Keyframe& a = after == keyframes_.begin() ? b : *(after - 1);
  const double share = b.way > a.way ? (way - a.way) / (b.way - a.way) : 0.0;
  return {share > 0.5 ? b.number : a.number, way, hyselam::interpolate(a.base, b.base, share)};
}

}  // namespace ngram_slam
