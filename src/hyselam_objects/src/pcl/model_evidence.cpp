#include "model_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace hyselam_objects {
namespace {

constexpr float kCell = 0.008f;           // side of what a point of the model covers [m]
constexpr float kDepthTolerance = 3e-3f;  // grows by this times the squared depth [1/m]

using Cell = std::pair<int, int>;

float toleranceAt(float depth, double tolerance) {
  return static_cast<float>(tolerance) + kDepthTolerance * depth * depth;
}

/// Least depth of the model in cells of the image: what of it hides the rest.
class NearSide {
 public:
  void add(const Cell& cell, float depth) {
    const auto [at, is_new] = nearest_.insert({cell, depth});
    if (!is_new) at->second = std::min(at->second, depth);
  }
  /// In a cell and those around; infinite without any.
  float depthAround(const Cell& cell) const {
    float out = std::numeric_limits<float>::infinity();
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto at = nearest_.find({cell.first + dx, cell.second + dy});
        if (at != nearest_.end()) out = std::min(out, at->second);
      }
    }
    return out;
  }

 private:
  std::map<Cell, float> nearest_;
};

}  // namespace

SceneView::SceneView(const OrganizedCloud& scene) {
  if (!liesBehind(scene)) {
    view_ = organizeCloud(scene);
    return;
  }
  // Through the origin: rays stay rays.
  sign_ = -1.0f;
  OrganizedCloud before_camera = scene;
  for (Point& p : before_camera.points) p = -p;
  view_ = organizeCloud(before_camera);
}

SceneView::Pixel SceneView::project(const Point& p) const {
  const Intrinsics& camera = view_->camera;
  return {static_cast<float>(camera.focal_x) * p.x() / p.z() + static_cast<float>(camera.center_x),
          static_cast<float>(camera.focal_y) * p.y() / p.z() + static_cast<float>(camera.center_y)};
}

/// The depth at a pixel and its neighbors that is nearest to the one expected; NaN without any.
float SceneView::depthNear(const Pixel& at, float depth) const {
  const OrganizedCloud& scene = view_->cloud;
  float best = std::numeric_limits<float>::quiet_NaN();
  if (!(std::abs(at.u) < 1e6f && std::abs(at.v) < 1e6f)) return best;
  const int x = static_cast<int>(std::lround(at.u)), y = static_cast<int>(std::lround(at.v));
  for (int v = std::max(0, y - 1); v <= std::min(scene.height - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(scene.width - 1, x + 1); ++u) {
      const float z =
          scene
              .points[static_cast<std::size_t>(v) * static_cast<std::size_t>(scene.width) +
                      static_cast<std::size_t>(u)]
              .z();
      if (std::isnan(z)) continue;
      if (std::isnan(best) || std::abs(z - depth) < std::abs(best - depth)) best = z;
    }
  }
  return best;
}

/// Side of a cell at a depth [pixel].
float SceneView::cellSize(float depth) const {
  return std::max(2.0f, kCell * static_cast<float>(view_->camera.focal_x) / depth);
}

/// The pixels of a cell around `at`: what a point of the model covers, not one pixel of it.
void SceneView::addPixels(const Pixel& at, float size, std::vector<std::int32_t>& to) const {
  const int width = view_->cloud.width, height = view_->cloud.height;
  const int u = static_cast<int>(std::lround(at.u)), v = static_cast<int>(std::lround(at.v));
  const int half = static_cast<int>(0.5f * std::min(size, 100.0f));
  for (int y = std::max(0, v - half); y <= std::min(height - 1, v + half); ++y) {
    for (int x = std::max(0, u - half); x <= std::min(width - 1, u + half); ++x) {
      to.push_back(static_cast<std::int32_t>(y * width + x));
    }
  }
}

/// Whether the scene goes on straight from `at`, where its depth is `seen`, by (u, v) pixels;
/// nothing if it is not seen as far back.
std::optional<bool> SceneView::goesOn(const Pixel& at, float seen, float u, float v,
                                      float tolerance) const {
  const float inner = depthNear({at.u - u, at.v - v}, seen);
  if (std::isnan(inner)) return std::nullopt;
  // Along a line in a plane the inverse of depth grows evenly.
  const float straight = 1.0f / (2.0f / seen - 1.0f / inner);
  return std::abs(depthNear({at.u + u, at.v + v}, straight) - straight) < tolerance;
}

ModelEvidence SceneView::judge(const std::vector<Point>& points, double tolerance,
                               std::vector<std::int32_t>* explains) const {
  constexpr float kThickness = 0.015f;  // of the model's near side [m]
  constexpr float kNearest = 0.05f;     // of a camera's depths [m]
  constexpr int kBeyond = 3;            // cells from a point to beyond the outline
  constexpr float kWidest = 1e5f;       // pixels from the center that are looked at
  std::vector<Point> placed;
  std::vector<float> depths;
  for (const Point& p : points) {
    if (!(sign_ * p.z() > kNearest)) continue;
    const Pixel at = project(sign_ * p);
    if (!(std::abs(at.u) < kWidest && std::abs(at.v) < kWidest)) continue;
    placed.push_back(sign_ * p);
    depths.push_back(placed.back().z());
  }
  if (explains != nullptr) explains->clear();
  if (placed.empty()) return {};
  // One raster for all: with a size for each depth, near and far of one ray would be far apart.
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  const float size = cellSize(*middle);
  const auto cellOf = [&](const Point& p) {
    const Pixel at = project(p);
    return Cell{static_cast<int>(std::floor(at.u / size)),
                static_cast<int>(std::floor(at.v / size))};
  };
  NearSide model;
  for (const Point& p : placed) model.add(cellOf(p), p.z());
  ModelEvidence out;
  for (const Point& p : placed) {
    const Cell cell = cellOf(p);
    if (p.z() > model.depthAround(cell) + kThickness) continue;
    ++out.near_side;
    const Pixel at = project(p);
    const float limit = toleranceAt(p.z(), tolerance);
    const float seen = depthNear(at, p.z());
    if (std::isnan(seen) || seen < p.z() - limit) continue;  // not known, or hidden
    if (seen > p.z() + limit) {
      ++out.violated;
      continue;
    }
    ++out.covered;
    if (explains != nullptr) addPixels(at, size, *explains);
    for (const auto& [dx, dy] :
         {Cell{kBeyond, 0}, Cell{-kBeyond, 0}, Cell{0, kBeyond}, Cell{0, -kBeyond}}) {
      if (std::isfinite(model.depthAround({cell.first + dx, cell.second + dy}))) continue;
      const auto on = goesOn(at, seen, size * static_cast<float>(dx), size * static_cast<float>(dy),
                             0.5f * limit);
      out.outline += on.has_value();
      out.flush += on.value_or(false);
    }
  }
  if (explains != nullptr) {
    std::sort(explains->begin(), explains->end());
    explains->erase(std::unique(explains->begin(), explains->end()), explains->end());
  }
  return out;
}

}  // namespace hyselam_objects
