#include "hyselam_sim/path_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <queue>

#include "hyselam_common/errors.hpp"

namespace hyselam_sim {
namespace {

using hyselam::Cell;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kStride = 2;              // lattice points per this many cells of the clearance map
constexpr double kSnapRadius = 0.3;     // how far an end may be from its lattice point [m]
constexpr double kShortcutReach = 8.0;  // longest straight shortcut [m]
constexpr int kSmoothingRounds = 100;

// Cost of a metre of way at that clearance.
double price(double clearance, const PlannerParams& p) {
  const double lack = std::max(0.0, 1.0 - clearance / p.comfortable_clearance);
  return 1.0 + p.discomfort * lack * lack;
}

class Planner {
 public:
  Planner(const ClearanceMap& clearance, const PlannerParams& params)
      : map_(clearance),
        params_(params),
        width_((clearance.geometry().width + kStride - 1) / kStride),
        height_((clearance.geometry().height + kStride - 1) / kStride) {}

  std::optional<std::vector<Point2>> search(Point2 from, Point2 to) const {
    const std::optional<int> start = snap(from), goal = snap(to);
    if (!start || !goal) return std::nullopt;
    const auto nodes = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    std::vector<double> cost(nodes, kInfinity);
    std::vector<int> parent(nodes, -1);
    using Entry = std::pair<double, int>;  // ordered by estimate, then node: no ties left to chance
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> open;
    const Point2 aim = point(*goal);
    cost[static_cast<std::size_t>(*start)] = 0.0;
    open.emplace(length(aim - point(*start)), *start);
    while (!open.empty()) {
      const auto [estimate, node] = open.top();
      open.pop();
      if (node == *goal) break;
      const Point2 p = point(node);
      const double so_far = cost[static_cast<std::size_t>(node)];
      if (estimate > so_far + length(aim - p) + 1e-9) continue;
      const int x = node % width_, y = node / width_;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const int nx = x + dx, ny = y + dy;
          if ((dx == 0 && dy == 0) || nx < 0 || ny < 0 || nx >= width_ || ny >= height_) continue;
          const int next = ny * width_ + nx;
          const Point2 q = point(next);
          const double clear = map_.at(q);
          if (clear < params_.min_clearance) continue;
          const double c =
              so_far + length(q - p) * 0.5 * (price(clear, params_) + price(map_.at(p), params_));
          if (c >= cost[static_cast<std::size_t>(next)] - 1e-12) continue;
          cost[static_cast<std::size_t>(next)] = c;
          parent[static_cast<std::size_t>(next)] = node;
          open.emplace(c + length(aim - q), next);
        }
      }
    }
    if (!(cost[static_cast<std::size_t>(*goal)] < kInfinity)) return std::nullopt;
    std::vector<Point2> path{to};
    for (int n = *goal; n >= 0; n = parent[static_cast<std::size_t>(n)]) path.push_back(point(n));
    path.push_back(from);
    std::reverse(path.begin(), path.end());
    return path;
  }

  /// Replaces pieces by straight lines wherever those are not dearer.
  std::vector<Point2> shorten(const std::vector<Point2>& path) const {
    std::vector<double> along(path.size(), 0.0);
    for (std::size_t i = 1; i < path.size(); ++i) {
      // An end of the path may lie nearer to a wall than its middle may.
      const double piece = straightCost(path[i - 1], path[i]);
      along[i] = along[i - 1] +
                 (piece < kInfinity ? piece : length(path[i] - path[i - 1]) * price(0.0, params_));
    }
    std::vector<Point2> out{path.front()};
    for (std::size_t i = 0; i + 1 < path.size();) {
      std::size_t best = i + 1;
      for (std::size_t j = i + 2; j < path.size() && length(path[j] - path[i]) < kShortcutReach;
           ++j) {
        if (straightCost(path[i], path[j]) <= along[j] - along[i] + 1e-9) best = j;
      }
      out.push_back(path[best]);
      i = best;
    }
    return out;
  }

  /// Rounds corners: each point moves towards the middle of its neighbours while there is room.
  void relax(std::vector<Point2>& path) const {
    for (int round = 0; round < kSmoothingRounds; ++round) {
      for (std::size_t i = 1; i + 1 < path.size(); ++i) {
        const Point2 q = path[i] + 0.5 * (0.5 * (path[i - 1] + path[i + 1]) - path[i]);
        const double needed =
            std::max(params_.min_clearance, std::min(map_.at(path[i]), params_.smooth_clearance));
        if (map_.at(q) >= needed) path[i] = q;
      }
    }
  }

 private:
  Point2 point(int node) const {
    return map_.geometry().center({(node % width_) * kStride, (node / width_) * kStride});
  }

