#include "hyselam_topo/dialogue/place_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/place_paths.hpp"
#include "plane.hpp"

namespace hyselam_topo {
namespace {

using hyselam::Point2;

/// Cells with at least this share of the best clearance are far enough from the walls ...
constexpr double kGoodShare = 0.7;
/// ... and so are those with this much of it [m].
constexpr double kGoodClearance = 1.0;

const Door* widestDoor(const AugmentedTopologicalMap& map, Id place) {
  const Door* widest = nullptr;
  for (const Edge& edge : map.edges) {
    if (edge.a != place && edge.b != place) continue;
    for (const Door& door : edge.doors) {
      if (widest == nullptr || door.width > widest->width) widest = &door;
    }
  }
  return widest;
}

/// Spread about a point of things whose sums are given.
struct Spread {
  double n = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  void add(double dx, double dy) {
    n += 1.0;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
};

std::array<double, 9> covarianceOf(const Spread& s) {
  const double n = std::max(1.0, s.n);
  const double any_heading = hyselam::kPi * hyselam::kPi / 3.0;
  return {s.xx / n, s.xy / n, 0.0, s.xy / n, s.yy / n, 0.0, 0.0, 0.0, any_heading};
}

/// The pose by the cells of the place; nothing if it has none.
std::optional<PlacePose> poseOfCells(const PlaceGrid& grid, const Place& place) {
  const auto boxes = placeBoxes(grid);
  const auto found = boxes.find(place.id);
  if (found == boxes.end()) return std::nullopt;
  const CellBox& box = found->second;
  // A margin of one cell: beyond the box is outside of the place.
  cv::Mat mask(box.y_end - box.y_begin + 2, box.x_end - box.x_begin + 2, CV_8UC1, cv::Scalar(0));
  Point2 mean;
  double count = 0.0;
  for (int y = box.y_begin; y < box.y_end; ++y) {
    for (int x = box.x_begin; x < box.x_end; ++x) {
      if (grid.placeOf({x, y}) != place.id) continue;
      mask.at<std::uint8_t>(y - box.y_begin + 1, x - box.x_begin + 1) = 255;
      const Point2 p = grid.geometry.center({x, y});
      mean.x += p.x;
      mean.y += p.y;
      count += 1.0;
    }
  }
  const Point2 middle = place.centre ? Point2{place.centre->x, place.centre->y}
                                     : Point2{mean.x / count, mean.y / count};
  cv::Mat clearance;
  cv::distanceTransform(mask, clearance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  double most = 0.0;
  cv::minMaxLoc(clearance, nullptr, &most);
  const double enough = std::min(kGoodShare * most, kGoodClearance / grid.geometry.resolution);
  double least = std::numeric_limits<double>::infinity();
  PlacePose result;
  for (int y = box.y_begin; y < box.y_end; ++y) {
    for (int x = box.x_begin; x < box.x_end; ++x) {
      const double here = clearance.at<float>(y - box.y_begin + 1, x - box.x_begin + 1);
      if (here <= 0.0 || here < enough) continue;
      const Point2 p = grid.geometry.center({x, y});
      const double d = distanceBetween(p, middle);
      if (d >= least) continue;
      least = d;
      result.pose = {p.x, p.y, 0.0};
      result.clearance = here * grid.geometry.resolution;
    }
  }
  Spread spread;
  for (int y = box.y_begin; y < box.y_end; ++y) {
    for (int x = box.x_begin; x < box.x_end; ++x) {
      if (mask.at<std::uint8_t>(y - box.y_begin + 1, x - box.x_begin + 1) == 0) continue;
      const Point2 p = grid.geometry.center({x, y});
      spread.add(p.x - result.pose.x, p.y - result.pose.y);
    }
  }
  result.covariance = covarianceOf(spread);
  return result;
}

}  // namespace

std::optional<PlacePose> placePose(const AugmentedTopologicalMap& map, Id id) {
  const Place* place = map.findPlace(id);
  if (place == nullptr) return std::nullopt;
  std::optional<PlacePose> result;
  if (map.grid) result = poseOfCells(*map.grid, *place);
  if (!result && place->centre) {
    result.emplace();
    result->pose = {place->centre->x, place->centre->y, 0.0};
    Spread spread;
    for (const Point2& corner : place->outline) {
      // A disc's spread is a quarter of that of its rim; that of other shapes is not far from it.
      spread.add(0.5 * (corner.x - result->pose.x), 0.5 * (corner.y - result->pose.y));
    }
    result->covariance = covarianceOf(spread);
  }
  if (!result) return std::nullopt;
  if (const Door* door = widestDoor(map, id)) {
    result->pose.theta =
        std::atan2(result->pose.y - door->position.y, result->pose.x - door->position.x);
  }
  return result;
}

}  // namespace hyselam_topo
