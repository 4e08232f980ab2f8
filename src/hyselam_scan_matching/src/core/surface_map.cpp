#include "hyselam_scan_matching/surface_map.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "hyselam_common/errors.hpp"

namespace hyselam_scan_matching {

SurfaceMap::SurfaceMap(double cell) : cell_(cell) {
  if (!(cell > 0.0 && cell <= 10.0))
    throw hyselam::ParameterError("cell", cell, "above 0, at most 10");
}

void SurfaceMap::insert(const hyselam::Pose2& pose, const SurfacePoints& points) {
  for (const SurfacePoint& p : transformed(pose, points)) {
    if (sums_.empty()) {
      x0_ = p.x;
      y0_ = p.y;
    }
    if (!(std::abs(p.x - x0_) < kMaxExtent && std::abs(p.y - y0_) < kMaxExtent)) continue;
    sums_.push_back({static_cast<std::int32_t>(std::floor(p.x / cell_)),
                     static_cast<std::int32_t>(std::floor(p.y / cell_)), p.x, p.y, p.nx, p.ny, 1});
  }
}

/// The mean of the points of each cell that face the same way.
SurfacePoints SurfaceMap::mergeCells() const {
  SurfacePoints merged;
  for (std::size_t i = 0; i < sums_.size();) {
    Sum groups[2];
    int used = 0;
    std::size_t j = i;
    for (; j < sums_.size() && sums_[j].cx == sums_[i].cx && sums_[j].cy == sums_[i].cy; ++j) {
      const Sum& s = sums_[j];
      int g = 0;
      while (g < used && groups[g].nx * s.nx + groups[g].ny * s.ny < 0.0) ++g;
      if (g == 2) continue;
      if (g == used) {
        groups[used++] = s;
        continue;
      }
      groups[g].x += s.x;
      groups[g].y += s.y;
      groups[g].nx += s.nx;
      groups[g].ny += s.ny;
      ++groups[g].count;
    }
    for (int g = 0; g < used; ++g) {
      const Sum& s = groups[g];
      const double length = std::hypot(s.nx, s.ny);
      SurfacePoint p{s.x / s.count, s.y / s.count, 0.0, 0.0};
      if (length > 0.0) {
        p.nx = s.nx / length;
        p.ny = s.ny / length;
      }
      merged.push_back(p);
    }
    i = j;
  }
  return merged;
}

void SurfaceMap::finish() {
  // Equal cells side by side, in the order of insertion: sums depend on nothing else.
  std::stable_sort(sums_.begin(), sums_.end(), [](const Sum& a, const Sum& b) {
    return std::tie(a.cy, a.cx) < std::tie(b.cy, b.cx);
  });
  const SurfacePoints merged = mergeCells();
  points_.clear();
  begin_.assign(1, 0);
  width_ = height_ = 0;
  if (merged.empty()) return;
  double x1 = merged[0].x, y1 = merged[0].y;
  x0_ = x1;
  y0_ = y1;
  for (const SurfacePoint& p : merged) {
    x0_ = std::min(x0_, p.x);
    y0_ = std::min(y0_, p.y);
    x1 = std::max(x1, p.x);
    y1 = std::max(y1, p.y);
  }
  width_ = static_cast<int>((x1 - x0_) / bucket_) + 1;
  height_ = static_cast<int>((y1 - y0_) / bucket_) + 1;
  const auto bucketOf = [&](const SurfacePoint& p) {
    return static_cast<std::size_t>(static_cast<int>((p.y - y0_) / bucket_)) *
               static_cast<std::size_t>(width_) +
           static_cast<std::size_t>((p.x - x0_) / bucket_);
  };
  begin_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 1, 0);
  for (const SurfacePoint& p : merged) ++begin_[bucketOf(p) + 1];
  for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
  std::vector<std::int32_t> next(begin_.begin(), begin_.end() - 1);
  points_.resize(merged.size());
  for (const SurfacePoint& p : merged) points_[static_cast<std::size_t>(next[bucketOf(p)]++)] = p;
}

const SurfacePoint* SurfaceMap::nearest(const SurfacePoint& p, double radius) const {
  const double fx = (p.x - x0_) / bucket_, fy = (p.y - y0_) / bucket_, r = radius / bucket_;
  if (!(fx + r >= 0.0 && fy + r >= 0.0 && fx - r < width_ && fy - r < height_)) return nullptr;
  const int left = std::max(0, static_cast<int>(std::floor(fx - r)));
  const int right = std::min(width_ - 1, static_cast<int>(std::floor(fx + r)));
  const int low = std::max(0, static_cast<int>(std::floor(fy - r)));
  const int high = std::min(height_ - 1, static_cast<int>(std::floor(fy + r)));
  const SurfacePoint* best = nullptr;
  double best_squared = radius * radius;
  for (int y = low; y <= high; ++y) {
    const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    const std::int32_t first = begin_[row + static_cast<std::size_t>(left)];
    const std::int32_t last = begin_[row + static_cast<std::size_t>(right) + 1];
    for (std::int32_t i = first; i < last; ++i) {
      const SurfacePoint& q = points_[static_cast<std::size_t>(i)];
      const double dx = p.x - q.x, dy = p.y - q.y, squared = dx * dx + dy * dy;
      if (squared >= best_squared || p.nx * q.nx + p.ny * q.ny < 0.0) continue;
      best_squared = squared;
      best = &q;
    }
  }
  return best;
}

}  // namespace hyselam_scan_matching
