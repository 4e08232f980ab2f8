// The pipeline of the thesis (dos Santos 2014, section 4.2), stage by stage: mode `thesis` of
// Gr2To. Each stage is a function of its own; runThesis() keeps what each one gave, drawThesis()
// shows it.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"
#include "hyselam_gr2to/thesis/circles.hpp"
#include "hyselam_gr2to/thesis/critical_points.hpp"
#include "hyselam_gr2to/thesis/distance_map.hpp"
#include "hyselam_gr2to/thesis/voronoi.hpp"

namespace hyselam_topo {

struct ThesisParams {
  double door_min = 0.6;         ///< [m] Door_min, > 0
  double door_max = 1.3;         ///< [m] Door_max, > door_min
  double critical_radius = 0.5;  ///< [m] around a critical point nothing is narrower, > 0
  double wall_share = 0.8;       ///< occupied part of a polygon's edge that makes it a wall, 0 .. 1
  int free_max = 25;             ///< cells of 0 .. free_max are free, 0 .. 99
  int occupied_min = 65;         ///< cells from here on are occupied, free_max < .. <= 100
  /// Unknown cells count as obstacles; false: as the thesis has it, distances see occupied cells
  /// only.
  bool unknown_blocks = true;
  /// Free cells outside of all polygons go to the nearest place; false: to none.
  bool fill = true;
  VoronoiParams voronoi;

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// First stage, filter: occupied cells without an occupied neighbor (of eight) become free if all
/// their known neighbors are, free ones without a free neighbor become unknown.
hyselam::OccupancyGrid filterIsolatedCells(const hyselam::OccupancyGrid& grid, int free_max = 25,
                                           int occupied_min = 65);

/// CV_8U, 255 at obstacles, row 0 = lowest y.
cv::Mat obstaclesOf(const hyselam::OccupancyGrid& grid, int free_max, int occupied_min,
                    bool unknown_blocks);

/// A door candidate that a critical point confirms; the closed door is drawn along its critical
/// line.
struct ConfirmedDoor {
  cv::Point2d candidate;  ///< as given by centralLocations() [cells]
  CriticalPoint critical;
};

/// Each candidate takes the nearest critical point within `max_radius` whose own clearance lies
/// between the two radii [cells], as that of a door does; each critical point confirms one door,
/// the nearest. In the order of the critical points.
std::vector<ConfirmedDoor> validateDoors(const std::vector<cv::Point2d>& candidates,
                                         const std::vector<CriticalPoint>& critical,
                                         double min_radius, double max_radius);

/// A place's polygon of eight vertices, and which of its edges k .. k + 1 are real walls.
struct PlacePolygon {
  std::array<cv::Point2d, 8> vertices;  ///< [cells], centres of cells at whole numbers
  std::array<bool, 8> wall{};
};

/// Fifth stage: from the centre of each circle, in each of eight beams of 45 degrees, the farthest
/// of the obstacles that are seen first, up to the limit of Eq. 4.4 if another circle lies in the
/// beam. `obstacles` with the doors closed.
std::vector<PlacePolygon> drawPolygons(const std::vector<Circle>& circles, const cv::Mat& obstacles,
                                       double wall_share);

/// Everything between the grid and the places. Positions in cells.
struct ThesisResult {
  hyselam::OccupancyGrid filtered;
  cv::Mat obstacles;
  cv::Mat squared_distance;  ///< CV_32S [cells^2]
  cv::Mat voronoi;           ///< CV_8U
  std::vector<cv::Point2d> candidates;
  std::vector<CriticalPoint> critical_points;
  std::vector<ConfirmedDoor> doors;
  std::vector<Circle> circles;  ///< circle k is place k + 1
  std::vector<std::pair<std::size_t, std::size_t>> links;
  std::vector<PlacePolygon> polygons;
  PlaceSegmentation segmentation;
};

/// @throws hyselam::ParameterError for a parameter out of range, hyselam::InputError for a grid
/// without cells or whose cells do not fit its geometry.
ThesisResult runThesis(const hyselam::OccupancyGrid& grid, const ThesisParams& params = {});

/// The places alone. Doors of the segmentation are the confirmed ones, drawn where they were
/// closed; borders without one are virtual doors.
PlaceSegmentation segmentThesis(const hyselam::OccupancyGrid& grid,
                                const ThesisParams& params = {});

enum class ThesisStage { kDistance, kCandidates, kVoronoi, kCircles, kPlaces };

/// A picture of a stage, CV_8UC3, row 0 = highest y, in the manner of figures 4.7 to 4.10.
cv::Mat drawThesis(const ThesisResult& result, ThesisStage stage);

}  // namespace hyselam_topo
