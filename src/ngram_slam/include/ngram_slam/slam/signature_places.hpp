// Recognizes places visited before by their signatures: from keyframes to candidates for loops,
// which the scans are to verify.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/parameters.hpp"
#include "ngram_slam/signatures/place_recognizer.hpp"
#include "ngram_slam/signatures/signature_sensor.hpp"

namespace ngram_slam {

struct SignaturePlacesParams {
  SignatureSensorParams sensor;
  PlaceRecognizerParams recognizer;
  int interval = 4;   ///< places from one that is asked for to the next, >= 1
  std::string model;  ///< file of a SignatureModel; empty: the shipped one

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// A keyframe as the signatures need it.
struct SignatureKeyframe {
  int keyframe = 0;
  bool begins_run = false;
  hyselam::Pose2 motion;  ///< since the last one of the run, by refined odometry
  std::shared_ptr<const hyselam::LaserScan> scan;
};

/// Keyframes that may show the same place.
struct SignatureCandidate {
  int keyframe_newer = 0, keyframe_older = 0;
  Direction direction = Direction::kSame;
  double score = 0.0;  ///< see PlaceCandidate
};

/// Not thread-safe.
class SignaturePlaces {
 public:
  SignaturePlaces(const SignaturePlaces&) = delete;
  SignaturePlaces& operator=(const SignaturePlaces&) = delete;

  /// How far odometry may be off after so much path, both in [m].
  using Uncertainty = std::function<double(double path_length)>;

  /// Places of the run that odometry excludes are no candidates; none are excluded without
  /// `uncertainty`.
  /// @throws hyselam::ParameterError, also for a sensor other than the model's;
  /// hyselam::InputError for a model that cannot be read.
  explicit SignaturePlaces(const SignaturePlacesParams& params, Uncertainty uncertainty = {});
  SignaturePlaces(const SignaturePlacesParams& params, std::shared_ptr<const SignatureModel> model,
                  Uncertainty uncertainty);

  /// Places at keyframes before this one are only found by others: they were asked for when they
  /// were new, before the map was saved.
  void askFrom(int keyframe) { first_asked_ = keyframe; }
  /// From now on each place is asked for, or again one in `interval`.
  void askEach(bool each) { interval_ = each ? 1 : params_.interval; }
  /// Adds the next keyframe. Returns the candidates of the places that are complete now.
  std::vector<SignatureCandidate> add(const SignatureKeyframe& keyframe);
  /// Ends the run: its last places are made and asked for.
  std::vector<SignatureCandidate> endRun();

  const PlaceRecognizer& recognizer() const { return recognizer_; }
  /// The keyframe nearest to a place.
  int keyframeOf(std::uint32_t place) const { return static_cast<int>(places_[place].keyframe); }

 private:
  std::vector<SignatureCandidate> ask(std::uint32_t end);
  bool odometryAllows(std::uint32_t newer, std::uint32_t older) const;

  SignaturePlacesParams params_;
  std::shared_ptr<const SignatureModel> model_;
  PlaceRecognizer recognizer_;
  std::vector<PlaceOnWay> places_;
  Uncertainty uncertainty_;
  SignatureSensor sensor_;
  hyselam::Pose2 pose_;
  std::uint32_t next_asked_ = 0;
  int interval_;         // of places that are asked for
  int first_asked_ = 0;  // keyframe
};

}  // namespace ngram_slam
