#include "hyselam_gr2to/map_builder/map_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "alongside.hpp"
#include "contour_walls.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/require.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "place_builder.hpp"
#include "segmentation/chamfer_distance.hpp"

namespace hyselam_topo {

using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;

namespace {

// What a label's cells say about a place.
struct Region {
  double cells = 0.0;
  double filled = 0.0;        // cells with what stands free in the place
  cv::Point2d sum{0.0, 0.0};  // of the cells' positions, then their mean
  double distances = 0.0;     // to the limits of the place, summed over `filled` [cells]
  float clearance = 0.0f;     // the largest of these distances
  cv::Point centre{-1, -1};   // inside, near the middle, away from the walls
  bool deep = false;          // the centre is
  double off_middle = 0.0;    // squared
};

// Gives the cells inside of a hole that are in no place to the place around it.
void fillHole(const Contour& hole, cv::Point offset, cv::Mat& labels) {
  std::vector<cv::Point> crossings;  // upright sides: row and column
  for (const ContourSide& side : hole.sides) {
    if (side.direction % 2 == 0) continue;
    crossings.emplace_back(side.from.x - offset.x,
                           (side.direction == 1 ? side.from.y : side.from.y - 1) - offset.y);
  }
  std::sort(crossings.begin(), crossings.end(), [](const cv::Point& p, const cv::Point& q) {
    return p.y != q.y ? p.y < q.y : p.x < q.x;
  });
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    auto* row = labels.ptr<std::uint16_t>(crossings[i].y);
    for (int x = crossings[i].x; x < crossings[i + 1].x; ++x) {
      if (row[x] == 0) row[x] = hole.label;
    }
  }
}

// The distance of each cell to the limits of its place, CV_32F.
cv::Mat distancesWithin(const cv::Mat& labels) {
  cv::Mat inner(labels.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 1; y + 1 < labels.rows; ++y) {
    const auto* below = labels.ptr<std::uint16_t>(y - 1);
    const auto* row = labels.ptr<std::uint16_t>(y);
    const auto* above = labels.ptr<std::uint16_t>(y + 1);
    auto* out = inner.ptr<std::uint8_t>(y);
    for (int x = 1; x + 1 < labels.cols; ++x) {  // without branches
      const bool is_inner = (row[x] != 0) & (row[x] == row[x - 1]) & (row[x] == row[x + 1]) &
                            (row[x] == below[x]) & (row[x] == above[x]);
      out[x] = static_cast<std::uint8_t>(is_inner ? 255 : 0);
    }
  }
  return chamferDistance(inner);
}

bool chosen(const std::vector<char>& selection, int label) {
  return selection.empty() || selection[static_cast<std::size_t>(label)] != 0;
}

// Around all cells that the contours enclose.
cv::Rect limitsOf(const std::vector<Contour>& contours) {
  cv::Point low(std::numeric_limits<int>::max(), std::numeric_limits<int>::max()), high(0, 0);
  for (const Contour& contour : contours) {
    for (const ContourSide& side : contour.sides) {
      low = {std::min(low.x, side.from.x), std::min(low.y, side.from.y)};
      high = {std::max(high.x, side.from.x), std::max(high.y, side.from.y)};
    }
  }
  return contours.empty() ? cv::Rect() : cv::Rect(low, high);
}

std::vector<Region> measure(const cv::Mat& all_labels, const std::vector<Contour>& contours,
                            int places, double resolution, const WallParams& walls,
                            const PlaceSelection& selection) {
  std::vector<Region> out(static_cast<std::size_t>(places));
  cv::Rect box = selection.measured_box;
  if (selection.measured.empty()) box &= limitsOf(contours);  // many maps have wide margins
  if (box.empty()) return out;
  const cv::Mat labels = all_labels(box);
  cv::Mat filled = labels.clone();
  for (const Contour& contour : contours) {
    if (chosen(selection.measured, contour.label) && isIsland(contour, resolution, walls)) {
      fillHole(contour, box.tl(), filled);
    }
  }
  const cv::Mat distance = distancesWithin(filled);
  for (int y = 0; y < labels.rows; ++y) {
    const auto* row = filled.ptr<std::uint16_t>(y);
    const auto* own = labels.ptr<std::uint16_t>(y);
    const auto* d = distance.ptr<float>(y);
    for (int x = 0; x < labels.cols; ++x) {
      if (row[x] == 0 || row[x] > places) continue;
      Region& r = out[row[x] - 1u];
      r.filled += 1.0;
      r.distances += d[x] + 0.5;
      r.clearance = std::max(r.clearance, d[x]);
      if (own[x] == 0) continue;
      r.cells += 1.0;
      r.sum += cv::Point2d(x, y);
    }
  }
  for (Region& r : out) {
    if (r.cells > 0.0) r.sum *= 1.0 / r.cells;
  }
  for (int y = 0; y < labels.rows; ++y) {
    const auto* own = labels.ptr<std::uint16_t>(y);
    const auto* d = distance.ptr<float>(y);
    for (int x = 0; x < labels.cols; ++x) {
      if (own[x] == 0 || own[x] > places) continue;
      Region& r = out[own[x] - 1u];
      // A place may have no cell of its own where it is widest: then any will do.
      const bool deep = d[x] >= 0.5f * r.clearance;
      if (!deep && (r.deep || r.centre.x >= 0)) continue;
      const double dx = x - r.sum.x, dy = y - r.sum.y, off = dx * dx + dy * dy;
      if (r.deep && off >= r.off_middle) continue;
      r.deep = deep;
      r.off_middle = off;
      r.centre = {x, y};
    }
  }
  for (Region& r : out) {
    if (r.centre.x >= 0) r.centre += box.tl();
  }
  return out;
}

// The normal of a door points from place a to place b: the label that is met first on its left.
Door doorOf(const DoorLine& line, const PlaceGrid& grid) {
  Door door = doorBetween(line.a, line.b);
  const double step = 0.5 * grid.geometry.resolution;
  int left_is_b = 0;
  for (int side : {1, -1}) {
    for (int i = 1; i < 40; ++i) {
      const Point2 p{door.position.x + side * i * step * door.normal.x,
                     door.position.y + side * i * step * door.normal.y};
      const Id place = grid.placeOf(grid.geometry.cellAt(p));
      if (place == static_cast<Id>(line.place_b)) left_is_b += side * (40 - i);
      if (place == static_cast<Id>(line.place_a)) left_is_b -= side * (40 - i);
    }
  }
  if (left_is_b < 0) door = doorBetween(line.b, line.a);
  door.real = line.real;
  door.width = line.width;
  door.state = DoorState::kOpen;
  return door;
}

// `neighbors`: how many other places it leads to.
PlaceKind kindOf(const Region& region, double resolution, int neighbors, const CorridorRule& rule) {
  if (region.filled <= 0.0) return PlaceKind::kRoom;
  // In a long strip the mean distance to its limits is a quarter of its width.
  const double width = 4.0 * resolution * region.distances / region.filled;
  const double elongation = region.filled * resolution * resolution / (width * width);
  const bool corridor = width <= rule.max_width &&
                        ((neighbors >= rule.min_neighbors && elongation >= rule.min_elongation) ||
                         (neighbors >= 2 && elongation >= rule.long_elongation));
  return corridor ? PlaceKind::kCorridor : PlaceKind::kRoom;
}

}  // namespace

