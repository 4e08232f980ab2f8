#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "place_graph.hpp"

namespace hyselam_topo {
namespace {

/// Logarithms make ratios of lengths differences; nothing here is as small as a tenth of a cell.
double logOf(double value, double least = 1e-3) {
  return std::log(value + least);
}

struct Rectangle {
  double area;    // [m^2]
  double aspect;  // >= 1
};

Rectangle enclosing(const std::vector<cv::Point>& hull, double resolution) {
  if (hull.size() < 3) return {resolution * resolution * static_cast<double>(hull.size()), 1.0};
  const cv::Size2f size = cv::minAreaRect(hull).size;
  const double w = size.width + 1.0, h = size.height + 1.0;  // corners are centres of cells
  return {w * h * resolution * resolution, std::max(w, h) / std::min(w, h)};
}

}  // namespace

BorderFeatures describeBorder(const PlaceGraph& graph, int a, int b) {
  const double cell = graph.resolution();
  const PlaceNode* narrow = &graph.node(a);
  const PlaceNode* wide = &graph.node(b);
  const PlaceBorder& border = graph.border(narrow->borders.at(b));
  const PlaceNode* small = narrow;
  const PlaceNode* large = wide;
  if (narrow->peak > wide->peak || (narrow->peak == wide->peak && a > b)) std::swap(narrow, wide);
  if (small->area > large->area || (small->area == large->area && a > b)) std::swap(small, large);

  std::vector<cv::Point> points(small->hull), hull;
  points.insert(points.end(), large->hull.begin(), large->hull.end());
  cv::convexHull(points, hull);
  const double area = small->area + large->area;
  const double hull_area = hull.size() < 3 ? 0.0 : cv::contourArea(hull) * cell * cell;
  const double solidity = logOf(area / std::max(hull_area, area), 0.0);
  const double parts_solidity =
      logOf(area / std::max(small->hull_area + large->hull_area, area), 0.0);
  // Twice the mean clearance is near the half width of a corridor.
  const double small_mean = 2.0 * small->clearances / small->area;
  const double large_mean = 2.0 * large->clearances / large->area;
  const Rectangle both = enclosing(hull, cell);
  const Rectangle small_box = enclosing(small->hull, cell);
  const Rectangle large_box = enclosing(large->hull, cell);
  const double saddle = logOf(border.saddle);

  return {saddle,
          saddle - logOf(narrow->peak),
          saddle - logOf(wide->peak),
          saddle - logOf(std::min(small_mean, large_mean)),
          saddle - logOf(std::max(small_mean, large_mean)),
          logOf(small->area, 0.1),
          logOf(large->area, 0.1),
          border.open / (border.open + border.wall),
          solidity,
          solidity - parts_solidity,
          border.open / small->perimeter,
          border.open / std::sqrt(small->area),
          logOf(small->area / (small->peak * small->peak + 0.01)),
          logOf(large->area / (large->peak * large->peak + 0.01)),
          border.passage.weaker_wall,
          border.passage.stronger_wall,
          logOf(border.passage.width, 0.05) - logOf(2.0 * border.saddle, 0.05),
          logOf(border.open, 0.05) - logOf(2.0 * border.saddle, 0.05),
          border.wall / small->perimeter,
          parts_solidity,
          logOf(area / both.area, 0.0),
          logOf(small->area / small_box.area, 0.0),
          logOf(large->area / large_box.area, 0.0),
          logOf(both.aspect, 0.0),
          logOf(small_box.aspect, 0.0),
          logOf(small->area / std::max(small->hull_area, small->area), 0.0),
          border.open / large->perimeter};
}

BorderFeatures resized(BorderFeatures border, double lengths, double saddle) {
  for (std::size_t i = 0; i < 5; ++i) border[i] += saddle;
  border[17] -= saddle;  // the open border beside the clearance
  border[0] += lengths;
  border[5] += 2.0 * lengths;  // areas
  border[6] += 2.0 * lengths;
  return border;
}

}  // namespace hyselam_topo
