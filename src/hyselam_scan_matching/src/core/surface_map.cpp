#include "hyselam_scan_matching/surface_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"

namespace hyselam_scan_matching {

SurfaceMap::SurfaceMap(double cell) : cell_(cell) {
  if (!(cell > 0.0 && cell <= 10.0))
    throw hyselam::ParameterError("cell", cell, "above 0, at most 10");
}

void SurfaceMap::insert(const hyselam::Pose2& pose, const SurfacePoints& points) {
  const std::uint32_t number = next_insert_++;
  for (const SurfacePoint& p : transformed(pose, points)) {
    const Insert first = inserts_.empty() ? Insert{number, p.x, p.y} : inserts_.front();
    if (!(std::abs(p.x - first.x) < kMaxExtent && std::abs(p.y - first.y) < kMaxExtent)) continue;
    if (inserts_.empty() || inserts_.back().number != number) {
      inserts_.push_back({number, p.x, p.y});
    }
    new_.push_back({static_cast<std::int32_t>(std::floor(p.x / cell_)),
                    static_cast<std::int32_t>(std::floor(p.y / cell_)), p.x, p.y, p.nx, p.ny, 1,
                    number});
  }
}

void SurfaceMap::dropOldest() {
  if (first_insert_ == next_insert_) return;
  if (!inserts_.empty() && inserts_.front().number == first_insert_) inserts_.pop_front();
  ++first_insert_;
}

SurfaceMap::Means SurfaceMap::meansOf(const Sum* begin, const Sum* end) {
  Sum groups[2];
  Means means;
  for (const Sum* s = begin; s != end; ++s) {
    int g = 0;
    while (g < means.count && groups[g].nx * s->nx + groups[g].ny * s->ny < 0.0) ++g;
    if (g == 2) continue;
    if (g == means.count) {
      groups[means.count++] = *s;
      continue;
    }
    groups[g].x += s->x;
    groups[g].y += s->y;
    groups[g].nx += s->nx;
    groups[g].ny += s->ny;
    ++groups[g].count;
  }
  for (int g = 0; g < means.count; ++g) {
    const Sum& s = groups[g];
    const double length = std::hypot(s.nx, s.ny);
    SurfacePoint& p = means.points[g];
    p = {s.x / s.count, s.y / s.count, 0.0, 0.0};
    if (length > 0.0) {
      p.nx = s.nx / length;
      p.ny = s.ny / length;
    }
  }
  return means;
}

/// Merges what is new with what is there, without what was dropped. The means are made anew of
/// cells that have changed; in each cell points stand in the order of insertion, and sums depend on
/// nothing else.
void SurfaceMap::takeUpNew() {
  const auto isBefore = [](const Sum& a, const Sum& b) { return a.isBefore(b); };
  std::stable_sort(new_.begin(), new_.end(), isBefore);
  std::vector<Sum> sums;
  std::vector<Means> means;
  sums.reserve(sums_.size() + new_.size());
  means.reserve(means_.size() + new_.size());
  std::size_t old = 0, fresh = 0, old_cell = 0;
  while (old < sums_.size() || fresh < new_.size()) {
    const bool has_old =
        old < sums_.size() && (fresh == new_.size() || !new_[fresh].isBefore(sums_[old]));
    const Sum cell = has_old ? sums_[old] : new_[fresh];
    const std::size_t begin = sums.size();
    bool changed = !has_old;
    for (; old < sums_.size() && sums_[old].isBeside(cell); ++old) {
      if (sums_[old].insert < first_insert_) {
        changed = true;
      } else {
        sums.push_back(sums_[old]);
      }
    }
    for (; fresh < new_.size() && new_[fresh].isBeside(cell); ++fresh) {
      if (new_[fresh].insert < first_insert_) continue;
      changed = true;
      sums.push_back(new_[fresh]);
    }
    if (sums.size() > begin) {
      means.push_back(changed ? meansOf(sums.data() + begin, sums.data() + sums.size())
                              : means_[old_cell]);
    }
    old_cell += has_old ? 1 : 0;
  }
  new_.clear();
  sums_.swap(sums);
  means_.swap(means);
}

void SurfaceMap::finish() {
  takeUpNew();
  fillBuckets();
}

void SurfaceMap::fillBuckets() {
  points_.clear();
  begin_.assign(1, 0);
  width_ = height_ = 0;
  if (means_.empty()) return;
  double x1 = means_[0].points[0].x, y1 = means_[0].points[0].y;
  x0_ = x1;
  y0_ = y1;
  const auto forEach = [this](const auto& act) {
    for (const Means& m : means_) {
      for (int k = 0; k < m.count; ++k) act(m.points[k]);
    }
  };
  std::size_t count = 0;
  forEach([&](const SurfacePoint& p) {
    x0_ = std::min(x0_, p.x);
    y0_ = std::min(y0_, p.y);
    x1 = std::max(x1, p.x);
    y1 = std::max(y1, p.y);
    ++count;
  });
  width_ = static_cast<int>((x1 - x0_) / bucket_) + 1;
  height_ = static_cast<int>((y1 - y0_) / bucket_) + 1;
  const auto bucketOf = [&](const SurfacePoint& p) {
    return static_cast<std::size_t>(static_cast<int>((p.y - y0_) / bucket_)) *
               static_cast<std::size_t>(width_) +
           static_cast<std::size_t>((p.x - x0_) / bucket_);
  };
  begin_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 1, 0);
  forEach([&](const SurfacePoint& p) { ++begin_[bucketOf(p) + 1]; });
  for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
  std::vector<std::int32_t> next(begin_.begin(), begin_.end() - 1);
  points_.resize(count);
  forEach(
      [&](const SurfacePoint& p) { points_[static_cast<std::size_t>(next[bucketOf(p)]++)] = p; });
}

