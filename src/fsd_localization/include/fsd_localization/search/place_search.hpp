// Where on the whole map a submap fits: exhaustively, by branch and bound over free cells and
// headings with a pyramid of maxima (the bound of Hess et al. 2016), refined on the distance field.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "fsd_localization/models/distance_field.hpp"
#include "fsd_localization/models/grid_ray_caster.hpp"
#include "fsd_localization/search/submap.hpp"

namespace fsd_localization {

/// A pose at which a submap may have ended, in the grid's frame (corner of cell (0, 0)).
struct Place {
  hyselam::Pose2 base;
  double coarse = 0.0;  ///< score on the lattice of the search, 0..1; 0 if it was not searched
  double ends = 0.0;    ///< how well the points lie on obstacles, 0..1
  double seen = 0.0;    ///< the same for beams that nothing of the map stands in the way of, 0..1
};

/// Two poses that are the same place: within 1 m and 30 degrees.
bool isSamePlace(const hyselam::Pose2& a, const hyselam::Pose2& b);

class PlaceSearch {
 public:
  static constexpr double kCell = 0.2;         ///< [m] of the lattice of positions
  static constexpr int kHeadings = 120;        ///< of the lattice
  static constexpr double kSigma = 0.3;        ///< [m] of the score on the lattice
  static constexpr std::size_t kPoints = 100;  ///< of a submap, on the lattice

  /// @throws hyselam::InputError as distanceField().
  explicit PlaceSearch(const hyselam::OccupancyGrid& map,
                       const OccupancyThresholds& thresholds = {});

  /// The places that fit, refined, each once, best `seen` first; none for a submap without points.
  /// Deterministic. @param believed if given, places are left out that are much worse than it, by
  ///   their score on the lattice: they do not speak against it, and most of the map is.
  /// @param cancelled asked now and then; what comes after it said yes is incomplete.
  std::vector<Place> search(const Submap& submap,
                            const std::optional<hyselam::Pose2>& believed = {},
                            const std::function<bool()>& cancelled = {}) const;
  /// The best pose near `guess`.
  Place refine(const Submap& submap, const hyselam::Pose2& guess) const;

  /// The best lattice poses, each of another tile (1.6 m, 36 degrees), best first. The score of a
  /// lattice pose is the mean over the points of `submap` (at most kPoints, evenly taken) of
  /// round(255 exp(-d^2 / 2 kSigma^2)) / 255, where d is the least distance of an obstacle from a
  /// cell of the map in the lattice's cell that the point falls on; 0 off the map. Positions are
  /// the middles of lattice cells that hold a free cell of the map.
  /// @param believed, cancelled see search().
  std::vector<Place> latticeSearch(const Submap& submap, std::size_t max_places,
                                   const std::optional<hyselam::Pose2>& believed = {},
                                   const std::function<bool()>& cancelled = {}) const;

  std::size_t bytes() const;

 private:
  friend class LatticeSearch;
  struct Level {
    std::vector<std::uint8_t> score;  // maximum of the 2^level cells to the right and up
    std::vector<std::uint8_t> free;   // whether one of them is
  };
  void buildPyramid(const hyselam::OccupancyGrid& map, const OccupancyThresholds& thresholds);
  double distanceAt(double x, double y) const;
  double endScore(const std::vector<hyselam::Point2>& points, const hyselam::Pose2& base,
                  const std::vector<float>& by_distance) const;
  double seenScore(const Submap& submap, const hyselam::Pose2& base, bool sharply) const;
  /// Hill climbing from `guess`; not `sharply`: until it is near enough to be compared.
  Place climb(const Submap& submap, const hyselam::Pose2& guess, bool sharply) const;

  hyselam::GridGeometry geometry_;
  std::vector<std::uint8_t> distance_;  // [cm], at most 255, of each cell of the map
  GridRayCaster rays_;
  int width_ = 0, height_ = 0;  // of the lattice
  int stride_ = 0;              // with the margin at the left and below
  std::vector<Level> levels_;
};

}  // namespace fsd_localization
