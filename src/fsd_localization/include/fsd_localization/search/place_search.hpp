// Where on the whole map a submap fits: exhaustively, by branch and bound over free cells and
// headings with maxima of squares (the bound of Hess et al. 2016), refined on the distance field.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "fsd_localization/models/distance_field.hpp"
#include "fsd_localization/models/grid_ray_caster.hpp"
#include "fsd_localization/search/score_lattice.hpp"
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
  /// [of the score on the lattice] that another place may be worse than the believed one.
  static constexpr double kMaxDropFromBelieved = 0.1;
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
  /// Share of the beams, 0..1, that have something of the map in their way, seen from `base`.
  /// People and furniture hide walls; nobody sees through them.
  double blockedShare(const Submap& submap, const hyselam::Pose2& base) const;

  /// ScoreLattice::search with at most kPoints of the points of `submap`, evenly taken.
  /// @param believed, cancelled see search().
  std::vector<Place> latticeSearch(const Submap& submap, std::size_t max_places,
                                   const std::optional<hyselam::Pose2>& believed = {},
                                   const std::function<bool()>& cancelled = {}) const;

  std::size_t bytes() const;

 private:
  class EndScores;
  /// [cm] at a position [m].
  std::uint8_t distanceAt(double x, double y) const;
  /// Of a position [cells] in distance_; off the map, its last element, which is far.
  std::size_t indexAt(double x, double y) const {
    if (!(x >= 0.0 && y >= 0.0 && x < geometry_.width && y < geometry_.height)) {
      return distance_.size() - 1;
    }
    return geometry_.index({static_cast<int>(x), static_cast<int>(y)});
  }
  bool isOpen(const hyselam::Point2& laser, const hyselam::Point2& end) const;
  double seenScore(const Submap& submap, const hyselam::Pose2& base, bool sharply) const;
  /// Hill climbing from `guess`; not `sharply`: until it is near enough to be compared.
  Place climb(const Submap& submap, const hyselam::Pose2& guess, bool sharply) const;

  hyselam::GridGeometry geometry_;
  std::vector<std::uint8_t> distance_;  // [cm], at most 255, of each cell of the map, and 255
  GridRayCaster rays_;
  std::unique_ptr<const ScoreLattice> lattice_;
};

}  // namespace fsd_localization
