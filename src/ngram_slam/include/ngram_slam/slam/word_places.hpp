// Places seen before, by words: observations on the way, the recogniser, and its matches as pairs
// of observations.
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
    bool requantised = false;        ///< all matches before are void
  };
  /// `base`: by odometry or something better, without leaps.
  /// @throws hyselam::InputError for a scan that cannot be used; nothing is changed then.
  Update add(const hyselam::LaserScan& scan, const hyselam::Pose2& base);
  /// Ends the run.
  Update finish();

  const NgramRecognizer& recogniser() const { return *recogniser_; }

 private:
  void take(const std::vector<DensityObservation>& seen, Update* update);
  void note(const NgramRecognizerUpdate& u, Update* update);

  ObservationSensor sensor_;
  std::unique_ptr<NgramRecognizer> recogniser_;
  std::optional<DensityObservation> last_;
};

}  // namespace ngram_slam
