// From scans and odometry to observations: local map, density kernel, and the density of a spot
// once more when the robot has passed it.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "fsd_localization/density/fsd_sensor.hpp"
#include "hyselam_common/parameters.hpp"
#include "ngram_slam/words/observation_sampler.hpp"

namespace ngram_slam {

struct ObservationSensorParams {
  double bandwidth = 2.5;     ///< radius of the uniform kernel [m] (5.3.1)
  double resolution = 0.1;    ///< of the local map [m/cell]
  double usable_range = 0.0;  ///< beams are cut at this range [m]; 0: as the local map is wide
  double step = 0.1;          ///< path length between observations [m]
  /// How much farther the robot drives before the density of a spot is computed again, with the map
  /// of that moment: DensityObservation::full. Observations come that much later. 0: no full
  /// density. [m]
  double look_back = 0.0;

  void describe(hyselam::ParameterVisitor& visit);
  /// The parts of describe(), for defaults of the second that depend on the first.
  void describeObservations(hyselam::ParameterVisitor& visit);
  void describeLookBack(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Makes an observation at every step of the path.
///
/// A laser that looks forward does not see what lies around the next corner nor, at first, what
/// lies behind it, so the density of one spot depends on where the robot comes from (Fig. 4.4).
/// When it has driven on by the kernel's radius or more, everything around the spot has been passed
/// by, in whichever direction it went.
class ObservationSensor {
 public:
  explicit ObservationSensor(const ObservationSensorParams& params = {});

  /// Adds a scan. Returns the observations that are now complete, in the order of the path.
  /// @throws hyselam::InputError for a scan or pose that cannot be used; nothing is changed then.
  std::vector<DensityObservation> add(const hyselam::LaserScan& scan,
                                      const hyselam::Pose2& base_in_odom);
  /// Ends the run: observations whose full density is pending get it from the current map and are
  /// returned. The next scan starts a new run.
  std::vector<DensityObservation> finish();

  const ObservationSensorParams& params() const { return params_; }

 private:
  struct Pending {
    DensityObservation observation;
    double path_length;  // [m] driven when it was made
  };
  void make(const fsd_localization::FsdReading& reading, double stamp, const hyselam::Pose2& odom);
  std::vector<DensityObservation> releaseUpTo(double path_length);
  std::optional<double> fullDensity(const hyselam::Pose2& pose);

  ObservationSensorParams params_;
  fsd_localization::FsdSensor sensor_;
  fsd_localization::FreeSpaceDensity kernel_;
  fsd_localization::FreeSpaceGrid space_;
  ObservationSampler sampler_;
  std::deque<Pending> pending_;
  double path_length_ = 0.0;  // [m] driven
};

}  // namespace ngram_slam
