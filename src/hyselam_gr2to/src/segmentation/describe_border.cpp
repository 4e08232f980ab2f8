#include "describe_border.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <tuple>
#include <utility>

namespace hyselam_topo {
namespace {

/// Nothing here is as small as a tenth of a cell.
double logOf(double value, double offset = 1e-3) {
  return std::log(value + offset);
}

struct Rectangle {
  double area;        // [m^2]
  double elongation;  // >= 1
};

Rectangle enclosing(const std::vector<cv::Point>& hull, double resolution) {
  if (hull.size() < 3) return {resolution * resolution * static_cast<double>(hull.size()), 1.0};
  const cv::Size2f size = cv::minAreaRect(hull).size;
  const double w = size.width + 1.0, h = size.height + 1.0;  // corners are centers of cells
  return {w * h * resolution * resolution, std::max(w, h) / std::min(w, h)};
}

/// The two sides of a border, in two orders.
struct Sides {
  const RegionNode* smaller;  // by area
  const RegionNode* larger;
  double smaller_peak;
  double larger_peak;
  double smaller_mean;  // twice the mean clearance: near the half width of a corridor
  double larger_mean;
};

double twiceMeanClearance(const RegionNode& node) {
  return 2.0 * node.clearances / node.area;
}

Sides sidesOf(const RegionAdjacencyGraph& graph, int a, int b) {
  Sides sides{&graph.node(a), &graph.node(b), 0.0, 0.0, 0.0, 0.0};
  if (sides.smaller->area > sides.larger->area ||
      (sides.smaller->area == sides.larger->area && a > b)) {
    std::swap(sides.smaller, sides.larger);
  }
  std::tie(sides.smaller_peak, sides.larger_peak) =
      std::minmax(sides.smaller->peak, sides.larger->peak);
  const double first = twiceMeanClearance(*sides.smaller);
  const double second = twiceMeanClearance(*sides.larger);
  sides.smaller_mean = std::min(first, second);
  sides.larger_mean = std::max(first, second);
  return sides;
}

void describeClearance(const Sides& sides, const RegionBorder& border, BorderFeatures& out) {
  const double clearance = logOf(border.clearance);
  out[BorderFeature::kClearance] = clearance;
  out[BorderFeature::kClearanceToSmallerPeak] = clearance - logOf(sides.smaller_peak);
  out[BorderFeature::kClearanceToLargerPeak] = clearance - logOf(sides.larger_peak);
  out[BorderFeature::kClearanceToSmallerMean] = clearance - logOf(sides.smaller_mean);
  out[BorderFeature::kClearanceToLargerMean] = clearance - logOf(sides.larger_mean);
}

void describeLengths(const Sides& sides, const RegionBorder& border, BorderFeatures& out) {
  const RegionNode &smaller = *sides.smaller, &larger = *sides.larger;
  const double twice_clearance = logOf(2.0 * border.clearance, 0.05);
  out[BorderFeature::kOpenShare] = border.open / (border.open + border.wall);
  out[BorderFeature::kOpenToSmallerPerimeter] = border.open / smaller.perimeter;
  out[BorderFeature::kOpenToLargerPerimeter] = border.open / larger.perimeter;
  out[BorderFeature::kOpenToSmallerSide] = border.open / std::sqrt(smaller.area);
  out[BorderFeature::kOpenToClearance] = logOf(border.open, 0.05) - twice_clearance;
  out[BorderFeature::kWallToSmallerPerimeter] = border.wall / smaller.perimeter;
  out[BorderFeature::kWeakerWall] = border.passage.weaker_wall;
  out[BorderFeature::kStrongerWall] = border.passage.stronger_wall;
  out[BorderFeature::kPassageToClearance] = logOf(border.passage.width, 0.05) - twice_clearance;
}

void describeShapes(const Sides& sides, double cell, BorderFeatures& out) {
  const RegionNode &smaller = *sides.smaller, &larger = *sides.larger;
  std::vector<cv::Point> points(smaller.hull), hull;
  points.insert(points.end(), larger.hull.begin(), larger.hull.end());
  cv::convexHull(points, hull);
  const double area = smaller.area + larger.area;
  const double hull_area = hull.size() < 3 ? 0.0 : cv::contourArea(hull) * cell * cell;
  const double joint_solidity = logOf(area / std::max(hull_area, area), 0.0);
  const double parts_solidity =
      logOf(area / std::max(smaller.hull_area + larger.hull_area, area), 0.0);
  const Rectangle joint_box = enclosing(hull, cell);
  const Rectangle smaller_box = enclosing(smaller.hull, cell);
  const Rectangle larger_box = enclosing(larger.hull, cell);

  out[BorderFeature::kSmallerArea] = logOf(smaller.area, 0.1);
  out[BorderFeature::kLargerArea] = logOf(larger.area, 0.1);
  out[BorderFeature::kSmallerAreaToPeak] =
      logOf(smaller.area / (smaller.peak * smaller.peak + 0.01));
  out[BorderFeature::kLargerAreaToPeak] = logOf(larger.area / (larger.peak * larger.peak + 0.01));
  out[BorderFeature::kJointSolidity] = joint_solidity;
  out[BorderFeature::kPartsSolidity] = parts_solidity;
  out[BorderFeature::kSolidityGain] = joint_solidity - parts_solidity;
  out[BorderFeature::kSmallerSolidity] =
      logOf(smaller.area / std::max(smaller.hull_area, smaller.area), 0.0);
  out[BorderFeature::kJointRectangularity] = logOf(area / joint_box.area, 0.0);
  out[BorderFeature::kSmallerRectangularity] = logOf(smaller.area / smaller_box.area, 0.0);
  out[BorderFeature::kLargerRectangularity] = logOf(larger.area / larger_box.area, 0.0);
  out[BorderFeature::kJointElongation] = logOf(joint_box.elongation, 0.0);
  out[BorderFeature::kSmallerElongation] = logOf(smaller_box.elongation, 0.0);
}

}  // namespace

BorderFeatures describeBorder(const RegionAdjacencyGraph& graph, int a, int b) {
  const Sides sides = sidesOf(graph, a, b);
  const RegionBorder& border = graph.border(graph.node(a).borders.at(b));
  BorderFeatures features;
  describeClearance(sides, border, features);
  describeLengths(sides, border, features);
  describeShapes(sides, graph.resolution(), features);
  return features;
}

}  // namespace hyselam_topo
