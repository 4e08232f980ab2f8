#include "horizontal_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

namespace hyselam_objects {
namespace {

float medianHeight(const MappedFrame& frame, const std::vector<std::size_t>& pixels) {
  std::vector<float> heights;
  heights.reserve(pixels.size());
  for (const std::size_t i : pixels) heights.push_back(frame.point(i).z());
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

/// Connected pixels with an upright normal, without a step in height.
std::vector<HorizontalSurface> growSurfaces(const MappedFrame& frame, const DetectParams& params) {
  constexpr std::size_t kMinPixels = 20;
  const auto upright = static_cast<float>(std::cos(params.max_tilt));
  std::vector<char> open(frame.size(), 0);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    open[i] = frame.isInRange(i) && frame.normalZ(i) > upright &&
              frame.point(i).z() > params.min_surface_height;
  }
  std::vector<HorizontalSurface> pieces;
  std::deque<std::size_t> front;
  for (std::size_t seed = 0; seed < frame.size(); ++seed) {
    if (open[seed] == 0) continue;
    HorizontalSurface piece;
    open[seed] = 0;
    front.push_back(seed);
    while (!front.empty()) {
      const std::size_t i = front.front();
      front.pop_front();
      piece.pixels.push_back(i);
      frame.grid().forNeighbors(i, [&](std::size_t j) {
        const float step = std::abs(frame.point(i).z() - frame.point(j).z());
        if (open[j] == 0 || step > 0.01f + 2.0f * frame.grid().sigma(i)) return;
        open[j] = 0;
        front.push_back(j);
      });
    }
    if (piece.pixels.size() < kMinPixels) continue;
    std::vector<Eigen::Vector2f> ground;
    for (const std::size_t i : piece.pixels) ground.push_back(frame.point(i).head<2>());
    piece.height = medianHeight(frame, piece.pixels);
    piece.hull = convexHull(std::move(ground));
    if (piece.hull.size() >= 3) pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// Whether the camera sees through the plane between two pieces in a large share of the rays: then
/// they are the tops of two objects, not one top with something on it.
bool isGapOpen(const MappedFrame& frame, const HorizontalSurface& a, const HorizontalSurface& b,
               const ConvexHull& both) {
  constexpr double kBetween = 0.03, kOpen = 0.3;
  const Eigen::Vector3f& eye = frame.cameraPosition();
  const auto height = static_cast<float>(0.5 * (a.height + b.height));
  if (eye.z() < height + 0.05f) return false;
  std::size_t open = 0, all = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const Eigen::Vector3f& p = frame.point(i);
    // A ray that ends above the plane may go through it behind what it ends on.
    if (!frame.grid().isValid(i) || p.z() > eye.z() - 0.05f) continue;
    const Eigen::Vector3f ray = p - eye;
    const Eigen::Vector2f at = (eye + ray * ((height - eye.z()) / ray.z())).head<2>();
    if (distanceOutside(both, at) > 0.0 || distanceOutside(a.hull, at) < kBetween ||
        distanceOutside(b.hull, at) < kBetween) {
      continue;
    }
    ++all;
    open += p.z() < height - 0.03f - 2.0f * frame.grid().sigma(i);
  }
  return static_cast<double>(open) > kOpen * static_cast<double>(all);
}

/// Merges parts of one top that objects on it separate in the image.
void mergePieces(const MappedFrame& frame, std::vector<HorizontalSurface>& pieces) {
  constexpr double kGap = 0.25, kStep = 0.02;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t j = i + 1; j < pieces.size();) {
      HorizontalSurface &a = pieces[i], &b = pieces[j];
      bool near = false;
      for (const Eigen::Vector2f& p : b.hull) near = near || distanceOutside(a.hull, p) < kGap;
      if (!near || std::abs(a.height - b.height) > kStep) {
        ++j;
        continue;
      }
      ConvexHull both = a.hull;
      both.insert(both.end(), b.hull.begin(), b.hull.end());
      both = convexHull(std::move(both));
      if (isGapOpen(frame, a, b, both)) {
        ++j;
        continue;
      }
      const auto na = static_cast<double>(a.pixels.size()),
                 nb = static_cast<double>(b.pixels.size());
      a.height = (na * a.height + nb * b.height) / (na + nb);
      a.pixels.insert(a.pixels.end(), b.pixels.begin(), b.pixels.end());
      a.hull = std::move(both);
      pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;
    }
  }
}

/// Whether a surface is the top of objects on the furniture below: not taller than objects are, and
/// smaller than it.
bool isTopOfObjects(const HorizontalSurface& surface, const HorizontalSurface& below,
                    double max_object_height) {
  constexpr double kMinStep = 0.03, kMaxArea = 0.7, kMargin = 0.05;
  const double step = surface.height - below.height;
  if (step < kMinStep || step > max_object_height) return false;
  if (areaOf(surface.hull) > kMaxArea * areaOf(below.hull)) return false;
  const auto within = std::count_if(surface.hull.begin(), surface.hull.end(), [&](const auto& p) {
    return distanceOutside(below.hull, p) < kMargin;
  });
  return 5 * within > 4 * static_cast<std::ptrdiff_t>(surface.hull.size());
}

}  // namespace

std::vector<HorizontalSurface> findHorizontalSurfaces(const MappedFrame& frame,
                                                      const DetectParams& params) {
  std::vector<HorizontalSurface> pieces = growSurfaces(frame, params);
  mergePieces(frame, pieces);
  pieces.erase(std::remove_if(pieces.begin(), pieces.end(),
                              [&](const HorizontalSurface& piece) {
                                return areaOf(piece.hull) < params.min_surface_area;
                              }),
               pieces.end());
  std::stable_sort(
      pieces.begin(), pieces.end(),
      [](const HorizontalSurface& a, const HorizontalSurface& b) { return a.height > b.height; });
  std::vector<HorizontalSurface> found;
  for (auto piece = pieces.begin(); piece != pieces.end(); ++piece) {
    const bool is_top = std::any_of(piece + 1, pieces.end(), [&](const HorizontalSurface& below) {
      return isTopOfObjects(*piece, below, params.segmentation.max_object_height);
    });
    if (!is_top) found.push_back(std::move(*piece));
  }
  return found;
}

}  // namespace hyselam_objects