  std::optional<int> snap(Point2 p) const {
    const Cell c = map_.geometry().cellAt(p);
    const int reach = static_cast<int>(kSnapRadius / map_.geometry().resolution / kStride) + 1;
    std::optional<int> best;
    double nearest = kSnapRadius;
    for (int y = c.y / kStride - reach; y <= c.y / kStride + reach; ++y) {
      for (int x = c.x / kStride - reach; x <= c.x / kStride + reach; ++x) {
        if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
        const Point2 q = point(y * width_ + x);
        const double d = length(q - p);
        if (d < nearest && map_.at(q) >= params_.min_clearance) {
          nearest = d;
          best = y * width_ + x;
        }
      }
    }
    return best;
  }

  double straightCost(Point2 a, Point2 b) const {
    const double l = length(b - a);
    const int steps = std::max(1, static_cast<int>(std::ceil(l / 0.05)));
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
      const double clear = map_.at(a + ((i + 0.5) / steps) * (b - a));
      if (clear < params_.min_clearance) return kInfinity;
      sum += price(clear, params_);
    }
    return sum * l / steps;
  }

  const ClearanceMap& map_;
  const PlannerParams& params_;
  int width_;
  int height_;
};

std::vector<Point2> resample(const std::vector<Point2>& path, double spacing) {
  std::vector<Point2> out{path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const std::vector<Point2> piece = straightPath(path[i - 1], path[i], spacing);
    out.insert(out.end(), piece.begin() + 1, piece.end());
  }
  return out;
}

}  // namespace

ClearanceMap::ClearanceMap(const hyselam::OccupancyGrid& grid) : geometry_(grid.geometry) {
  cv::Mat free(geometry_.height, geometry_.width, CV_8U);
  for (int y = 0; y < geometry_.height; ++y) {
    for (int x = 0; x < geometry_.width; ++x) {
      free.at<std::uint8_t>(y, x) = grid.at({x, y}) == hyselam::OccupancyGrid::kFree ? 255 : 0;
    }
  }
  cv::distanceTransform(free, meters_, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  // From the cell's centre to the near side of the obstacle's cell.
  meters_ = (meters_ - 0.5) * geometry_.resolution;
}

double ClearanceMap::at(Point2 p) const {
  const Cell c = geometry_.cellAt(p);
  if (!geometry_.contains(c)) return 0.0;
  return std::max(0.0, static_cast<double>(meters_.at<float>(c.y, c.x)));
}

ClearanceMap ClearanceMap::without(const std::vector<Point2>& centers, double radius) const {
  ClearanceMap out(*this);
  out.meters_ = meters_.clone();
  const Point2 reach{radius, radius};
  for (const Point2& center : centers) {
    const Cell low = geometry_.cellAt(center - reach), high = geometry_.cellAt(center + reach);
    for (int y = std::max(0, low.y); y <= std::min(geometry_.height - 1, high.y); ++y) {
      for (int x = std::max(0, low.x); x <= std::min(geometry_.width - 1, high.x); ++x) {
        if (length(geometry_.center({x, y}) - center) <= radius) {
          out.meters_.at<float>(y, x) = 0.0F;
        }
      }
    }
  }
  return out;
}

std::vector<Point2> straightPath(Point2 from, Point2 to, double spacing) {
  const int steps = std::max(1, static_cast<int>(std::ceil(length(to - from) / spacing - 1e-9)));
  std::vector<Point2> out;
  for (int i = 0; i <= steps; ++i) out.push_back(from + (double(i) / steps) * (to - from));
  return out;
}

void PlannerParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("min_clearance", min_clearance, Range::any(), "m", "of the center line from walls");
  visit("comfortable_clearance", comfortable_clearance, Range::above(0.0), "m",
        "nearer than this costs extra");
  visit("discomfort", discomfort, Range::any(), "",
        "extra cost at no clearance, in multiples of the length");
  visit("smooth_clearance", smooth_clearance, Range::any(), "m",
        "kept by the rounding of corners where there is room");
  visit("spacing", spacing, Range::above(0.0), "m", "of the points of the path");
}

void PlannerParams::validate() const {
  hyselam::checkParameters(*this);
}

std::optional<std::vector<Point2>> planPath(const ClearanceMap& clearance, Point2 from, Point2 to,
                                            const PlannerParams& params) {
  params.validate();
  const Planner planner(clearance, params);
  const std::optional<std::vector<Point2>> lattice = planner.search(from, to);
  if (!lattice) return std::nullopt;
  std::vector<Point2> path = resample(planner.shorten(*lattice), params.spacing);
  planner.relax(path);
  return path;
}

}  // namespace hyselam_sim
