#include "hyselam_objects/segmentation/organize_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
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

bool isDirection(const Point& p) {
  return p.allFinite() && !p.isZero(0.0f);
}

/// And less than 87 degrees from where the camera looks: nearer to its plane a direction is no
/// place in an image.
bool isInFront(const Point& p) {
  constexpr float kMostSlope = 20.0f;
  return p.allFinite() && p.z() > 0.0f && std::abs(p.x()) < kMostSlope * p.z() &&
         std::abs(p.y()) < kMostSlope * p.z() && std::isfinite(slope(p, 0)) &&
         std::isfinite(slope(p, 1));
}

/// The directions of all points in front, sorted. Every tenth would be every tenth column only,
/// where the points are still in the order of an image.
std::vector<float> sortedSlopes(const OrganizedCloud& cloud, int axis) {
  std::vector<float> out;
  for (const Point& p : cloud.points) {
    if (isInFront(p)) out.push_back(slope(p, axis));
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

/// Columns (or rows) of a cloud that has them: the straight line through directions over places;
/// nothing if a tenth of the points are off it by half a pixel or more.
std::optional<Axis> axisOfRows(const OrganizedCloud& cloud, int axis) {
  const auto width = static_cast<std::size_t>(cloud.width);
  const auto placeOf = [&](std::size_t i) {
    return static_cast<double>(axis == 0 ? i % width : i / width);
  };
  double n = 0.0, place = 0.0, direction = 0.0;  // means
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!isInFront(cloud.points[i])) continue;
    n += 1.0;
    place += (placeOf(i) - place) / n;
    direction += (static_cast<double>(slope(cloud.points[i], axis)) - direction) / n;
  }
  double spread = 0.0, both = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!isInFront(cloud.points[i])) continue;
    const double off = placeOf(i) - place;
    spread += off * off;
    both += off * (static_cast<double>(slope(cloud.points[i], axis)) - direction);
  }
  const double pitch = both / spread;
  if (!(pitch > 1e-6)) return std::nullopt;  // also if all are in one column
  const Axis out{1.0 / pitch, place - direction / pitch};
  double off = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!isInFront(cloud.points[i])) continue;
    const double at = out.focal * static_cast<double>(slope(cloud.points[i], axis)) + out.center;
    off += !(std::abs(at - placeOf(i)) < 0.5);
  }
  if (10.0 * off >= n) return std::nullopt;
  return out;
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
    const auto x = static_cast<double>(slope(p, 0)), y = static_cast<double>(slope(p, 1));
    if (x < left || x > right || y < top || y > bottom) continue;
    ++points;
    seen.insert({static_cast<int>((x - left) / cell), static_cast<int>((y - top) / cell)});
  }
  const auto cells = static_cast<double>(std::max<std::size_t>(1, seen.size()));
  return std::sqrt(static_cast<double>(std::max<std::size_t>(1, points)) / cells) / cell;
}

struct Interval {
  double low, high;
};

/// Of the directions without the outermost: a single stray point would make the image huge.
Interval usualRange(const std::vector<float>& slopes) {
  const std::size_t cut = slopes.size() / 2000;
  return {static_cast<double>(slopes[cut]), static_cast<double>(slopes[slopes.size() - 1 - cut])};
}

/// All directions but those far beyond the usual.
Interval rangeOfLattice(const std::vector<float>& slopes) {
  const Interval usual = usualRange(slopes);
  const double margin = 0.1 * (usual.high - usual.low);
  const auto first = std::lower_bound(slopes.begin(), slopes.end(), usual.low - margin);
  const auto end = std::upper_bound(first, slopes.end(), usual.high + margin);
  return {static_cast<double>(*first), static_cast<double>(*std::prev(end))};
}

/// Whether there are enough points for an image of these columns and rows.
bool isFilled(const std::vector<float>& xs, const Axis& columns, const std::vector<float>& ys,
              const Axis& rows) {
  constexpr double kMostPixelsOfAPoint = 1000.0;
  const Interval across = rangeOfLattice(xs), down = rangeOfLattice(ys);
  const double pixels = (columns.focal * (across.high - across.low) + 1.0) *
                        (rows.focal * (down.high - down.low) + 1.0);
  return pixels < kMostPixelsOfAPoint * static_cast<double>(xs.size());
}

Intrinsics estimateIntrinsics(const OrganizedCloud& cloud) {
  if (cloud.width > 1 && cloud.height > 1) {
    const std::optional<Axis> columns = axisOfRows(cloud, 0), rows = axisOfRows(cloud, 1);
    if (columns && rows) {
      return {columns->focal, rows->focal, columns->center,
              rows->center,   cloud.width, cloud.height};
    }
  }
  const std::vector<float> xs = sortedSlopes(cloud, 0), ys = sortedSlopes(cloud, 1);
  Interval across = usualRange(xs), down = usualRange(ys);
  const std::optional<Axis> columns = findLattice(xs), rows = findLattice(ys);
  Intrinsics out;
  if (columns && rows && isFilled(xs, *columns, ys, *rows)) {
    across = rangeOfLattice(xs);
    down = rangeOfLattice(ys);
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

bool liesBehind(const OrganizedCloud& cloud) {
  std::size_t before = 0, behind = 0;
  for (const Point& p : cloud.points) {
    if (!p.allFinite()) continue;
    before += p.z() > 0.0f;
    behind += p.z() < 0.0f;
  }
  return behind > before;
}

void turnToFront(OrganizedCloud& cloud) {
  for (Point& p : cloud.points) p = Point(p.x(), -p.y(), -p.z());
}

std::size_t usablePoints(const OrganizedCloud& cloud) {
  return static_cast<std::size_t>(
      std::count_if(cloud.points.begin(), cloud.points.end(), isDirection));
}

std::optional<OrganizedView> organizeCloud(const OrganizedCloud& cloud,
                                           const std::optional<Intrinsics>& intrinsics) {
  constexpr float kNear = 1.02f;  // of a depth: points of one surface
  if (intrinsics) checkIntrinsics(*intrinsics);
  std::size_t in_front = 0;
  for (const Point& p : cloud.points) in_front += isInFront(p);
  if (in_front < kLeastPoints) return std::nullopt;
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
  if (2 * inside < usablePoints(cloud) || 20 * hiding > inside) return std::nullopt;
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
