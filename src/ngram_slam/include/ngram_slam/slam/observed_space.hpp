// The space that some scans observed: surfaces, and the free space before them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hyselam_scan_matching/surface_points.hpp"

namespace ngram_slam {

/// How points of other scans lie in an ObservedSpace.
struct Overlap {
  double observed_ratio = 0.0;  ///< fraction of the points on surfaces or in free space, 0..1
  double surface_ratio = 0.0;   ///< fraction of these on surfaces, 0..1; the rest contradicts
};

class ObservedSpace {
 public:
  /// The square of `side` [m] around the origin; outside, all is unknown. `cell`: size of a cell
  /// [m].
  /// @throws hyselam::ParameterError unless both are positive and the square has at most 2^26
  /// cells.
  ObservedSpace(double side, double cell);

  /// `pose` of the base when it measured `points`, which are in its frame, as is `laser`.
  void insert(const hyselam::Pose2& pose, const hyselam_scan_matching::SurfacePoints& points,
              const hyselam::Point2& laser);
  Overlap overlap(const hyselam::Pose2& pose,
                  const hyselam_scan_matching::SurfacePoints& points) const;

 private:
  struct Cell {
    int x, y;
  };
  // A larger value overrides a smaller one.
  enum : std::uint8_t { kUnknown = 0, kFree = 1, kBesideSurface = 2, kSurface = 3 };
  void raiseCell(int x, int y, std::uint8_t state);
  std::optional<Cell> cellAt(double x, double y) const;

  double half_, cell_;
  int size_;
  std::vector<std::uint8_t> cells_;
};

}  // namespace ngram_slam
