#include "ngram_slam/slam/signature_places.hpp"

#include <utility>

namespace ngram_slam {

namespace {

std::shared_ptr<const SignatureModel> modelOf(const SignaturePlacesParams& params) {
  return std::make_shared<const SignatureModel>(
      params.model.empty() ? SignatureModel::shipped() : SignatureModel::load(params.model));
}

}  // namespace

void SignaturePlacesParams::describe(hyselam::ParameterVisitor& visit) {
  visit.group("", sensor);
  visit.group("", recognizer);
  visit("interval", interval, hyselam::Range::between(1, 1000), "places",
        "from one that is asked for to the next");
  visit("model", model, "file of another model of signatures; empty: the shipped one");
}

void SignaturePlacesParams::validate() const {
  hyselam::checkParameters(*this);
}

SignaturePlaces::SignaturePlaces(const SignaturePlacesParams& params, Uncertainty uncertainty)
    : SignaturePlaces(params, modelOf(params), std::move(uncertainty)) {}

SignaturePlaces::SignaturePlaces(const SignaturePlacesParams& params,
                                 std::shared_ptr<const SignatureModel> model,
                                 Uncertainty uncertainty)
    : params_((params.validate(), params)),
      model_(std::move(model)),
      recognizer_(*model_, params.recognizer),
      uncertainty_(std::move(uncertainty)),
      sensor_(params.sensor,
              [this](const PlaceOnWay& place, const PlaceFeatures& features) {
                recognizer_.add(model_->signatureOf(features));
                places_.push_back(place);
              }),
      interval_(params.interval) {
  model_->requireSensor(params.sensor);
}

bool SignaturePlaces::odometryAllows(std::uint32_t newer, std::uint32_t older) const {
  if (!uncertainty_ || older < recognizer_.runOf(newer).first) return true;
  const PlaceOnWay &a = places_[newer], &b = places_[older];
  return distance(a.pose, b.pose) <= uncertainty_(a.way - b.way);
}

std::vector<SignatureCandidate> SignaturePlaces::add(const SignatureKeyframe& keyframe) {
  std::vector<SignatureCandidate> candidates;
  const bool jump = std::hypot(keyframe.motion.x, keyframe.motion.y) > SignatureSensor::kMaxStep;
  if (keyframe.begins_run || jump) candidates = endRun();
  pose_ = keyframe.begins_run || jump ? hyselam::Pose2{} : pose_ * keyframe.motion;
  sensor_.add(keyframe.keyframe, pose_, keyframe.scan);
  const std::uint32_t places = recognizer_.index().size();
  const auto ahead = static_cast<std::uint32_t>(params_.recognizer.half_length);
  const auto more = ask(places > ahead ? places - ahead : 0);
  candidates.insert(candidates.end(), more.begin(), more.end());
  return candidates;
}

std::vector<SignatureCandidate> SignaturePlaces::endRun() {
  sensor_.finish();
  std::vector<SignatureCandidate> candidates = ask(recognizer_.index().size());
  recognizer_.endRun();
  next_asked_ = recognizer_.index().size();
  return candidates;
}

std::vector<SignatureCandidate> SignaturePlaces::ask(std::uint32_t end) {
  std::vector<SignatureCandidate> found;
  for (; next_asked_ < end; next_asked_ += static_cast<std::uint32_t>(interval_)) {
    if (keyframeOf(next_asked_) < first_asked_) continue;
    const auto may_be = [&](std::uint32_t older) { return odometryAllows(next_asked_, older); };
    for (const PlaceCandidate& c : recognizer_.candidates(next_asked_, may_be)) {
      found.push_back({keyframeOf(c.newer), keyframeOf(c.older), c.direction, c.score});
    }
  }
  return found;
}

}  // namespace ngram_slam
