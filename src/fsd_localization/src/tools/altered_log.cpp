#include "altered_log.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "log_moments.hpp"

namespace fsd_localization {

using hyselam::Pose2;

namespace {

constexpr double kScanStep = 0.1;    // [s] between scans of one that stands
constexpr float kPeopleRange = 0.6;  // [m]

/// The moment that the robot is carried to from moment i; the number of all if there is none.
std::size_t carriedTo(const std::vector<LogMoment>& all, std::size_t i) {
  const auto fits = [&](const LogMoment& m) {
    const double away = hyselam::distance(m.truth, all[i].truth);
    return m.scan->stamp > all[i].scan->stamp + 30.0 && away >= 5.0 && away <= 25.0;
  };
  const auto found =
      std::find_if(all.begin() + static_cast<std::ptrdiff_t>(i) + 1, all.end(), fits);
  return static_cast<std::size_t>(found - all.begin());
}

void hide(hyselam::LaserScan& scan, double share) {
  const std::size_t all = scan.ranges.size();
  const auto hidden = static_cast<std::size_t>(std::lround(share * static_cast<double>(all)));
  const std::size_t first = (all - hidden) / 2;  // those ahead
  for (std::size_t b = first; b < first + hidden; ++b) {
    const bool is_near = scan.ranges[b] >= scan.range_min && scan.ranges[b] < kPeopleRange;
    if (!is_near) scan.ranges[b] = kPeopleRange;
  }
}

}  // namespace

AlteredLog altered(const hyselam::RobotLog& log, const std::vector<hyselam::StampedPose2>& truth,
                   const Alterations& alterations) {
  const std::vector<LogMoment> all = momentsOf(log, truth);
  AlteredLog result;
  hyselam::RobotLog& out = result.log;
  Pose2 frame;         // of the odometry as recorded, in that of the output
  double shift = 0.0;  // [s] of the stamps, backwards
  const auto add = [&](const LogMoment& m, double later, double crowd) {
    hyselam::LaserScan scan = *m.scan;
    scan.stamp += later - shift;
    hide(scan, crowd);
    out.odometry.push_back({scan.stamp, frame * m.odometry});
    out.ground_truth.push_back({scan.stamp, m.truth});
    out.scans.push_back(std::move(scan));
  };
  const auto stand = [&](const LogMoment& m, bool carried) {
    const int scans = static_cast<int>(std::lround(alterations.stand / kScanStep));
    if (scans == 0) return;
    for (int s = 1; s <= scans; ++s) add(m, s * kScanStep, alterations.crowd);
    const double begin = m.scan->stamp - shift;
    result.stands.push_back({begin, begin + scans * kScanStep, carried});
    shift -= scans * kScanStep;
  };

  const std::size_t count = std::max(alterations.kidnaps, alterations.stops);
  std::size_t done = 0;
  bool carried = false;  // just now
  for (std::size_t i = 0; i < all.size(); ++i) {
    const LogMoment& m = all[i];
    add(m, 0.0, 0.0);
    if (carried) stand(m, true);
    carried = false;
    const double wanted =
        all.back().way * static_cast<double>(done + 1) / static_cast<double>(count + 1);
    if (done == count || m.way < wanted) continue;
    ++done;
    if (alterations.kidnaps == 0) {
      stand(m, false);
      continue;
    }
    const std::size_t k = carriedTo(all, i);
    if (k >= all.size()) break;
    if (all[k].scan->stamp > all[k - 1].scan->stamp) {
      shift += all[k - 1].scan->stamp - m.scan->stamp;
    }
    // Of one that is left standing not even a wheel has turned.
    const LogMoment& wheels = alterations.stand > 0.0 ? all[k] : all[k - 1];
    frame = frame * m.odometry * wheels.odometry.inverse();
    carried = true;
    i = k - 1;
  }
  return result;
}

}  // namespace fsd_localization