void CorridorRule::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("max_width", max_width, Range::above(0.0), "m", "of a corridor");
  visit("min_neighbors", min_neighbors, Range::atLeast(0), "", "places that a corridor leads to");
  visit("min_elongation", min_elongation, Range::atLeast(1.0), "", "of a corridor then");
  visit("long_elongation", long_elongation, Range::atLeast(1.0), "",
        "of a corridor with two or three neighbors");
}

void CorridorRule::validate() const {
  hyselam::checkParameters(*this);
  hyselam::require("long_elongation", long_elongation, long_elongation >= min_elongation,
                   ">= min_elongation");
}

void MapBuilderParams::describe(hyselam::ParameterVisitor& visit) {
  visit.group("wall_", walls);
  visit.group("corridor_", corridor);
}

void MapBuilderParams::validate() const {
  walls.validate();
  corridor.validate();
}

Neighbors neighborsOf(const std::vector<DoorLine>& doors) {
  Neighbors out;
  for (const DoorLine& d : doors) {
    out[d.place_a].insert(d.place_b);
    out[d.place_b].insert(d.place_a);
  }
  return out;
}

std::vector<Place> buildPlaces(const OccupancyGrid& grid, const cv::Mat& labels, int places,
                               const Neighbors& neighbors, const MapBuilderParams& params,
                               const PlaceSelection& selection) {
  const double r = grid.geometry.resolution;
  const std::vector<Contour> contours = traceContours(labels, selection.box, selection.wanted);
  // Walls are found beside the measuring, which knows nothing of them.
  std::future<std::vector<PlaceWalls>> found =
      alongside([&] { return wallsAlong(contours, grid, labels, params.walls); });
  const std::vector<Region> regions = measure(labels, contours, places, r, params.walls, selection);
  std::vector<PlaceWalls> walls = found.get();
  walls.resize(static_cast<std::size_t>(places));
  std::vector<Place> out;
  for (int label = 1; label <= places; ++label) {
    if (!chosen(selection.wanted, label)) continue;
    const Region& region = regions[static_cast<std::size_t>(label - 1)];
    Place place;
    place.id = static_cast<Id>(label);
    place.area = region.cells * r * r;
    if (region.centre.x >= 0) {
      const Point2 c = grid.geometry.center({region.centre.x, region.centre.y});
      place.centre = Point3{c.x, c.y, 0.0};
    }
    const auto around = neighbors.find(label);
    place.kind =
        kindOf(region, r, around == neighbors.end() ? 0 : static_cast<int>(around->second.size()),
               params.corridor);
    PlaceWalls& own = walls[static_cast<std::size_t>(label - 1)];
    place.walls = std::move(own.walls);
    place.outline = std::move(own.outline);
    out.push_back(std::move(place));
  }
  return out;
}

