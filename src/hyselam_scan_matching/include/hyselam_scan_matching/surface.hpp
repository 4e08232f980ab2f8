// A laser scan as points on surfaces: where walls are and which way they face.
#pragma once

#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/parameters.hpp"

namespace hyselam_scan_matching {

/// A point of a wall; (nx, ny) is its unit normal on the side it was seen from, or (0, 0) where
/// neighbours do not tell it (an edge, a single return).
struct SurfacePoint {
  double x = 0.0, y = 0.0;  ///< [m]
  double nx = 0.0, ny = 0.0;

  bool hasNormal() const { return nx != 0.0 || ny != 0.0; }
};
using SurfacePoints = std::vector<SurfacePoint>;

struct SurfaceParams {
  double max_range = 30.0;     ///< farther returns are left out [m], > 0
  double spacing = 0.05;       ///< points nearer to the last one kept are left out [m], >= 0
  double normal_reach = 0.15;  ///< a normal is a line through the neighbours this near [m], > 0
  double normal_reach_per_m = 0.03;  ///< or this part of the range, where beams lie apart, >= 0
  /// Neighbours off the line by more than this part of its length: no normal, > 0.
  double normal_bend = 0.3;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// The returns of a scan in the base frame, in the order of beams.
SurfacePoints surfacePoints(const hyselam::LaserScan& scan, const SurfaceParams& params = {});

/// The points seen from another frame.
SurfacePoints transformed(const hyselam::Pose2& pose, const SurfacePoints& points);

}  // namespace hyselam_scan_matching
