// Places seen before, by words: observations on the way, the recogniser, and its matches as pairs
// of observations.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ngram_slam/observation_sensor.hpp"
#include "ngram_slam/recogniser.hpp"
#include "ngram_slam/slam_types.hpp"

namespace ngram_slam {

class WordPlaces {
 public:
  WordPlaces(const ObservationSensorParams& sensor, const RecogniserParams& words,
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

  const Recogniser& recogniser() const { return *recogniser_; }

 private:
  void take(const std::vector<Observation>& seen, Update* update);
  void note(const RecogniserUpdate& u, Update* update);

  ObservationSensor sensor_;
  std::unique_ptr<Recogniser> recogniser_;
  std::optional<Observation> last_;
};

}  // namespace ngram_slam