const SurfacePoint* SurfaceMap::nearest(const SurfacePoint& p, double radius) const {
  const double fx = (p.x - x0_) / bucket_, fy = (p.y - y0_) / bucket_;
  const auto near = [&](double r) {
    Buckets b;
    b.left = std::max(0, static_cast<int>(std::floor(fx - r)));
    b.right = std::min(width_ - 1, static_cast<int>(std::floor(fx + r)));
    b.low = std::max(0, static_cast<int>(std::floor(fy - r)));
    b.high = std::min(height_ - 1, static_cast<int>(std::floor(fy + r)));
    return b;
  };
  const double r = radius / bucket_;
  if (!(fx + r >= 0.0 && fy + r >= 0.0 && fx - r < width_ && fy - r < height_)) return nullptr;
  // One in the point's own bucket tells that what is farther need not be looked at.
  double limit = radius * radius;
  const Buckets own = near(0.0);
  if (const SurfacePoint* found = nearestOf(own, p, &limit)) {
    const Buckets closer = near(std::min(r, std::sqrt(limit) / bucket_ * (1.0 + 1e-9)));
    const bool alone = closer.left == own.left && closer.right == own.right &&
                       closer.low == own.low && closer.high == own.high;
    if (alone) return found;
    limit = std::nextafter(limit, std::numeric_limits<double>::infinity());  // itself again
    return nearestOf(closer, p, &limit);
  }
  return nearestOf(near(r), p, &limit);
}

/// The first of the nearest points that are nearer than the root of `limit`, which becomes its
/// squared distance.
const SurfacePoint* SurfaceMap::nearestOf(const Buckets& b, const SurfacePoint& p,
                                          double* limit) const {
  if (b.left > b.right) return nullptr;
  const SurfacePoint* best = nullptr;
  double best_squared = *limit;
  for (int y = b.low; y <= b.high; ++y) {
    const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    const std::int32_t first = begin_[row + static_cast<std::size_t>(b.left)];
    const std::int32_t last = begin_[row + static_cast<std::size_t>(b.right) + 1];
    for (std::int32_t i = first; i < last; ++i) {
      const SurfacePoint& q = points_[static_cast<std::size_t>(i)];
      const double dx = p.x - q.x, dy = p.y - q.y, squared = dx * dx + dy * dy;
      if (squared >= best_squared || p.nx * q.nx + p.ny * q.ny < 0.0) continue;
      best_squared = squared;
      best = &q;
    }
  }
  *limit = best_squared;
  return best;
}

}  // namespace hyselam_scan_matching
