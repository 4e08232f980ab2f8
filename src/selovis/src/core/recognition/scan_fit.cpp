#include "selovis/recognition/scan_fit.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr double kCoarseStep = 0.25;                        // [m]
constexpr double kCoarseTurn = 5.0 * hyselam::kPi / 180.0;  // [rad]
constexpr int kHalvings = 4;                                // of the steps, when refining

}  // namespace

ScanPoints scanPoints(const hyselam::LaserScan& scan, std::size_t most) {
  ScanPoints all;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double r = scan.ranges[i];
    if (!(r >= scan.range_min && r < scan.range_max)) continue;
    const double bearing = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    all.push_back(scan.laser_in_base *
                  hyselam::Point2{r * std::cos(bearing), r * std::sin(bearing)});
  }
  if (all.size() <= most) return all;
  ScanPoints few;
  for (std::size_t i = 0; i < most; ++i) few.push_back(all[i * all.size() / most]);
  return few;
}

ScanFit::ScanFit(const hyselam::OccupancyGrid& map)
    : geometry_(map.geometry), values_(map.cells.size()) {
  if (map.cells.empty() || map.cells.size() != map.geometry.cellCount()) {
    throw hyselam::InputError("map", "", "has not as many cells as its size says");
  }
  cv::Mat open(geometry_.height, geometry_.width, CV_8U);
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    open.data[i] = map.cells[i] >= kOccupiedFrom ? 0 : 1;
  }
  cv::Mat distance;  // [cells] to the nearest obstacle
  cv::distanceTransform(open, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const double d = geometry_.resolution * distance.ptr<float>()[i] / kSigma;
    values_[i] =
        static_cast<float>(std::log((1.0 - kAnything) * std::exp(-0.5 * d * d) + kAnything));
  }
}

double ScanFit::at(const ScanPoints& points, const hyselam::Pose2& base) const {
  const double nothing = std::log(kAnything);
  if (points.empty()) return nothing;
  const hyselam::Pose2 in_grid = geometry_.origin.inverse() * base;
  double sum = 0.0;
  for (const hyselam::Point2& p : points) {
    const hyselam::Point2 q = in_grid * p;
    const double x = std::floor(q.x / geometry_.resolution),
                 y = std::floor(q.y / geometry_.resolution);
    if (x >= 0.0 && y >= 0.0 && x < geometry_.width && y < geometry_.height) {
      sum += values_[geometry_.index({static_cast<int>(x), static_cast<int>(y)})];
    } else {
      sum += nothing;
    }
  }
  return sum / static_cast<double>(points.size());
}

FittedPose ScanFit::best(const ScanPoints& points, const hyselam::Pose2& around, double reach,
                         double turn) const {
  ScanPoints half;
  for (std::size_t i = 0; i < points.size(); i += 2) half.push_back(points[i]);
  FittedPose best{around, at(half, around)};
  const int steps = static_cast<int>(reach / kCoarseStep + 1e-9),
            turns = static_cast<int>(turn / kCoarseTurn + 1e-9);
  for (int k = -turns; k <= turns; ++k) {
    for (int j = -steps; j <= steps; ++j) {
      for (int i = -steps; i <= steps; ++i) {
        const hyselam::Pose2 tried{around.x + i * kCoarseStep, around.y + j * kCoarseStep,
                                   hyselam::normalizeAngle(around.theta + k * kCoarseTurn)};
        const double fit = at(half, tried);
        if (fit > best.fit) best = {tried, fit};
      }
    }
  }
  best.fit = at(points, best.base);
  double step = 0.5 * kCoarseStep, angle = 0.5 * kCoarseTurn;
  for (int halving = 0; halving < kHalvings; ++halving, step *= 0.5, angle *= 0.5) {
    const hyselam::Pose2 middle = best.base;
    for (int k = -1; k <= 1; ++k) {
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          const hyselam::Pose2 tried{middle.x + i * step, middle.y + j * step,
                                     hyselam::normalizeAngle(middle.theta + k * angle)};
          const double fit = at(points, tried);
          if (fit > best.fit) best = {tried, fit};
        }
      }
    }
  }
  return best;
}

}  // namespace selovis
