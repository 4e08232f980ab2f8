// A SICK LMS-200 on the robot (Maffei 2017, appendix A): 180 degrees, 181 beams, 1 cm resolution.
#pragma once

#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_sim/plan_ray_caster.hpp"

namespace hyselam_sim {

struct LaserParams {
  int beams = 181;                               ///< >= 2
  double field_of_view = hyselam::radians(180);  ///< [rad], beam 0 is the rightmost
  double range_min = 0.05;                       ///< [m]
  double range_max = 30.0;                       ///< [m]; up to 80 for this model
  double resolution = 0.01;                      ///< ranges are multiples of this [m]; 0: exact
  double sigma = 0.01;                           ///< standard deviation of a range [m]
  double dropout = 0.001;                        ///< probability that a beam sees no return
  Pose2 laser_in_base{0.1, 0.0, 0.0};            ///< where it is mounted; not in the thesis

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// A standing disc that the laser sees (a person). Plan frame, [m].
struct Disc {
  Point2 center;
  double radius = 0.25;
};

/// The scan from a robot at `base` (plan frame). A beam without return reads range_max. The number
/// of random draws depends on the number of beams only.
hyselam::LaserScan takeScan(const LaserParams& params, const PlanRayCaster& world,
                            const std::vector<Disc>& people, const Pose2& base, double stamp,
                            hyselam::Rng& rng);

}  // namespace hyselam_sim
