// What the scans of a stretch of the way saw, as cells, without what was seen before or after it:
// scans are put in ahead and taken out behind, exactly.
#pragma once

#include <cstdint>
#include <vector>

#include "fsd_localization/density/bit_plane.hpp"
#include "hyselam_common/laser_scan.hpp"

namespace ngram_slam {

class WindowMap {
 public:
  /// `resolution`: side of a cell; `range`: beams are cut there; `extent`: of the way between any
  /// two scans that are in it together, at most; all [m].
  /// @throws hyselam::ParameterError unless all are positive and the map has at most 2^22 cells.
  WindowMap(double resolution, double range, double extent);

  /// Adds a scan; `base`: where it was taken, in a frame that is the same for all.
  void insert(const hyselam::Pose2& base, const hyselam::LaserScan& scan) { trace(base, scan, 1); }
  /// Takes out a scan that was added at the same pose.
  void remove(const hyselam::Pose2& base, const hyselam::LaserScan& scan) { trace(base, scan, -1); }
  void clear();

  double resolution() const { return resolution_; }
  /// Cells from the middle of a view to its edge.
  int reach() const { return reach_; }
  /// An empty view of the right size.
  fsd_localization::FreeSpaceGrid emptyView() const;
  /// The cells around a point, which lies in the middle cell (reach(), reach()) of `view`. The
  /// point is to lie on the way between the scans.
  void view(const hyselam::Point2& middle, fsd_localization::FreeSpaceGrid* view) const;

 private:
  struct Count {
    std::int32_t free = 0, hits = 0;
  };
  void trace(const hyselam::Pose2& base, const hyselam::LaserScan& scan, int sign);

  double resolution_, range_;
  int reach_;
  int size_;  // cells of a side, a power of two: cells beyond it are found from the other side on
  std::vector<Count> counts_;
};

}  // namespace ngram_slam
