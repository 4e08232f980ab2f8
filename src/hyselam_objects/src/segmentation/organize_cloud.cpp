#include "hyselam_objects/segmentation/organize_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "hyselam_common/errors.hpp"

namespace hyselam_objects {
namespace {

constexpr double kMostPixels = 5e7;

/// Direction of a point: x / z or y / z.
float slope(const Point& p, int axis) {
  return p[axis] / p.z();
}

bool isInFront(const Point& p) {
  return p.allFinite() && p.z() > 0.0f;
}

/// Every so many-th direction of the points in front, sorted.
std::vector<float> sampleSlopes(const OrganizedCloud& cloud, int axis) {
  constexpr std::size_t kMost = 30000;
  std::vector<float> out;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kMost);
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    if (isInFront(cloud.points[i])) out.push_back(slope(cloud.points[i], axis));
  }
  std::sort(out.begin(), out.end());
  return out;
}

struct Axis {
  double focal = 0.0, center = 0.0;
};

/// Columns (or rows) of a camera: directions that lie at equal distances; nothing if they do not.
std::optional<Axis> findLattice(const std::vector<float>& slopes) {
  constexpr float kSame = 2e-5f;  // directions of one column differ by rounding only
  std::vector<double> columns;    // mean directions
  for (std::size_t i = 0; i < slopes.size();) {
    double sum = 0.0;
    std::size_t k = i;
    for (; k < slopes.size() && (k == i || slopes[k] - slopes[k - 1] < kSame); ++k) {
      sum += static_cast<double>(slopes[k]);
    }
    columns.push_back(sum / static_cast<double>(k - i));
    i = k;
  }
  if (columns.size() < 20 || 5 * columns.size() > slopes.size()) return std::nullopt;
  std::vector<double> gaps;
  for (std::size_t k = 1; k < columns.size(); ++k) gaps.push_back(columns[k] - columns[k - 1]);
  std::vector<double> sorted = gaps;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  double pitch = sorted[sorted.size() / 2];
  std::size_t fitting = 0;
  double number = 0.0;  // of the column, from the first
  for (const double gap : gaps) {
    const double steps = std::round(gap / pitch);
    fitting += steps >= 1.0 && std::abs(gap - steps * pitch) < 0.1 * pitch;
    number += std::max(1.0, steps);
  }
  if (10 * fitting < 9 * gaps.size()) return std::nullopt;
  pitch = (columns.back() - columns.front()) / number;
  return Axis{1.0 / pitch, -columns.front() / pitch};
}

/// So that about one point falls into a pixel.
double focalByDensity(const OrganizedCloud& cloud, double left, double right, double top,
                      double bottom) {
  constexpr int kCells = 64;  // across
  const double cell = std::max({right - left, bottom - top, 1e-6}) / kCells;
  std::set<std::pair<int, int>> seen;
  std::size_t points = 0;
  for (const Point& p : cloud.points) {
    if (!isInFront(p)) continue;
    ++points;
    seen.insert({static_cast<int>((static_cast<double>(slope(p, 0)) - left) / cell),
                 static_cast<int>((static_cast<double>(slope(p, 1)) - top) / cell)});
  }
  return std::sqrt(static_cast<double>(points) / static_cast<double>(seen.size())) / cell;
}

struct Interval {
  double low, high;
};

/// From the least to the largest direction of all points in front.
Interval wholeRange(const OrganizedCloud& cloud, int axis) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const Point& p : cloud.points) {
    if (!isInFront(p)) continue;
    low = std::min(low, slope(p, axis));
    high = std::max(high, slope(p, axis));
  }
  return {static_cast<double>(low), static_cast<double>(high)};
}

/// The same without the outermost: a single stray point would make the image huge.
Interval usualRange(const std::vector<float>& slopes) {
  const std::size_t cut = slopes.size() / 2000;
  return {static_cast<double>(slopes[cut]), static_cast<double>(slopes[slopes.size() - 1 - cut])};
}

