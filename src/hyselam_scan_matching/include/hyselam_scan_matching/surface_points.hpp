// A laser scan as points on surfaces: where walls are and which way they face.
#pragma once

#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/parameters.hpp"

namespace hyselam_scan_matching {

/// A point of a wall; (nx, ny) is its unit normal on the side it was seen from, or (0, 0) where
/// neighbors do not determine it (an edge, a single return).
struct SurfacePoint {
  double x = 0.0, y = 0.0;  ///< [m]
  double nx = 0.0, ny = 0.0;

  bool hasNormal() const { return nx != 0.0 || ny != 0.0; }
};
using SurfacePoints = std::vector<SurfacePoint>;

struct SurfacePointParams {
  double max_range = 30.0;      ///< farther returns are left out [m], > 0
  double min_spacing = 0.05;    ///< closer points are left out [m], >= 0
  double normal_radius = 0.15;  ///< neighborhood of the line fitted for a normal [m], > 0
  /// The same per meter of range, where beams are farther apart; the larger one counts; >= 0.
  double normal_radius_per_meter = 0.03;
  /// Neighbors farther from the line than this part of its length: no normal; > 0.
  double max_normal_deviation = 0.3;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// The returns of a scan in the base frame, in the order of beams.
SurfacePoints surfacePoints(const hyselam::LaserScan& scan, const SurfacePointParams& params = {});

/// The points seen from another frame.
SurfacePoints transformed(const hyselam::Pose2& pose, const SurfacePoints& points);

}  // namespace hyselam_scan_matching
