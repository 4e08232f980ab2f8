// From keyframes along a way to signatures of places at equal steps of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/parameters.hpp"
#include "ngram_slam/signatures/place_features.hpp"
#include "ngram_slam/signatures/window_map.hpp"

namespace ngram_slam {

struct SignatureSensorParams {
  double spacing = 0.5;      ///< of way between places [m]
  double half_window = 5.0;  ///< of way before and after a place whose scans are used [m]
  double resolution = 0.2;   ///< of their map [m]

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Where a place of a way is.
struct PlaceOnWay {
  std::int64_t keyframe = 0;  ///< the nearest one, as it was numbered
  double way = 0.0;           ///< from the beginning of the run [m]
  hyselam::Pose2 pose;        ///< in the frame of the run
};

/// A place is seen from both sides: it is complete when the robot has driven on by `half_window`.
class SignatureSensor {
 public:
  /// Called with every place that is complete, in the order of the way.
  using Use = std::function<void(const PlaceOnWay&, const PlaceFeatures&)>;

  /// @throws hyselam::ParameterError
  SignatureSensor(const SignatureSensorParams& params, Use use);

  /// Adds a keyframe; `base`: its pose by odometry, without jumps. A motion of more than kMaxStep
  /// begins another run.
  void add(std::int64_t keyframe, const hyselam::Pose2& base,
           std::shared_ptr<const hyselam::LaserScan> scan);
  /// Ends the run: places that wait for more scans are made of those there are.
  void finish();

  static constexpr double kMaxStep = 5.0;  ///< [m]

 private:
  struct Keyframe {
    std::int64_t number;
    double way;
    hyselam::Pose2 base;
    std::shared_ptr<const hyselam::LaserScan> scan;
  };
  void makePlacesUpTo(double way);
  PlaceOnWay placeAt(double way) const;

  SignatureSensorParams params_;
  Use use_;
  WindowMap map_;
  PlaceFeatureExtractor extractor_;
  fsd_localization::FreeSpaceGrid view_;
  std::deque<Keyframe> keyframes_;  // the first `in_map_` are in the map, but for `out_`
  std::size_t out_ = 0, in_map_ = 0;
  std::int64_t places_ = 0;  // of the run
};

}  // namespace ngram_slam
