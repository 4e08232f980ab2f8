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

void ThesisParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("door_min", door_min, Range::above(0.0), "m", "Door_min: width of a door, at least");
  visit("door_max", door_max, Range::above(0.0), "m", "Door_max: width of a door, at most");
  visit("critical_radius", critical_radius, Range::above(0.0), "m",
        "within which a critical point is the narrowest");
  visit("wall_share", wall_share, Range::between(0.0, 1.0), "",
        "occupied part of a polygon's edge that makes it a wall");
  visit("free_max", free_max, Range::between(0, 99), "", "cells of 0 .. this value are free");
  visit("occupied_min", occupied_min, Range::between(1, 100), "",
        "cells of this value and more are occupied");
  visit("unknown_blocks", unknown_blocks, "unknown cells count as obstacles");
  visit("fill", fill, "free cells outside of all polygons go to the nearest place");
  visit.group("voronoi_", voronoi);
}

void ThesisParams::validate() const {
  hyselam::checkParameters(*this);
  hyselam::require("door_max", door_max, door_max > door_min, "> door_min");
  hyselam::require("occupied_min", occupied_min, occupied_min > free_max, "> free_max");
}

ThesisResult runThesis(const OccupancyGrid& grid, const ThesisParams& params) {
  params.validate();
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

PlaceSegmentation segmentThesis(const OccupancyGrid& grid, const ThesisParams& params) {
  return runThesis(grid, params).segmentation;
}

}  // namespace hyselam_topo
