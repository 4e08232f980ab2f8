// The beams of a scan that an observation model uses.
#pragma once

#include <vector>

#include "fsd_localization/filter/particles.hpp"
#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

/// Some beams of a scan, evenly spread, in the base frame. Beams without a return are kept where
/// the model can use them (range = max_range), beams without information (NaN, below range_min)
/// never.
struct BeamSample {
  std::vector<float> bearing;  ///< in the base frame [rad]
  std::vector<float> range;    ///< [m]
  hyselam::Pose2 laser_in_base;
  double max_range = 0.0;  ///< min of the scan's limit and the model's [m]
};
BeamSample sampleBeams(const hyselam::LaserScan& scan, int max_beams, double max_range,
                       bool keep_no_return);

/// The pose of the laser of particle i, headings along those of the base: bearings hold its turn.
hyselam::Pose2 laserPose(const Particles& particles, std::size_t i,
                         const hyselam::Pose2& laser_in_base);

/// Describes `laser_max_range` of amcl: 0.1..1000 m, or -1 for the default of the model.
void describeMaxRange(hyselam::ParameterVisitor& visit, double& max_range);
/// @throws hyselam::ParameterError for the -1 of describeMaxRange(), which is no range.
void checkMaxRange(double max_range);

}  // namespace fsd_localization
