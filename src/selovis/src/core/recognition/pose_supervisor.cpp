#include "selovis/recognition/pose_supervisor.hpp"

#include <utility>

namespace selovis {
namespace {

// Spread of a rival's pose [m, m, rad]: aligned by the scan, or known by learned views only.
constexpr hyselam::Pose2 kAligned{0.3, 0.3, 0.15}, kSeen{1.0, 1.0, 0.3};

KidnappingDetectorParams ofPlaces(const PoseSupervisorParams& params, double threshold) {
  params.validate();
  KidnappingDetectorParams places = params.places;
  places.correlation_time = params.views.correlation_time;
  places.threshold = threshold;
  return places;
}

}  // namespace

void PoseSupervisorParams::describe(hyselam::ParameterVisitor& visit) {
  visit.group("", views);
  visit.group("", places,
              {{"threshold", visit.kNotOffered}, {"correlation_time", visit.kNotOffered}});
}

void PoseSupervisorParams::validate() const {
  hyselam::checkParameters(*this);
}

PoseSupervisor::PoseSupervisor(const PlaceModel& model, const PlaceTransitions& transitions,
                               const PoseSupervisorParams& params, const ReliabilityMemory* memory)
    : threshold_(
          ViewTest::thresholdFor(params.views.false_alarm_hours, params.views.correlation_time)),
      places_(transitions, ofPlaces(params, threshold_)) {
  if (comparesExemplars(model.classifier.kernel) && LearnedViews::whyNot(model.samples).empty()) {
    views_.emplace(model.samples, params.views, memory != nullptr ? *memory : model.reliability);
  }
}

void PoseSupervisor::setMap(std::shared_ptr<const ScanFit> map) {
  if (views_) views_->setMap(std::move(map));
}

void PoseSupervisor::reset() {
  if (views_) views_->reset();
  places_.reset();
  rejected_ = false;
}

void PoseSupervisor::declareLost() {
  if (views_) views_->reset();
  places_.declareLost();
  rejected_ = false;
}

void PoseSupervisor::testByViews(const SupervisedFrame& frame, SupervisionState& state) {
  const ViewTestState seen = views_->update(frame.view);
  state.tested = seen.tested;
  state.by_views = true;
  state.coverage = seen.coverage;
  state.increment = seen.increment;
  state.evidence = seen.evidence;
  if (!seen.tested) {
    rejected_ = false;
  } else if (!rejected_ && seen.evidence >= threshold_) {
    rejected_ = state.alarm = true;
    views_->reject();
    places_.declareLost();
  } else if (rejected_ && seen.evidence <= 0.0) {
    rejected_ = false;
    places_.reset();
  }
  if (rejected_ && seen.rival) {
    state.pose = PlacePosePrior{seen.rival->base, seen.rival->by_scan ? kAligned : kSeen};
    state.place = seen.rival->place;
  }
}

SupervisionState PoseSupervisor::update(const SupervisedFrame& frame) {
  SupervisionState state;
  const bool by_views = views_ && frame.view.distances != nullptr && frame.view.base;
  if (by_views) testByViews(frame, state);
  if (!by_views && views_) views_->reset();
  const std::vector<int> none;
  const KidnappingState places =
      places_.update(*frame.places, by_views ? none : frame.expected.agreeing,
                     frame.expected.unmapped, frame.view.seconds);
  if (by_views) {
    state.kidnapped = rejected_ || places.kidnapped;
  } else {
    state.tested = places.tested;
    state.alarm = places.alarm;
    state.kidnapped = places.kidnapped;
    state.evidence = places.evidence;
  }
  if (state.kidnapped && state.place < 0) {
    state.place = places.place;
    state.probability = places.probability;
  }
  return state;
}

}  // namespace selovis
