// Odometry motion model of a differential robot: rotation, translation, rotation, each with noise
// that grows with the motion (Thrun, Burgard, Fox 2005, 5.4), with amcl's parameters.
#pragma once

#include "fsd_localization/filter/noise.hpp"
#include "fsd_localization/filter/particles.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

struct MotionParams {
  double alpha1 = 0.05;  ///< rotation variance per rotation^2
  double alpha2 = 0.05;  ///< rotation variance per translation^2 [rad^2/m^2]
  double alpha3 = 0.05;  ///< translation variance per translation^2
  double alpha4 = 0.02;  ///< translation variance per rotation^2 [m^2/rad^2]

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError naming the first value out of range (>= 0).
  void validate() const;
};

class MotionModel {
 public:
  explicit MotionModel(const MotionParams& params = {}) : params_(params) { params_.validate(); }
  const MotionParams& params() const { return params_; }

  /// Moves every particle by a sample of the motion `delta` (new base pose in the old base frame).
  /// `stream` selects the noise: another one for each step; its deviations are those of the
  /// parameters times `noise`.
  void move(const hyselam::Pose2& delta, std::uint64_t stream, Particles& particles,
            double noise = 1.0) const;

 private:
  MotionParams params_;
  NoiseTable noise_;
};

}  // namespace fsd_localization
