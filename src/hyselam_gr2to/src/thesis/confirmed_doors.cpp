#include "confirmed_doors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace hyselam_topo {

using cv::Point2d;
using hyselam::OccupancyGrid;
using hyselam::Point2;

namespace {

/// The labels that a door separates: the first ones that are met on either side of its middle.
std::pair<int, int> sidesOf(const ConfirmedDoor& door, const cv::Mat& labels) {
  const hyselam::Cell p0 = door.critical.basis_a, q0 = door.critical.basis_b;
  const Point2d a(p0.x, p0.y), b(q0.x, q0.y);
  const double l = std::max(1e-9, std::hypot(b.x - a.x, b.y - a.y));
  const Point2d across{-(b.y - a.y) / l, (b.x - a.x) / l}, middle = 0.5 * (a + b);
  const auto first = [&](double sign) {
    for (int half = 3; half < 24; ++half) {
      const double s = 0.5 * half;  // cells from the middle
      const Point2d p = middle + sign * s * across;
      const int x = static_cast<int>(std::lround(p.x)), y = static_cast<int>(std::lround(p.y));
      if (x < 0 || y < 0 || x >= labels.cols || y >= labels.rows) return 0;
      if (labels.at<std::uint16_t>(y, x) != 0) return int{labels.at<std::uint16_t>(y, x)};
    }
    return 0;
  };
  const int p = first(1.0), q = first(-1.0);
  return {std::min(p, q), std::max(p, q)};
}

Point2 middleOf(const DoorLine& line) {
  return {0.5 * (line.a.x + line.b.x), 0.5 * (line.a.y + line.b.y)};
}

/// The line between the faces of the two walls, which are half a cell nearer than their cells'
/// centres; nothing if they touch.
std::optional<DoorLine> lineOf(const ConfirmedDoor& door, const hyselam::GridGeometry& geometry) {
  DoorLine line;
  line.a = geometry.center(door.critical.basis_a);
  line.b = geometry.center(door.critical.basis_b);
  const double across = std::hypot(line.b.x - line.a.x, line.b.y - line.a.y);
  const double r = geometry.resolution;
  if (across <= r) return std::nullopt;
  const Point2 half{0.5 * r * (line.b.x - line.a.x) / across,
                    0.5 * r * (line.b.y - line.a.y) / across};
  line.a = {line.a.x + half.x, line.a.y + half.y};
  line.b = {line.b.x - half.x, line.b.y - half.y};
  line.width = across - r;
  return line;
}

/// Puts a door in, in place of the border that was found there.
void put(const DoorLine& door, double door_max, std::vector<DoorLine>& lines) {
  const Point2 middle = middleOf(door);
  auto border = lines.end();
  double nearest = door_max;
  for (auto it = lines.begin(); it != lines.end(); ++it) {
    const Point2 there = middleOf(*it);
    const double d = std::hypot(there.x - middle.x, there.y - middle.y);
    if (it->place_a != door.place_a || it->place_b != door.place_b || it->real || d >= nearest) {
      continue;
    }
    nearest = d;
    border = it;
  }
  if (border == lines.end()) {
    lines.push_back(door);
  } else {
    *border = door;
  }
}

}  // namespace

std::vector<ConfirmedDoor> validateDoors(const std::vector<Point2d>& candidates,
                                         const std::vector<CriticalPoint>& critical,
                                         double min_radius, double max_radius) {
  std::vector<std::size_t> choice(critical.size(), candidates.size());
  std::vector<double> distance(critical.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    std::size_t best = critical.size();
    double nearest = max_radius;
    for (std::size_t k = 0; k < critical.size(); ++k) {
      if (critical[k].clearance <= min_radius || critical[k].clearance >= max_radius) continue;
      const double dx = critical[k].at.x - candidates[i].x, dy = critical[k].at.y - candidates[i].y;
      const double d = std::sqrt(dx * dx + dy * dy);
      if (d > nearest) continue;
      nearest = d;
      best = k;
    }
    if (best == critical.size() || nearest >= distance[best]) continue;
    distance[best] = nearest;
    choice[best] = i;
  }
  std::vector<ConfirmedDoor> out;
  for (std::size_t k = 0; k < critical.size(); ++k) {
    if (choice[k] < candidates.size()) out.push_back({candidates[choice[k]], critical[k]});
  }
  return out;
}

std::vector<DoorLine> doorLines(const OccupancyGrid& grid, const cv::Mat& labels,
                                const std::vector<ConfirmedDoor>& doors,
                                const ThesisParams& params) {
  DoorParams found;
  found.free_max = params.free_max;
  std::vector<DoorLine> out = refineDoors(grid, labels, found);
  for (DoorLine& d : out) d.real = false;
  for (const ConfirmedDoor& door : doors) {
    const auto [p, q] = sidesOf(door, labels);
    if (p == 0 || q == 0 || p == q) continue;
    std::optional<DoorLine> line = lineOf(door, grid.geometry);
    if (!line) continue;
    line->place_a = p;
    line->place_b = q;
    put(*line, params.door_max, out);
  }
  std::sort(out.begin(), out.end(), [](const DoorLine& p, const DoorLine& q) {
    if (p.place_a != q.place_a) return p.place_a < q.place_a;
    if (p.place_b != q.place_b) return p.place_b < q.place_b;
    return p.a.x != q.a.x ? p.a.x < q.a.x : p.a.y < q.a.y;
  });
  return out;
}

}  // namespace hyselam_topo
