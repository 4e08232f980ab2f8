#include "fsd_localization/search/submap.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace fsd_localization {

using hyselam::Point2;
using hyselam::Pose2;

namespace {
constexpr double kStep = 0.3;           // [m] between kept scans
constexpr double kTurn = 0.3;           // [rad] or so
constexpr double kPointSpacing = 0.15;  // [m]
constexpr std::size_t kViews = 12;
constexpr std::size_t kBeams = 60;
}  // namespace

void SubmapBuilder::reset() {
  *this = SubmapBuilder();
}

std::vector<Point2> SubmapBuilder::endsOf(const hyselam::LaserScan& scan) {
  std::vector<Point2> ends;
  const Pose2& laser = scan.laser_in_base;
  const double c = std::cos(laser.theta), s = std::sin(laser.theta);
  const double limit = std::min(scan.range_max, kMaxRange);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto r = static_cast<double>(scan.ranges[i]);
    if (!(r >= scan.range_min && r < limit)) continue;
    const double bearing = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    const double x = r * std::cos(bearing), y = r * std::sin(bearing);
    ends.push_back({laser.x + c * x - s * y, laser.y + s * x + c * y});
  }
  return ends;
}

void SubmapBuilder::add(const hyselam::LaserScan& scan, const Pose2& base) {
  if (!scans_.empty()) {
    const Pose2 step = between(scans_.back().base, base);
    travelled_ += std::hypot(step.x, step.y);
    turned_ += std::abs(step.theta);
    if (!last_is_step_) scans_.pop_back();
  }
  last_is_step_ = scans_.empty() || travelled_ - scans_.back().travelled >= kStep ||
                  turned_ - scans_.back().turned >= kTurn;
  scans_.push_back({base, travelled_, turned_, {scan.laser_in_base.x, scan.laser_in_base.y}, {}});
  if (last_is_step_) {
    scans_.back().ends = endsOf(scan);
  } else {
    last_scan_ = scan;
  }
  while (travelled_ - scans_.front().travelled > kMaxLength) scans_.pop_front();
}

std::size_t SubmapBuilder::firstWithin(double length, double turn_as_travel) const {
  std::size_t first = 0;
  while (first + 1 < scans_.size() &&
         travelled_ - scans_[first].travelled + turn_as_travel * (turned_ - scans_[first].turned) >
             length) {
    ++first;
  }
  return first;
}

void SubmapBuilder::keepLast(double length, double turn_as_travel) {
  const std::size_t first = firstWithin(length, turn_as_travel);
  scans_.erase(scans_.begin(), scans_.begin() + static_cast<std::ptrdiff_t>(first));
  if (scans_.size() == 1 && !last_is_step_) {
    last_is_step_ = true;
    scans_.back().ends = endsOf(last_scan_);
  }
}

Submap SubmapBuilder::build(double length, double turn_as_travel) const {
  Submap map;
  if (scans_.empty()) return map;
  const Pose2 to_newest = scans_.back().base.inverse();
  const std::size_t first = firstWithin(length, turn_as_travel);
  map.length = travelled_ - scans_[first].travelled;
  map.turned = turned_ - scans_[first].turned;
  std::set<std::pair<int, int>> taken;
  const std::size_t count = scans_.size() - first;
  const std::size_t views = std::min(count, kViews);
  std::size_t next_view = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Kept& k = scans_[scans_.size() - 1 - i];  // the newest first: its points are the surest
    const Pose2 here = to_newest * k.base;
    std::vector<Point2> ends = i == 0 && !last_is_step_ ? endsOf(last_scan_) : k.ends;
    const double c = std::cos(here.theta), s = std::sin(here.theta);
    for (Point2& e : ends) e = {here.x + c * e.x - s * e.y, here.y + s * e.x + c * e.y};
    for (const Point2& e : ends) {
      if (taken
              .insert({static_cast<int>(std::floor(e.x / kPointSpacing)),
                       static_cast<int>(std::floor(e.y / kPointSpacing))})
              .second) {
        map.points.push_back(e);
      }
    }
    if (i != next_view * count / views) continue;
    ++next_view;
    Submap::View view;
    view.laser = here * k.laser;
    const std::size_t beams = std::min(kBeams, ends.size());
    for (std::size_t b = 0; b < beams; ++b) view.ends.push_back(ends[b * ends.size() / beams]);
    map.views.push_back(std::move(view));
  }
  return map;
}

}  // namespace fsd_localization
