// Correlative scan matching: the pose within a window at which most of a scan lies on known
// surfaces. Exhaustive, so that the guess need not be better than the window; by branch and bound
// over a pyramid of maxima (Olson 2009; the bound of Hess et al. 2016).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_scan_matching/surface_map.hpp"

namespace hyselam_scan_matching {

struct CorrelativeMatcherParams {
  double resolution = 0.05;  ///< of positions and of the grid of scores [m], > 0
  /// The score of a point falls with its distance from the nearest surface, to 0 here [m], > 0.
  double max_distance = 0.15;
  double linear_window = 3.0;   ///< positions searched around the guess, each axis [m], > 0
  double angular_window = 0.5;  ///< headings searched around that of the guess [rad], 0..pi
  double min_score = 0.5;       ///< matches below are not reported, 0..1

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

struct CorrelativeMatch {
  hyselam::Pose2 pose;
  double score = 0.0;  ///< mean over the scan's points, 1: all on surfaces, 0: none near one
};

/// A surface map rasterized as a grid of scores, with the maxima of ever larger squares beside it.
class CorrelativeMatcher {
 public:
  /// @throws hyselam::ParameterError
  explicit CorrelativeMatcher(const SurfaceMap& map, const CorrelativeMatcherParams& params = {});
  /// For this scan and guess alone: the same matches, and no more of the map is rasterized than
  /// they need. @throws hyselam::ParameterError
  CorrelativeMatcher(const SurfaceMap& map, const CorrelativeMatcherParams& params,
                     const SurfacePoints& scan, const hyselam::Pose2& guess);

  /// The best pose of the window around `guess`; nothing if its score is below min_score.
  /// Deterministic.
  std::optional<CorrelativeMatch> match(const SurfacePoints& scan,
                                        const hyselam::Pose2& guess) const;
  /// The best pose of the window that is farther than `min_distance` [m] from `best`, nothing if
  /// its score is below `min_score`: whether the match is ambiguous.
  std::optional<CorrelativeMatch> secondBest(const SurfacePoints& scan, const hyselam::Pose2& guess,
                                             const hyselam::Pose2& best, double min_distance,
                                             double min_score) const;

 private:
  friend class WindowSearch;
  struct Level {
    std::vector<std::uint8_t> cells;  ///< maximum of the 2^level cells to the right and up
  };
  /// What is needed of the map: a square around a position.
  struct Surroundings {
    double x, y, reach;  ///< [m]
  };
  void rasterize(const SurfaceMap& map, const Surroundings* needed);
  void buildPyramid();

  CorrelativeMatcherParams params_;
  double x0_ = 0.0, y0_ = 0.0;
  int left_ = 0, low_ = 0;  // cells that are left out on these sides
  int width_ = 0, height_ = 0;
  std::vector<Level> levels_;
};

}  // namespace hyselam_scan_matching
