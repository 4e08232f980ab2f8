// What some scans have seen: surfaces, and the free space before them.
#pragma once

#include <cstdint>
#include <vector>

#include "hyselam_scan_matching/surface_points.hpp"

namespace ngram_slam {

/// How points of other scans lie in it.
struct Overlap {
  double known = 0.0;  ///< part of the points on surfaces or in free space, 0..1
  double fit = 0.0;    ///< part of these on surfaces, 0..1: the rest should have been seen
};

class SeenSpace {
 public:
  /// The square of `side` [m] around the origin; farther away nothing is known. `cell` [m].
  /// @throws hyselam::ParameterError unless both are positive and the square has at most 2^26
  /// cells.
  SeenSpace(double side, double cell);

  /// `pose` of the base when it saw `points`, which are in its frame; `laser`: where it looks from.
  void insert(const hyselam::Pose2& pose, const hyselam_scan_matching::SurfacePoints& points,
              const hyselam::Point2& laser);
  Overlap overlap(const hyselam::Pose2& pose,
                  const hyselam_scan_matching::SurfacePoints& points) const;

 private:
  enum : std::uint8_t { kUnknown = 0, kFree = 1, kNear = 2, kSurface = 3 };
  void mark(int x, int y, std::uint8_t what);
  bool cellOf(double x, double y, int* cx, int* cy) const;

  double half_, cell_;
  int size_;
  std::vector<std::uint8_t> cells_;
};

}  // namespace ngram_slam
