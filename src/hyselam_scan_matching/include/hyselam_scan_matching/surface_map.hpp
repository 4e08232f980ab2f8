// Surfaces of several scans in one frame, for looking up what is near.
#pragma once

#include <cstdint>
#include <deque>
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
  /// Leaves out the points of the oldest insert() that is still there; a map without them is equal.
  void dropOldest();
  /// Must be called after the last insert() or dropOldest() and before nearest(). What was finished
  /// before costs little.
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
    std::uint32_t insert;  ///< the number of the insert() that it came with

    bool isBefore(const Sum& other) const { return cy != other.cy ? cy < other.cy : cx < other.cx; }
    bool isBeside(const Sum& other) const { return cy == other.cy && cx == other.cx; }
  };
  /// The means of a cell's points that face the same way, at most two.
  struct Means {
    SurfacePoint points[2];
    int count = 0;
  };
  struct Insert {
    std::uint32_t number;
    double x, y;  ///< the first point
  };
  /// A rectangle of buckets.
  struct Buckets {
    int left, right, low, high;
  };
  static Means meansOf(const Sum* begin, const Sum* end);
  void takeUpNew();
  void fillBuckets();
  const SurfacePoint* nearestOf(const Buckets& buckets, const SurfacePoint& p, double* limit) const;

  double cell_;
  std::vector<Sum> sums_;     ///< by cells, in each in the order of insertion
  std::vector<Means> means_;  ///< of the cells of sums_
  std::vector<Sum> new_;      ///< inserted since finish()
  std::deque<Insert> inserts_;
  std::uint32_t next_insert_ = 0, first_insert_ = 0;
  SurfacePoints points_;  ///< by buckets
  double bucket_ = 0.25;  ///< side [m]
  double x0_ = 0.0, y0_ = 0.0;
  int width_ = 0, height_ = 0;
  std::vector<std::int32_t> begin_;  ///< of each bucket in points_
};

}  // namespace hyselam_scan_matching
