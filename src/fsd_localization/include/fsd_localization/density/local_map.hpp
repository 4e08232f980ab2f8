// Local map: a HIMM grid around the robot (Maffei 2017, 2.1.2 and 3.2.1, Alg. 2.2): a window of
// cells that moves with the robot; every cell in the field of view is updated, so that no holes are
// left.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "fsd_localization/density/bit_plane.hpp"
#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

struct LocalMapParams {
  double radius = 9.0;          ///< r_max: cells farther from the robot are dropped [m]
  double resolution = 0.1;      ///< side of a cell [m]
  double usable_range = 0.0;    ///< beams are not used beyond it [m]; 0: min(range_max, radius)
  double obstacle_depth = 1.0;  ///< epsilon_d: an obstacle covers the cells nearer than this to a
                                ///< beam's end [cells]
  int free_below = 3;           ///< epsilon_f: a cell is free where its value is smaller
  int occupied_above = 12;      ///< epsilon_o: a cell is occupied where its value is larger
  double footprint_radius =
      0.2;  ///< cells within this radius of the robot are free [m]; 0: only by laser

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError naming the first value out of range.
  void validate() const;
};

/// Cells hold 0 (free) .. 15 (occupied); 8 initially (unknown).
///
/// The grid is aligned with the odometry frame and its centre cell holds the robot. Cost of an
/// update: one pass over the cells of the field of view.
class LocalMap {
 public:
  static constexpr std::uint8_t kUnknown = 8;
  static constexpr std::uint8_t kMaxValue = 15;
  static constexpr int kHit = 3;   ///< increment of a cell observed occupied
  static constexpr int kMiss = 1;  ///< decrement of a cell observed free

  explicit LocalMap(const LocalMapParams& params = {});

  /// Moves the window to the robot and updates the cells in the scan's field of view.
  /// @param base_in_odom where the robot is while the scan is taken, finite.
  /// @throws hyselam::InputError for a scan that cannot be used (no beams, an increment of 0,
  /// limits
  ///   that are not ordered, a laser outside the window, not finite numbers); the map is unchanged.
  void update(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom);
  /// Throws what update() would, and changes nothing.
  void check(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom) const;
  /// Clears the map.
  void clear();

  const LocalMapParams& params() const { return params_; }
  /// Cells along a side of the window; odd.
  int side() const { return side_; }
  /// The robot's cell within the window: its centre.
  hyselam::Cell robotCell() const { return {side_ / 2, side_ / 2}; }
  /// The cell of the odometry frame (floor of coordinate / resolution) that is the window's (0, 0).
  hyselam::Cell windowInOdom() const { return window_; }
  std::uint8_t value(hyselam::Cell c) const { return cells_[index(c)]; }
  bool isFree(std::uint8_t v) const { return v < params_.free_below; }
  bool isOccupied(std::uint8_t v) const { return v > params_.occupied_above; }

  /// Free and unknown cells of the part of the window nearer than `reach` cells to the robot (in
  /// the maximum norm). The planes have the window's size; their other cells stay as they were.
  void freeSpace(int reach, FreeSpaceGrid& out) const;
  /// The window as an occupancy grid in the odometry frame.
  hyselam::OccupancyGrid toGrid() const;

 private:
  /// A cell seen from the laser's cell.
  struct VisibleCell {
    std::int32_t offset;            // added to the index of the laser's cell
    std::int32_t squared_distance;  // [cells^2]
  };
  /// The cells of a range of distances, sorted by bearing: (-pi, pi], then once more a turn later,
  /// so that a scan may cross the bearing pi.
  struct Ring {
    std::int32_t begin = 0;  // squared distances begin .. end
    std::int32_t end = 0;
    std::vector<double> bearings;
    std::vector<VisibleCell> cells;
  };
  static constexpr std::size_t kRings = 6;
  struct BeamLimits {  // on squared distances [cells^2]: free below, occupied from .. to
    std::int32_t free_end = 0;
    std::int32_t occupied_begin = 0;
    std::int32_t occupied_end = 0;
  };

  std::size_t index(hyselam::Cell c) const {
    return static_cast<std::size_t>((c.y + pad_) * stride_ + c.x + pad_);
  }
  hyselam::Cell cellOf(const hyselam::Pose2& in_odom) const;
  void layOut(int pad);
  void moveTo(hyselam::Cell robot_in_odom);
  void forgetOutside();
  void sweep(const hyselam::LaserScan& scan, double laser_heading, hyselam::Cell laser_cell);
  static void updateCells(const Ring& ring, std::size_t from, std::size_t to,
                          const BeamLimits& limits, std::uint8_t* laser);
  std::optional<BeamLimits> limitsOf(float range, const hyselam::LaserScan& scan) const;
  void clearFootprint();

  LocalMapParams params_;
  int radius_cells_;
  int side_;
  int pad_ = 0;  // cells around the window, so that a laser off the centre stays inside
  int stride_ = 0;
  hyselam::Cell window_;
  bool placed_ = false;
  std::vector<std::uint8_t> cells_;
  std::vector<std::uint8_t> scratch_;
  std::vector<int> half_width_;  // of the disc, per row of the window
  std::vector<Ring> rings_;      // the whole field of view
};

}  // namespace fsd_localization
