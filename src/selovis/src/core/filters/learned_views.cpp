#include "selovis/filters/learned_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr double kMaxExtent = 5000.0;  // [m]
constexpr double kMaxCells = 4000.0;   // of the grid, along its sides together
constexpr double kMinSquaredDistance = 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

LearnedViews::Extent LearnedViews::extentOf(const Samples& samples) {
  Extent e{{kInfinity, kInfinity}, {-kInfinity, -kInfinity}};
  for (const hyselam::Pose2& p : samples.poses) {
    if (!p.isFinite()) continue;
    e.low = {std::min(e.low.x, p.x), std::min(e.low.y, p.y)};
    e.high = {std::max(e.high.x, p.x), std::max(e.high.y, p.y)};
  }
  return e;
}

std::string LearnedViews::whyNot(const Samples& samples) {
  if (samples.poses.size() != samples.count()) return "have not one pose each";
  const Extent e = extentOf(samples);
  if (e.high.x < e.low.x) return "no frame has a pose";
  const bool near = e.high.x - e.low.x <= kMaxExtent && e.high.y - e.low.y <= kMaxExtent;
  return near ? "" : "have poses more than 5 km apart";
}

LearnedViews::LearnedViews(const Samples& samples, double radius, double angle)
    : radius_(radius), angle_(angle), similarity_(samples.count(), 0.0) {
  const std::string problem = whyNot(samples);
  if (!problem.empty()) throw hyselam::InputError("training samples", "", problem);
  int frame = -1;
  for (std::size_t i = 0; i < samples.count(); ++i) {
    const hyselam::Pose2& pose = samples.poses[i];
    if (!pose.isFinite()) continue;
    if (frames_.empty() || samples.frames[i] != frame) {
      const auto begin = static_cast<std::uint32_t>(views_.size());
      frames_.push_back({{pose.x, pose.y}, samples.places[i], begin, begin});
      frame = samples.frames[i];
    }
    views_.push_back({pose.theta, static_cast<std::uint32_t>(i), 0});
    frames_.back().end = static_cast<std::uint32_t>(views_.size());
  }
  buildGrid(extentOf(samples));
  for (std::uint32_t f = 0; f < frames_.size(); ++f) {
    for (std::uint32_t v = frames_[f].begin; v < frames_[f].end; ++v) views_[v].frame = f;
  }
}

std::size_t LearnedViews::cellOf(const hyselam::Point2& p) const {
  return static_cast<std::size_t>((p.y - origin_.y) / cell_) * static_cast<std::size_t>(columns_) +
         static_cast<std::size_t>((p.x - origin_.x) / cell_);
}

void LearnedViews::buildGrid(const Extent& extent) {
  origin_ = extent.low;
  const double width = extent.high.x - origin_.x, height = extent.high.y - origin_.y;
  cell_ = std::max(radius_, (width + height) / kMaxCells);
  columns_ = static_cast<int>(width / cell_) + 1;
  rows_ = static_cast<int>(height / cell_) + 1;
  std::stable_sort(frames_.begin(), frames_.end(), [&](const Frame& a, const Frame& b) {
    return cellOf(a.position) < cellOf(b.position);
  });
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  begin_.assign(cells + 1, 0);
  for (const Frame& f : frames_) ++begin_[cellOf(f.position) + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
}

double LearnedViews::compare(const std::vector<float>& distances, double beta) {
  if (distances.size() != similarity_.size()) {
    throw hyselam::InputError("frame", "", "has not as many distances as there are samples");
  }
  double nearest = kInfinity, total = 0.0;
  for (const View& v : views_) {
    nearest = std::min(nearest, static_cast<double>(distances[v.sample]));
  }
  nearest = std::max(kMinSquaredDistance, nearest);
  // The views of a frame that is far off all have its distance: one exponential does for them.
  float last = std::numeric_limits<float>::quiet_NaN();
  double similarity = 0.0;
  for (const View& v : views_) {
    if (distances[v.sample] != last) {
      last = distances[v.sample];
      similarity = std::exp(-beta * ((static_cast<double>(last) - nearest) / nearest));
    }
    total += similarity_[v.sample] = similarity;
  }
  return total;
}

LearnedViews::Regression LearnedViews::at(const hyselam::Pose2& pose) const {
  Regression result;
  const double across = std::floor((pose.x - origin_.x) / cell_),
               along = std::floor((pose.y - origin_.y) / cell_);
  // In floating point: a pose may lie farther off than integers count.
  if (!(across >= -1.0 && across <= columns_ && along >= -1.0 && along <= rows_)) return result;
  const int column = static_cast<int>(across), row = static_cast<int>(along);
  const double radius2 = radius_ * radius_, angle2 = angle_ * angle_;
  result.nearest2 = radius2;
  for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
    const int first = std::max(0, column - 1), last = std::min(columns_ - 1, column + 1);
    if (first > last) continue;
    const auto base = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_);
    for (std::uint32_t i = begin_[base + static_cast<std::size_t>(first)];
         i < begin_[base + static_cast<std::size_t>(last) + 1]; ++i) {
      const Frame& f = frames_[i];
      const double dx = f.position.x - pose.x, dy = f.position.y - pose.y, d2 = dx * dx + dy * dy;
      if (d2 >= radius2) continue;
      if (d2 < result.nearest2) {
        result.nearest2 = d2;
        result.place = f.place;
      }
      const double a = 1.0 - d2 / radius2;
      for (std::uint32_t v = f.begin; v < f.end; ++v) {
        double off = std::abs(views_[v].heading - pose.theta);
        if (off > hyselam::kPi) off = std::abs(2.0 * hyselam::kPi - off);
        const double b = 1.0 - off * off / angle2;
        if (b <= 0.0) continue;
        const double kernel = a * a * b * b;  // biweight, of distance and of turn
        result.weight += kernel;
        result.sum += kernel * similarity_[views_[v].sample];
      }
    }
  }
  return result;
}

}  // namespace selovis
