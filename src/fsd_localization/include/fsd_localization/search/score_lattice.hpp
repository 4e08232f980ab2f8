// The map as a lattice of scores for the ends of beams, and the poses on it at which many ends lie
// on obstacles: branch and bound over tiles of positions, for each heading.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "fsd_localization/density/occupancy_thresholds.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/pose2.hpp"

namespace fsd_localization {

class ScoreLattice {
 public:
  static constexpr double kCell = 0.2;            ///< [m] of positions
  static constexpr int kHeadings = 120;           ///< in a turn
  static constexpr int kTile = 8;                 ///< cells along a side of a tile of positions
  static constexpr int kTileHeadings = 12;        ///< headings of a tile
  static constexpr double kSigma = 0.3;           ///< [m] of the score
  static constexpr std::size_t kMaxPoints = 250;  ///< of a search: their sum must fit 16 bits

  struct Pose {
    hyselam::Pose2 base;  ///< in the grid's frame
    double score = 0.0;   ///< 0..1
  };
  /// What is left out of a search, besides what max_poses leaves out.
  struct Limits {
    double min_score = 0.0;     ///< poses with a lower score
    double max_drop = 1.0;      ///< and those that are so much worse than the best
    std::size_t max_poses = 1;  ///< the best of so many tiles
  };

  /// @param distance [cm] of each cell of the map from the nearest obstacle, at most 255.
  ScoreLattice(const hyselam::OccupancyGrid& map, const std::vector<std::uint8_t>& distance,
               const OccupancyThresholds& thresholds);

  /// The score of a pose is the mean over `points` (at most kMaxPoints, in the base frame) of
  /// round(255 exp(-d^2 / 2 kSigma^2)) / 255, d: the least distance of an obstacle from a cell of
  /// the map in the lattice's cell that the point falls on; 0 off the map. Positions are the
  /// middles of lattice cells that hold a free cell of the map. @returns the best pose of each
  /// tile, best first. Deterministic. @param cancelled asked now and then; what comes after it said
  /// yes is incomplete.
  std::vector<Pose> search(const std::vector<hyselam::Point2>& points, const Limits& limits,
                           const std::function<bool()>& cancelled = {}) const;
  /// The best score of the lattice's poses around `pose`, free or not; nothing off the lattice.
  std::optional<double> bestNear(const std::vector<hyselam::Point2>& points,
                                 const hyselam::Pose2& pose) const;

  std::size_t bytes() const { return score_.size() + free_.size() + tiles_.size(); }

 private:
  friend class LatticeSearch;
  void fill(const hyselam::OccupancyGrid& map, const std::vector<std::uint8_t>& distance,
            const OccupancyThresholds& thresholds);
  void makeTiles();
  /// The score of a cell, 0 off the lattice by less than a tile.
  std::uint8_t& scoreAt(int x, int y) { return score_[indexOf(x, y)]; }
  std::size_t indexOf(int x, int y) const {
    return static_cast<std::size_t>((y + kTile) * stride_ + x + kTile);
  }

  std::size_t tileCount() const {
    return static_cast<std::size_t>(tiles_across_) * static_cast<std::size_t>(tiles_up_);
  }
  std::size_t planeSize() const {  // of tiles_
    return static_cast<std::size_t>(tile_stride_) * static_cast<std::size_t>(tiles_up_ + 1);
  }

  int width_ = 0, height_ = 0;           // [cells]
  int stride_ = 0;                       // of a row of scores, with a tile at each end
  int tiles_across_ = 0, tiles_up_ = 0;  // that cover the lattice
  int tile_stride_ = 0;                  // of a row of tiles, with margins
  std::vector<std::uint8_t> score_;      // with a margin of a tile all around
  std::vector<std::uint8_t> free_;       // whether a cell of the map there is free; by cell
  std::vector<std::uint8_t> tile_free_;  // whether one in the tile is; with a margin at the right
  /// The best score in each square of a tile's size, wherever it begins: 64 planes, by where in a
  /// tile they begin; in a plane, neighbours are a tile apart.
  std::vector<std::uint8_t> tiles_;
};

}  // namespace fsd_localization
