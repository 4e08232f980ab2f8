#include "ngram_slam/slam/seen_space.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::Point2;
using hyselam::Pose2;
using hyselam_scan_matching::SurfacePoint;
using hyselam_scan_matching::SurfacePoints;

SeenSpace::SeenSpace(double side, double cell) : half_(0.5 * side), cell_(cell), size_(0) {
  if (!(cell > 0.0)) throw hyselam::ParameterError("cell", cell, "above 0");
  if (!(side > 0.0 && side / cell <= 8192.0))
    throw hyselam::ParameterError("side", side, "above 0, at most 8192 cells");
  size_ = static_cast<int>(std::ceil(side / cell));
  cells_.assign(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_), kUnknown);
}

bool SeenSpace::cellOf(double x, double y, int* cx, int* cy) const {
  const double fx = (x + half_) / cell_, fy = (y + half_) / cell_;
  if (!(fx >= 0.0 && fy >= 0.0 && fx < size_ && fy < size_)) return false;
  *cx = static_cast<int>(fx);
  *cy = static_cast<int>(fy);
  return true;
}

void SeenSpace::mark(int x, int y, std::uint8_t what) {
  if (x < 0 || y < 0 || x >= size_ || y >= size_) return;
  std::uint8_t& c = cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
                           static_cast<std::size_t>(x)];
  c = std::max(c, what);
}

void SeenSpace::insert(const Pose2& pose, const SurfacePoints& points, const Point2& laser) {
  const Point2 eye = pose * laser;
  for (const SurfacePoint& p : points) {
    const Point2 q = pose * Point2{p.x, p.y};
    const double dx = q.x - eye.x, dy = q.y - eye.y, range = std::hypot(dx, dy);
    // Less than a cell a step; not as far as the surface, which is marked below and may be uneven.
    const double step = 0.7 * cell_;
    const int steps = static_cast<int>((range - 2.0 * cell_) / step);
    int cx = 0, cy = 0;
    for (int i = 1; i <= steps; ++i) {
      const double t = i * step / range;
      if (!cellOf(eye.x + t * dx, eye.y + t * dy, &cx, &cy)) break;
      mark(cx, cy, kFree);
    }
    if (!cellOf(q.x, q.y, &cx, &cy)) continue;
    for (int y = cy - 1; y <= cy + 1; ++y)
      for (int x = cx - 1; x <= cx + 1; ++x) mark(x, y, kNear);
    mark(cx, cy, kSurface);
  }
}

Overlap SeenSpace::overlap(const Pose2& pose, const SurfacePoints& points) const {
  Overlap o;
  if (points.empty()) return o;
  std::size_t known = 0, fits = 0;
  for (const SurfacePoint& p : points) {
    const Point2 q = pose * Point2{p.x, p.y};
    int cx = 0, cy = 0;
    if (!cellOf(q.x, q.y, &cx, &cy)) continue;
    const std::uint8_t c = cells_[static_cast<std::size_t>(cy) * static_cast<std::size_t>(size_) +
                                  static_cast<std::size_t>(cx)];
    if (c == kUnknown) continue;
    ++known;
    if (c >= kNear) ++fits;
  }
  o.known = static_cast<double>(known) / static_cast<double>(points.size());
  o.fit = known > 0 ? static_cast<double>(fits) / static_cast<double>(known) : 0.0;
  return o;
}

}  // namespace ngram_slam