AugmentedTopologicalMap assembleMap(const OccupancyGrid& grid, const cv::Mat& labels,
                                    std::vector<Place> places, const std::vector<DoorLine>& doors) {
  AugmentedTopologicalMap map;
  map.grid.emplace();
  map.grid->geometry = grid.geometry;
  map.grid->labels.assign(labels.ptr<std::uint16_t>(0),
                          labels.ptr<std::uint16_t>(0) + grid.geometry.cellCount());
  map.places = std::move(places);
  for (Place& place : map.places) {
    map.grid->places.push_back(place.id);
    for (Wall& wall : place.walls) wall.id = map.next_wall_id++;
  }
  for (const DoorLine& line : doors) {
    DoorLine ordered = line;
    ordered.place_a = std::min(line.place_a, line.place_b);
    ordered.place_b = std::max(line.place_a, line.place_b);
    const Id a = static_cast<Id>(ordered.place_a), b = static_cast<Id>(ordered.place_b);
    Edge* edge = map.findEdge(a, b);
    if (edge == nullptr) {
      map.edges.emplace_back();
      edge = &map.edges.back();
      edge->a = a;
      edge->b = b;
    }
    Door door = doorOf(ordered, *map.grid);
    door.id = map.next_door_id++;
    edge->doors.push_back(std::move(door));
  }
  normalize(map);
  return map;
}

AugmentedTopologicalMap buildTopologicalMap(const OccupancyGrid& grid,
                                            const PlaceSegmentation& segmentation,
                                            const MapBuilderParams& params) {
  params.validate();
  const cv::Mat labels =
      segmentation.labels.isContinuous() ? segmentation.labels : segmentation.labels.clone();
  if (labels.type() != CV_16UC1 || labels.cols != grid.geometry.width ||
      labels.rows != grid.geometry.height) {
    throw hyselam::InputError("labels", "", "they do not fit the grid");
  }
  PlaceSelection all;
  all.box = all.measured_box = cv::Rect(0, 0, labels.cols, labels.rows);
  return assembleMap(
      grid, labels,
      buildPlaces(grid, labels, segmentation.places, neighborsOf(segmentation.doors), params, all),
      segmentation.doors);
}

}  // namespace hyselam_topo
