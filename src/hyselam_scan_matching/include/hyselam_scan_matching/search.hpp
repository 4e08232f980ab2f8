// The pose within a window from which most of a scan falls on known surfaces: no guess better than
// the window is needed, and no pose of the window is missed.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_scan_matching/surface_map.hpp"

namespace hyselam_scan_matching {

struct SearchParams {
  double resolution = 0.05;  ///< of positions and of the grid [m], > 0
  /// A point counts less with its distance from a surface, up to here [m], > 0.
  double reach = 0.15;
  double window = 3.0;       ///< positions this far from the guess, each axis [m], > 0
  double turn = 0.5;         ///< headings this far from the guess, 0..pi [rad]
  double least_score = 0.5;  ///< below this nothing is found, 0..1

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

struct Found {
  hyselam::Pose2 pose;
  double score = 0.0;  ///< mean over the scan's points, 1: all on surfaces, 0: none near one
};

/// A map drawn as a grid of scores, with the maxima of ever larger squares beside it (Olson 2009;
/// the bound of Hess et al. 2016).
class SearchGrid {
 public:
  /// @throws hyselam::ParameterError
  explicit SearchGrid(const SurfaceMap& map, const SearchParams& params = {});

  /// The best pose of the window around `guess`, nothing if its score is below `least_score`.
  /// The same scan, map and guess give the same pose.
  std::optional<Found> search(const SurfacePoints& scan, const hyselam::Pose2& guess) const;
  /// The best pose of the window that is farther than `apart` [m] from `best`, nothing if its score
  /// is below `least_score`: whether the scan could as well lie elsewhere.
  std::optional<Found> rival(const SurfacePoints& scan, const hyselam::Pose2& guess,
                             const hyselam::Pose2& best, double apart, double least_score) const;

 private:
  struct Level {
    std::vector<std::uint8_t> cells;  ///< maximum of the 2^level cells to the right and up
  };
  /// Positions that do not count [cells from the guess].
  struct Apart {
    double x, y, radius;
  };
  std::uint8_t at(int level, int x, int y) const;
  std::optional<Found> search(const SurfacePoints& scan, const hyselam::Pose2& guess,
                              double least_score, const Apart* apart) const;

  SearchParams params_;
  double x0_ = 0.0, y0_ = 0.0;
  int width_ = 0, height_ = 0;
  std::vector<Level> levels_;
};

}  // namespace hyselam_scan_matching
