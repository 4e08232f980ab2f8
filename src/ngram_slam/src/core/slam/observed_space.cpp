#include "ngram_slam/slam/observed_space.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::Point2;
using hyselam::Pose2;
using hyselam_scan_matching::SurfacePoint;
using hyselam_scan_matching::SurfacePoints;

ObservedSpace::ObservedSpace(double side, double cell) : half_(0.5 * side), cell_(cell), size_(0) {
  if (!(cell > 0.0)) throw hyselam::ParameterError("cell", cell, "above 0");
  if (!(side > 0.0 && side / cell <= 8192.0))
    throw hyselam::ParameterError("side", side, "above 0, at most 8192 cells");
  size_ = static_cast<int>(std::ceil(side / cell));
  cells_.assign(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_), kUnknown);
}

std::optional<ObservedSpace::Cell> ObservedSpace::cellAt(double x, double y) const {
  const double fx = (x + half_) / cell_, fy = (y + half_) / cell_;
  if (!(fx >= 0.0 && fy >= 0.0 && fx < size_ && fy < size_)) return std::nullopt;
  return Cell{static_cast<int>(fx), static_cast<int>(fy)};
}

void ObservedSpace::raiseCell(int x, int y, std::uint8_t state) {
  if (x < 0 || y < 0 || x >= size_ || y >= size_) return;
  std::uint8_t& c = cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
                           static_cast<std::size_t>(x)];
  c = std::max(c, state);
}

void ObservedSpace::insert(const Pose2& pose, const SurfacePoints& points, const Point2& laser) {
  const Point2 origin = pose * laser;
  for (const SurfacePoint& p : points) {
    const Point2 q = pose * Point2{p.x, p.y};
    const double dx = q.x - origin.x, dy = q.y - origin.y, range = std::hypot(dx, dy);
    // Less than a cell a step; not as far as the surface, which is marked below and may be uneven.
    const double step = 0.7 * cell_;
    const int steps = static_cast<int>((range - 2.0 * cell_) / step);
    for (int i = 1; i <= steps; ++i) {
      const double t = i * step / range;
      const auto cell = cellAt(origin.x + t * dx, origin.y + t * dy);
      if (!cell) break;
      raiseCell(cell->x, cell->y, kFree);
    }
    const auto cell = cellAt(q.x, q.y);
    if (!cell) continue;
    for (int y = cell->y - 1; y <= cell->y + 1; ++y) {
      for (int x = cell->x - 1; x <= cell->x + 1; ++x) raiseCell(x, y, kBesideSurface);
    }
    raiseCell(cell->x, cell->y, kSurface);
  }
}

Overlap ObservedSpace::overlap(const Pose2& pose, const SurfacePoints& points) const {
  Overlap result;
  if (points.empty()) return result;
  std::size_t observed = 0, on_surface = 0;
  for (const SurfacePoint& p : points) {
    const Point2 q = pose * Point2{p.x, p.y};
    const auto cell = cellAt(q.x, q.y);
    if (!cell) continue;
    const std::uint8_t state =
        cells_[static_cast<std::size_t>(cell->y) * static_cast<std::size_t>(size_) +
               static_cast<std::size_t>(cell->x)];
    if (state == kUnknown) continue;
    ++observed;
    if (state >= kBesideSurface) ++on_surface;
  }
  result.observed_ratio = static_cast<double>(observed) / static_cast<double>(points.size());
  result.surface_ratio =
      observed > 0 ? static_cast<double>(on_surface) / static_cast<double>(observed) : 0.0;
  return result;
}

}  // namespace ngram_slam
