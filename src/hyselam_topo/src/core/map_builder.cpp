#include "hyselam_topo/map_builder.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

#include "contours.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_topo/map_geometry.hpp"

namespace hyselam_topo {

using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;

namespace {

// What a label's cells say about a place.
struct Region {
  cv::Rect box;
  double cells = 0.0;
  cv::Point2d sum{0.0, 0.0};
  double filled = 0.0;       // cells with what stands free in the place
  double clearance = 0.0;    // radius of the largest circle in it [cells]
  cv::Point centre{-1, -1};  // inside, near the middle, away from the walls
};

std::vector<Region> regionsOf(const cv::Mat& labels, int places) {
  std::vector<Region> out(static_cast<std::size_t>(places));
  for (int y = 0; y < labels.rows; ++y) {
    const auto* row = labels.ptr<std::uint16_t>(y);
    for (int x = 0; x < labels.cols; ++x) {
      if (row[x] == 0 || row[x] > places) continue;
      Region& r = out[row[x] - 1u];
      r.box = r.cells == 0.0 ? cv::Rect(x, y, 1, 1) : r.box | cv::Rect(x, y, 1, 1);
      r.cells += 1.0;
      r.sum += cv::Point2d(x, y);
    }
  }
  return out;
}

// Looks at one place on its own: holes smaller than `min_island` [cells around] filled, distances
// to its limits.
void measure(const cv::Mat& labels, int label, double min_island, Region* region) {
  if (region->cells == 0.0) return;
  cv::Mat mask;
  cv::copyMakeBorder(labels(region->box) == label, mask, 1, 1, 1, 1, cv::BORDER_CONSTANT, 0);
  const cv::Mat own = mask.clone();
  cv::Mat parts;
  cv::Mat stats, centroids;
  const int count = cv::connectedComponentsWithStats(mask == 0, parts, stats, centroids, 4, CV_32S);
  const int outer = parts.at<int>(0, 0);
  for (int i = 1; i < count; ++i) {
    const double around =
        2.0 * (stats.at<int>(i, cv::CC_STAT_WIDTH) + stats.at<int>(i, cv::CC_STAT_HEIGHT));
    if (i != outer && around < min_island) mask.setTo(255, parts == i);
  }
  region->filled = cv::countNonZero(mask);
  cv::Mat distance;
  cv::distanceTransform(mask, distance, cv::DIST_L2, cv::DIST_MASK_5);
  double widest = 0.0;
  cv::minMaxLoc(distance, nullptr, &widest);
  region->clearance = widest - 0.5;
  const cv::Point2d mean =
      (1.0 / region->cells) * region->sum - cv::Point2d(region->box.x - 1.0, region->box.y - 1.0);
  double best = -1.0;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      if (own.at<std::uint8_t>(y, x) == 0 || distance.at<float>(y, x) < 0.5 * widest) continue;
      const double d = std::hypot(x - mean.x, y - mean.y);
      if (best >= 0.0 && d >= best) continue;
      best = d;
      region->centre = {x + region->box.x - 1, y + region->box.y - 1};
    }
  }
  // All the room may stand full of things that were filled: then any of its cells.
  for (int y = 0; y < own.rows && region->centre.x < 0; ++y) {
    for (int x = 0; x < own.cols; ++x) {
      if (own.at<std::uint8_t>(y, x) == 0) continue;
      region->centre = {x + region->box.x - 1, y + region->box.y - 1};
      break;
    }
  }
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

}  // namespace

AugmentedTopologicalMap buildTopologicalMap(const OccupancyGrid& grid,
                                            const Segmentation& segmentation,
                                            const MapBuilderParams& params) {
  const CorridorRule& rule = params.corridor;
  if (!(rule.max_width > 0.0)) {
    throw hyselam::ParameterError("corridor_max_width", rule.max_width, "> 0 m");
  }
  if (!(rule.min_elongation >= 1.0)) {
    throw hyselam::ParameterError("corridor_min_elongation", rule.min_elongation, ">= 1");
  }
  if (!(rule.long_elongation >= rule.min_elongation)) {
    throw hyselam::ParameterError("corridor_long_elongation", rule.long_elongation,
                                  ">= corridor_min_elongation");
  }
  const double r = grid.geometry.resolution;
  std::vector<PlaceWalls> walls = extractWalls(grid, segmentation, params.walls);
  walls.resize(static_cast<std::size_t>(segmentation.places));
  std::vector<Region> regions = regionsOf(segmentation.labels, segmentation.places);
  std::map<int, std::set<int>> neighbours;
  for (const DoorLine& d : segmentation.doors) {
    neighbours[d.place_a].insert(d.place_b);
    neighbours[d.place_b].insert(d.place_a);
  }

  AugmentedTopologicalMap map;
  map.grid.emplace();
  map.grid->geometry = grid.geometry;
  const cv::Mat labels =
      segmentation.labels.isContinuous() ? segmentation.labels : segmentation.labels.clone();
  map.grid->labels.assign(labels.ptr<std::uint16_t>(0),
                          labels.ptr<std::uint16_t>(0) + grid.geometry.cellCount());
  for (int label = 1; label <= segmentation.places; ++label) {
    Region& region = regions[static_cast<std::size_t>(label - 1)];
    measure(labels, label, params.walls.min_island / r, &region);
    Place place;
    place.id = static_cast<Id>(label);
    map.grid->places.push_back(place.id);
    place.area = region.cells * r * r;
    if (region.centre.x >= 0) {
      const Point2 c = grid.geometry.centre({region.centre.x, region.centre.y});
      place.centre = Point3{c.x, c.y, 0.0};
    }
    const double width = 2.0 * region.clearance * r;
    const double elongation = width > 0.0 ? region.filled * r * r / (width * width) : 0.0;
    const bool joins = static_cast<int>(neighbours[label].size()) >= rule.min_neighbours;
    if (width <= rule.max_width &&
        elongation >= (joins ? rule.min_elongation : rule.long_elongation)) {
      place.kind = PlaceKind::kCorridor;
    }
    PlaceWalls& own = walls[static_cast<std::size_t>(label - 1)];
    place.walls = std::move(own.walls);
    place.outline = std::move(own.outline);
    for (Wall& wall : place.walls) wall.id = map.next_wall_id++;
    map.places.push_back(std::move(place));
  }
  for (const DoorLine& line : segmentation.doors) {
    const Id a = static_cast<Id>(std::min(line.place_a, line.place_b)),
             b = static_cast<Id>(std::max(line.place_a, line.place_b));
    Edge* edge = map.findEdge(a, b);
    if (edge == nullptr) {
      map.edges.emplace_back();
      edge = &map.edges.back();
      edge->a = a;
      edge->b = b;
    }
    DoorLine ordered = line;
    ordered.place_a = static_cast<int>(a);
    ordered.place_b = static_cast<int>(b);
    Door door = doorOf(ordered, *map.grid);
    door.id = map.next_door_id++;
    edge->doors.push_back(std::move(door));
  }
  normalise(&map);
  return map;
}

}  // namespace hyselam_topo
