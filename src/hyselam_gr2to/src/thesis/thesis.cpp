#include "hyselam_gr2to/thesis/thesis.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "confirmed_doors.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/require.hpp"
#include "hyselam_gr2to/thesis/door_candidates.hpp"
#include "polygon_labels.hpp"

namespace hyselam_topo {

using hyselam::Cell;
using hyselam::OccupancyGrid;

namespace {

constexpr std::size_t kMaxPlaces = 65535;  // 16 bit labels

void check(const ThesisParams& p) {
  hyselam::require("door_min", p.door_min, p.door_min > 0.0, "> 0 m");
  hyselam::require("door_max", p.door_max, p.door_max > p.door_min, "> door_min");
  hyselam::require("critical_radius", p.critical_radius, p.critical_radius > 0.0, "> 0 m");
  hyselam::require("wall_share", p.wall_share, p.wall_share >= 0.0 && p.wall_share <= 1.0,
                   "0 .. 1");
  hyselam::require("occupied_min", p.occupied_min, p.occupied_min > p.free_max, "> free_max");
}

void check(const OccupancyGrid& grid) {
  if (grid.geometry.width <= 0 || grid.geometry.height <= 0 ||
      grid.cells.size() != grid.geometry.cellCount()) {
    throw hyselam::InputError("grid map", "", "its cells do not fit its size");
  }
  if (std::max(grid.geometry.width, grid.geometry.height) > DistanceMap::kMaxSide) {
    throw hyselam::InputError("grid map", "", "a side has more than 32767 cells");
  }
  if (!(grid.geometry.resolution > 0.0)) {
    throw hyselam::InputError("grid map", "", "its resolution is not positive");
  }
}

cv::Point toPoint(Cell c) {
  return {c.x, c.y};
}

}  // namespace

ThesisResult runThesis(const OccupancyGrid& grid, const ThesisParams& params) {
  check(params);
  check(grid);
  const double cells = 1.0 / grid.geometry.resolution;
  const double door_min = 0.5 * params.door_min * cells, door_max = 0.5 * params.door_max * cells;
  ThesisResult r;
  r.filtered = filterIsolatedCells(grid, params.free_max, params.occupied_min);
  r.obstacles =
      obstaclesOf(r.filtered, params.free_max, params.occupied_min, params.unknown_blocks);

  const DistanceMap distances(r.obstacles);
  r.squared_distance = distances.squaredView().clone();
  if (cv::countNonZero(r.obstacles) > 0) {
    r.candidates = centralLocations(doorCells(distances, door_min, door_max), door_min);
  }
  r.voronoi = VoronoiDiagram(distances, params.voronoi).lines();
  if (!params.unknown_blocks) {
    // Places are on free floor only.
    r.voronoi.setTo(0, obstaclesOf(r.filtered, params.free_max, params.occupied_min, true));
  }
  r.critical_points = findCriticalPoints(distances, r.voronoi, params.critical_radius * cells);
  r.doors = validateDoors(r.candidates, r.critical_points, door_min, door_max);
  r.circles = dropCoveredCircles(packCircles(distances, r.voronoi), distances);

  cv::Mat closed(r.obstacles.size(), CV_8UC1, cv::Scalar(0));
  for (const ConfirmedDoor& d : r.doors) {
    cv::line(closed, toPoint(d.critical.basis_a), toPoint(d.critical.basis_b), 255, 1, cv::LINE_4);
  }
  // A circle in a doorway is no place, nor one that is narrower than the narrowest door.
  r.circles.erase(std::remove_if(r.circles.begin(), r.circles.end(),
                                 [&](const Circle& c) {
                                   return c.radius <= door_min ||
                                          closed.at<std::uint8_t>(c.centre.y, c.centre.x) != 0;
                                 }),
                  r.circles.end());
  if (r.circles.size() > kMaxPlaces) {
    throw hyselam::InputError("grid map", "", "gives more than 65535 places");
  }
  r.links = connectCircles(r.circles, r.voronoi);
  r.polygons = drawPolygons(r.circles, r.obstacles | closed, params.wall_share);

  const cv::Mat floor = obstaclesOf(r.filtered, params.free_max, params.occupied_min, true) == 0;
  PolygonLabels places(floor & (closed == 0), r.circles, r.polygons);
  if (params.fill) places.fill(floor & closed);
  r.segmentation.labels = places.labels();
  r.segmentation.places = static_cast<int>(r.circles.size());
  r.segmentation.doors = doorLines(r.filtered, r.segmentation.labels, r.doors, params);
  return r;
}

Segmentation segmentThesis(const OccupancyGrid& grid, const ThesisParams& params) {
  return runThesis(grid, params).segmentation;
}

}  // namespace hyselam_topo
