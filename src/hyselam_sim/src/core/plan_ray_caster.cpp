#include "hyselam_sim/plan_ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyselam_sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Buckets overlap by this much, so that rounding never hides a segment on a bucket's border. [m]
constexpr double kOverlap = 1e-6;
constexpr int kMaxBucketsPerSide = 4096;

}  // namespace

double hitDistance(Point2 origin, Point2 direction, const Segment& segment) {
  const Point2 d = segment.b - segment.a;
  const double denominator = cross(direction, d);
  if (denominator == 0.0) return kInfinity;
  const Point2 to_a = segment.a - origin;
  const double along_segment = cross(to_a, direction) / denominator;
  if (!(along_segment >= 0.0 && along_segment <= 1.0)) return kInfinity;
  const double t = cross(to_a, d) / denominator;
  return t >= 0.0 ? t : kInfinity;
}

double hitDistance(Point2 origin, Point2 direction, Point2 center, double radius) {
  const Point2 to = center - origin;
  const double along = dot(to, direction);
  const double off2 = dot(to, to) - along * along;
  const double half2 = radius * radius - off2;
  if (dot(to, to) <= radius * radius) return 0.0;
  if (half2 < 0.0 || along < 0.0) return kInfinity;
  return along - std::sqrt(half2);
}

PlanRayCaster::PlanRayCaster(std::vector<Segment> segments, double bucket_size)
    : segments_(std::move(segments)), bucket_size_(bucket_size) {
  if (segments_.empty()) return;
  min_ = {kInfinity, kInfinity};
  max_ = {-kInfinity, -kInfinity};
  for (const Segment& s : segments_) {
    min_ = {std::min({min_.x, s.a.x, s.b.x}), std::min({min_.y, s.a.y, s.b.y})};
    max_ = {std::max({max_.x, s.a.x, s.b.x}), std::max({max_.y, s.a.y, s.b.y})};
  }
  min_ = min_ - Point2{kOverlap, kOverlap};
  max_ = max_ + Point2{kOverlap, kOverlap};
  const double side = std::max(max_.x - min_.x, max_.y - min_.y);
  bucket_size_ = std::max(bucket_size_, side / kMaxBucketsPerSide);
  columns_ = static_cast<int>(std::floor((max_.x - min_.x) / bucket_size_)) + 1;
  rows_ = static_cast<int>(std::floor((max_.y - min_.y) / bucket_size_)) + 1;

  std::vector<std::vector<std::uint32_t>> buckets(static_cast<std::size_t>(columns_) *
                                                  static_cast<std::size_t>(rows_));
  const auto column = [&](double x) {
    return std::clamp(static_cast<int>(std::floor((x - min_.x) / bucket_size_)), 0, columns_ - 1);
  };
  const auto row = [&](double y) {
    return std::clamp(static_cast<int>(std::floor((y - min_.y) / bucket_size_)), 0, rows_ - 1);
  };
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const Segment& s = segments_[i];
    const int c0 = column(std::min(s.a.x, s.b.x) - kOverlap);
    const int c1 = column(std::max(s.a.x, s.b.x) + kOverlap);
    const int r0 = row(std::min(s.a.y, s.b.y) - kOverlap);
    const int r1 = row(std::max(s.a.y, s.b.y) + kOverlap);
    for (int r = r0; r <= r1; ++r) {
      for (int c = c0; c <= c1; ++c) {
        const Point2 low = min_ + Point2{c * bucket_size_ - kOverlap, r * bucket_size_ - kOverlap};
        const Point2 high = low + Point2{bucket_size_ + 2 * kOverlap, bucket_size_ + 2 * kOverlap};
        if (!touchesBox(s, low, high)) continue;
        buckets[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
                static_cast<std::size_t>(c)]
            .push_back(static_cast<std::uint32_t>(i));
      }
    }
  }
  first_.reserve(buckets.size() + 1);
  for (const auto& bucket : buckets) {
    first_.push_back(static_cast<std::uint32_t>(entries_.size()));
    entries_.insert(entries_.end(), bucket.begin(), bucket.end());
  }
  first_.push_back(static_cast<std::uint32_t>(entries_.size()));
}

double PlanRayCaster::cast(Point2 origin, Point2 direction, double max_range) const {
  if (segments_.empty()) return max_range;
  // Clip the ray with the grid of buckets.
  double enter = 0.0, leave = max_range;
  const double o[2] = {origin.x, origin.y}, d[2] = {direction.x, direction.y};
  const double low[2] = {min_.x, min_.y};
  const double high[2] = {min_.x + columns_ * bucket_size_, min_.y + rows_ * bucket_size_};
  for (int i = 0; i < 2; ++i) {
    if (d[i] == 0.0) {
      if (o[i] < low[i] || o[i] > high[i]) return max_range;
      continue;
    }
    const double t0 = (low[i] - o[i]) / d[i], t1 = (high[i] - o[i]) / d[i];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  if (enter > leave) return max_range;

  // Walk from bucket to bucket (Amanatides and Woo).
  const int limit[2] = {columns_, rows_};
  int cell[2], step[2];
  double next[2], delta[2];
  for (int i = 0; i < 2; ++i) {
    const double at = (o[i] + enter * d[i] - low[i]) / bucket_size_;
    cell[i] = std::clamp(static_cast<int>(std::floor(at)), 0, limit[i] - 1);
    step[i] = d[i] > 0.0 ? 1 : -1;
    if (d[i] == 0.0) {
      next[i] = delta[i] = kInfinity;
    } else {
      delta[i] = bucket_size_ / std::abs(d[i]);
      next[i] = (low[i] + (cell[i] + (d[i] > 0.0 ? 1 : 0)) * bucket_size_ - o[i]) / d[i];
    }
  }
  double best = max_range;
  while (true) {
    const std::size_t bucket =
        static_cast<std::size_t>(cell[1]) * static_cast<std::size_t>(columns_) +
        static_cast<std::size_t>(cell[0]);
    for (std::uint32_t k = first_[bucket]; k < first_[bucket + 1]; ++k) {
      best = std::min(best, hitDistance(origin, direction, segments_[entries_[k]]));
    }
    const int axis = next[0] < next[1] ? 0 : 1;
    if (best <= next[axis] || next[axis] > leave) return best;
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] >= limit[axis]) return best;
    next[axis] += delta[axis];
  }
}

}  // namespace hyselam_sim
