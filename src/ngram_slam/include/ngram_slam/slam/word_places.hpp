// Recognizes places visited before by the words of the path: makes observations, segments them into
// words, and returns n-gram matches as pairs of observations. Terms: see slam_params.hpp.
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
    bool requantized = false;        ///< words were recomputed: earlier matches are invalid
  };
  /// `base`: pose in an odometry frame (raw or refined) without jumps.
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