Intrinsics estimateIntrinsics(const OrganizedCloud& cloud) {
  const std::vector<float> xs = sampleSlopes(cloud, 0), ys = sampleSlopes(cloud, 1);
  Interval across = usualRange(xs), down = usualRange(ys);
  const std::optional<Axis> columns = findLattice(xs), rows = findLattice(ys);
  Intrinsics out;
  if (columns && rows) {
    across = wholeRange(cloud, 0);
    down = wholeRange(cloud, 1);
    out.focal_x = columns->focal;
    out.center_x = columns->center;
    out.focal_y = rows->focal;
    out.center_y = rows->center;
  } else {
    out.focal_x = out.focal_y = focalByDensity(cloud, across.low, across.high, down.low, down.high);
    out.center_x = -across.low * out.focal_x;
    out.center_y = -down.low * out.focal_y;
  }
  // The image ends with the points.
  out.center_x -= std::round(across.low * out.focal_x + out.center_x);
  out.center_y -= std::round(down.low * out.focal_y + out.center_y);
  const auto size = [](double last) {
    return static_cast<int>(std::clamp(std::round(last) + 1.0, 1.0, std::sqrt(kMostPixels)));
  };
  out.width = size(across.high * out.focal_x + out.center_x);
  out.height = size(down.high * out.focal_y + out.center_y);
  return out;
}

void checkIntrinsics(const Intrinsics& given) {
  const bool finite = std::isfinite(given.focal_x) && std::isfinite(given.focal_y) &&
                      std::isfinite(given.center_x) && std::isfinite(given.center_y);
  if (!finite || given.focal_x <= 0.0 || given.focal_y <= 0.0 || given.width <= 0 ||
      given.height <= 0 || static_cast<double>(given.width) * given.height > kMostPixels) {
    throw hyselam::InputError("camera", "intrinsics",
                              "are not finite and positive, or of a too large image");
  }
}

}  // namespace

std::optional<OrganizedView> organizeCloud(const OrganizedCloud& cloud,
                                           const std::optional<Intrinsics>& intrinsics) {
  constexpr float kNear = 1.02f;  // of a depth: points of one surface
  if (intrinsics) checkIntrinsics(*intrinsics);
  std::size_t in_front = 0;
  for (const Point& p : cloud.points) in_front += isInFront(p);
  if (in_front < 100) return std::nullopt;
  const Intrinsics camera = intrinsics ? *intrinsics : estimateIntrinsics(cloud);
  OrganizedView out;
  out.camera = camera;
  out.cloud.width = camera.width;
  out.cloud.height = camera.height;
  const std::size_t size =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  out.cloud.points.assign(size, Point(nan, nan, nan));
  if (!cloud.colors.empty()) out.cloud.colors.assign(size, 0);
  out.pixel_of.assign(cloud.size(), -1);
  std::size_t inside = 0, hiding = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Point& p = cloud.points[i];
    if (!isInFront(p)) continue;
    const double u =
        std::round(camera.focal_x * static_cast<double>(slope(p, 0)) + camera.center_x);
    const double v =
        std::round(camera.focal_y * static_cast<double>(slope(p, 1)) + camera.center_y);
    if (!(u >= 0.0 && u < camera.width && v >= 0.0 && v < camera.height)) continue;
    const auto pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(camera.width) +
                       static_cast<std::size_t>(u);
    out.pixel_of[i] = static_cast<std::int32_t>(pixel);
    ++inside;
    Point& seen = out.cloud.points[pixel];
    if (isInFront(seen)) {
      hiding += std::max(seen.z(), p.z()) > kNear * std::min(seen.z(), p.z());
      if (seen.z() <= p.z()) continue;
    }
    seen = p;
    if (!cloud.colors.empty()) out.cloud.colors[pixel] = cloud.colors[i];
  }
  if (2 * inside < in_front || 20 * hiding > inside) return std::nullopt;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::int32_t& pixel = out.pixel_of[i];
    if (pixel >= 0 &&
        cloud.points[i].z() > kNear * out.cloud.points[static_cast<std::size_t>(pixel)].z()) {
      pixel = -1;  // hidden
    }
  }
  return out;
}

}  // namespace hyselam_objects
