// Places seen before, by words: observations along the path, the recognizer, and its matches as
// pairs of observations.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/slam/slam_types.hpp"
#include "ngram_slam/words/observation_sensor.hpp"

namespace ngram_slam {

class WordPlaces {
 public:
  WordPlaces(const ObservationSensorParams& sensor, const NgramRecognizerParams& words,
             Corpus corpus = {});

  struct Update {
    std::vector<double> stamps;      ///< of the observations that were completed, in order
    std::vector<SlamMatch> matches;  ///< without keyframes
    bool requantized = false;        ///< all matches before are void
  };
  /// `base`: by odometry or something better, without odometry_jumps.
  /// @throws hyselam::InputError for a scan that cannot be used; nothing is changed then.
  Update add(const hyselam::LaserScan& scan, const hyselam::Pose2& base);
  /// Ends the run.
  Update finish();

  const NgramRecognizer& recognizer() const { return *recognizer_; }

 private:
  void addObservations(const std::vector<DensityObservation>& observations, Update* update);
  void addMatches(const NgramRecognizerUpdate& recognized, Update* update);

  ObservationSensor sensor_;
  std::unique_ptr<NgramRecognizer> recognizer_;
  std::optional<DensityObservation> last_;
};

}  // namespace ngram_slam
