// Grid maps from scans with known poses, by counting hits and misses per cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_common/tiled_grid.hpp"

namespace hyselam {

struct OccupancyMapperParams {
  double resolution = 0.05;  ///< side of a cell [m], > 0
  /// Returns farther away only clear the beam up to here [m], > 0. Far returns are sparse and their
  /// position suffers most from a wrong heading.
  double usable_range = 40.0;
  /// How far a beam without return clears cells [m], >= 0 (capped by range_max and usable_range).
  /// 0: it clears nothing, the safe choice where glass, black surfaces and sunlight give no return.
  double no_return_clears = 0.0;
  /// A cell is occupied if hits / (hits + misses) is above; (0, 1). Low, because a thin wall is
  /// also missed by beams that graze it.
  double occupied_ratio = 0.25;
  /// Cells observed less often stay unknown; >= 1. More than 1 removes single rays that pass
  /// through walls where a pose is slightly wrong.
  int min_observations = 2;
  std::size_t max_cells = std::size_t{1} << 28;  ///< growth beyond is refused, >= 1

  void describe(ParameterVisitor& visit);
  /// @throws ParameterError
  void validate() const;
};

/// Counting model ("reflection probability map"): each beam counts a miss in the cells it crosses
/// and a hit where it ends. The order of scans does not matter. Not thread safe.
class OccupancyMapper {
 public:
  /// @throws ParameterError for values out of range.
  explicit OccupancyMapper(const OccupancyMapperParams& parameters = {});

  /// Adds a scan taken with the robot at `base_in_map`. @throws InputError for a pose that is not
  /// finite, std::length_error if the map would exceed max_cells.
  void insert(const Pose2& base_in_map, const LaserScan& scan);
  void clear();

  std::size_t scanCount() const { return scans_; }
  const OccupancyMapperParams& parameters() const { return parameters_; }

  /// The map so far, cropped to the observed cells plus a margin of two unknown cells; its origin
  /// is a multiple of the resolution. Without any observation: 1 x 1 unknown cell.
  OccupancyGrid grid() const;
  /// Calls `use(x, y, hits, misses)` for each observed cell, in the same order each time. The cell
  /// covers x to x + 1 times the resolution, and y to y + 1.
  template <typename Use>
  void forEachObserved(Use use) const {
    counts_.forEach([&](int x, int y, const Counts& c) {
      if (c.hits + c.misses > 0) use(x, y, c.hits, c.misses);
    });
  }

 private:
  struct Counts {
    std::uint32_t hits = 0;
    std::uint32_t misses = 0;
  };
  struct Box {  // cells in the lattice of the map frame, inclusive
    int min_x = 0, min_y = 0, max_x = -1, max_y = -1;
  };

  void cover(const Box& box);
  void trace(double x0, double y0, double x1, double y1, bool hit);

  OccupancyMapperParams parameters_;
  std::size_t scans_ = 0;
  Box box_;
  TiledGrid<Counts> counts_;  // covers the box
  std::vector<double> ends_;  // scratch: end points in cells
};

}  // namespace hyselam
