// Supervision of a localisation by the camera: by views where the learned frames have poses, else
// by places. Used by the nodelet and by the bench.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "selovis/learning/place_model.hpp"
#include "selovis/places/topological_places.hpp"
#include "selovis/recognition/kidnapping_detector.hpp"
#include "selovis/recognition/view_test.hpp"

namespace selovis {

struct PoseSupervisorParams {
  ViewTestParams views;
  /// Its threshold and time are those of the views.
  KidnappingDetectorParams places;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

/// One frame of the camera, with what the pose of the localisation lets expect.
struct SupervisedFrame {
  const std::vector<double>* places = nullptr;  ///< probability of each place by this frame alone
  ViewTestFrame view;                           ///< distances: null where the classifier has none
  ExpectedPlaces expected;
};

struct SupervisionState {
  bool tested = false;       ///< false: there was nothing to compare
  bool by_views = false;     ///< else by places
  bool kidnapped = false;    ///< the pose is rejected
  bool alarm = false;        ///< by this frame
  double evidence = 0.0;     ///< [nats] that the robot is elsewhere
  double increment = 0.0;    ///< ViewTestState::increment
  double coverage = 0.0;     ///< ViewTestState::coverage
  int place = -1;            ///< where the robot is instead, if kidnapped and known
  double probability = 0.0;  ///< of the most likely place, if kidnapped
  /// Where the base is instead, if kidnapped and known that well: to begin again from.
  std::optional<PlacePosePrior> pose;
};

/// Two tests share the work. A ViewTest tells whether the pose is right, from frames with a pose
/// and distances, if the learned frames have poses and are compared themselves (comparesViews()). A
/// KidnappingDetector gets every frame; it tells whether the pose is right where the ViewTest
/// cannot, and always in which place a rejected robot is if no rival leads by views. Both raise the
/// alarm at the same evidence.
class PoseSupervisor {
 public:
  /// @param transitions of the model's places (reordered()).
  /// @param memory where the camera was found to err with these samples; null: as the model says.
  /// @throws hyselam::ParameterError; hyselam::InputError without places.
  PoseSupervisor(const PlaceModel& model, const PlaceTransitions& transitions,
                 const PoseSupervisorParams& params, const ReliabilityMemory* memory = nullptr);

  bool comparesViews() const { return views_.has_value(); }
  /// Where the camera was found to err, beginning with PlaceModel::reliability; null by places.
  const ReliabilityMemory* memory() const { return views_ ? &views_->memory() : nullptr; }
  /// From now on scans are compared with this map; null: they are not.
  void setMap(std::shared_ptr<const ScanFit> map);
  /// @throws hyselam::InputError (KidnappingDetector::update).
  SupervisionState update(const SupervisedFrame& frame);
  /// The pose was set: it is tested from now on.
  void reset();
  /// The localisation itself reports that it is lost.
  void declareLost();
  /// [nats] of an alarm.
  double threshold() const { return threshold_; }

 private:
  void testByViews(const SupervisedFrame& frame, SupervisionState& state);

  double threshold_;
  std::optional<ViewTest> views_;
  KidnappingDetector places_;
  bool rejected_ = false;  // by views
};

}  // namespace selovis
