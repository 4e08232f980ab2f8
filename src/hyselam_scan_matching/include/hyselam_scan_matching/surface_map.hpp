// Surfaces of several scans in one frame, for looking up what is near.
#pragma once

#include <cstdint>
#include <vector>

#include "hyselam_scan_matching/surface_points.hpp"

namespace hyselam_scan_matching {

/// Points in cells; points of one cell that face the same way are averaged.
class SurfaceMap {
 public:
  /// `cell`: side [m], > 0. @throws hyselam::ParameterError
  explicit SurfaceMap(double cell = 0.05);

  /// Adds the points transformed by `pose`. Points farther than `kMaxExtent` from the first one are
  /// left out.
  void insert(const hyselam::Pose2& pose, const SurfacePoints& points);
  /// Must be called after the last insert() and before nearest().
  void finish();

  bool empty() const { return points_.empty(); }
  std::size_t size() const { return points_.size(); }
  const SurfacePoints& points() const { return points_; }

  /// The nearest point within `radius` [m] that does not face away from `p`; null if there is none.
  const SurfacePoint* nearest(const SurfacePoint& p, double radius) const;

  static constexpr double kMaxExtent = 500.0;  ///< [m]

 private:
  struct Sum {
    std::int32_t cx, cy;
    double x, y, nx, ny;
    std::int32_t count;
  };
  SurfacePoints mergeCells() const;

  double cell_;
  std::vector<Sum> sums_;  ///< as inserted
  SurfacePoints points_;   ///< by buckets
  double bucket_ = 0.25;   ///< side [m]
  double x0_ = 0.0, y0_ = 0.0;
  int width_ = 0, height_ = 0;
  std::vector<std::int32_t> begin_;  ///< of each bucket in points_
};

}  // namespace hyselam_scan_matching
