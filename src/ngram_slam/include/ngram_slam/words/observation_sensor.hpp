// From scans and odometry to observations: local map and density kernel, and a second look back.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "fsd_localization/density/fsd_sensor.hpp"
#include "ngram_slam/words/observation_sampler.hpp"

namespace ngram_slam {

struct ObservationSensorParams {
  double bandwidth = 2.5;     ///< radius of the uniform kernel [m] (5.3.1), > 0
  double resolution = 0.1;    ///< of the local map [m]
  double usable_range = 0.0;  ///< beams say nothing beyond it [m]; 0: all that fits the local map
  double step = 0.1;          ///< of way between observations [m], > 0
  /// How much farther the robot drives before the density of a spot is taken a second time, with
  /// all that it has seen on the way: DensityObservation::full. Observations come that much later.
  /// 0: no second look, no full density. [m]
  double look_back = 0.0;

  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Makes an observation for every step of the way.
///
/// A laser that looks forward does not see what lies round the next corner nor, at first, what lies
/// behind it, so the density of one spot depends on where the robot comes from (Fig. 4.4). When it
/// has driven on by the kernel's radius or more, everything around the spot has been passed by,
/// whichever way it went.
class ObservationSensor {
 public:
  explicit ObservationSensor(const ObservationSensorParams& params = {});

  /// Takes a scan in. Returns the observations that are now complete, in the order of the way.
  /// @throws hyselam::InputError for a scan or pose that cannot be used; nothing is changed then.
  std::vector<DensityObservation> add(const hyselam::LaserScan& scan,
                                      const hyselam::Pose2& base_in_odom);
  /// The run is over: the observations that still wait for their second look, looked at from here.
  /// What comes next is another run.
  std::vector<DensityObservation> finish();

  const ObservationSensorParams& params() const { return params_; }

 private:
  struct Waiting {
    DensityObservation observation;
    double way;  // [m] driven when it was made
  };
  void make(const fsd_localization::FsdReading& reading, double stamp, const hyselam::Pose2& odom);
  std::vector<DensityObservation> release(double until);
  std::optional<double> lookBack(const hyselam::Pose2& pose);

  ObservationSensorParams params_;
  fsd_localization::FsdSensor sensor_;
  fsd_localization::FreeSpaceDensity kernel_;
  fsd_localization::FreeSpaceGrid space_;
  ObservationSampler sampler_;
  std::deque<Waiting> waiting_;
  double way_ = 0.0;
};

}  // namespace ngram_slam
