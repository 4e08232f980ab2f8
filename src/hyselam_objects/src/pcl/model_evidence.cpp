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

}  // namespace

SceneView::SceneView(const OrganizedCloud& scene) {
  std::size_t before = 0, behind = 0;
  for (const Point& p : scene.points) {
    before += p.z() > 0.0f;
    behind += p.z() < 0.0f;
  }
  if (behind <= before) {
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

ModelEvidence SceneView::judge(const std::vector<Point>& points, double tolerance) const {
  ModelEvidence out;
  // What of the model hides the rest of it.
  std::map<Cell, float> nearest;
  const auto cellOf = [&](const Point& p) {
    const Pixel at = project(p);
    const float size = std::max(2.0f, kCell * static_cast<float>(view_->camera.focal_x) / p.z());
    return Cell{static_cast<int>(std::floor(at.u / size)),
                static_cast<int>(std::floor(at.v / size))};
  };
  std::vector<Point> placed;
  for (const Point& p : points) placed.push_back(sign_ * p);
  for (const Point& p : placed) {
    if (!(p.z() > 0.05f)) continue;
    const auto [at, is_new] = nearest.insert({cellOf(p), p.z()});
    if (!is_new) at->second = std::min(at->second, p.z());
  }
  const auto nearestAround = [&](const Cell& cell) {
    float out_depth = std::numeric_limits<float>::infinity();
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto at = nearest.find({cell.first + dx, cell.second + dy});
        if (at != nearest.end()) out_depth = std::min(out_depth, at->second);
      }
    }
    return out_depth;
  };
  constexpr float kThickness = 0.015f;  // of the model's near side [m]
  int near_side = 0, covered = 0, violated = 0, outline = 0, flush = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Point& p = placed[i];
    if (!(p.z() > 0.05f)) continue;
    const Cell cell = cellOf(p);
    if (p.z() > nearestAround(cell) + kThickness) continue;
    ++near_side;
    const Pixel at = project(p);
    const float limit = toleranceAt(p.z(), tolerance);
    const float seen = depthNear(at, p.z());
    if (std::isnan(seen) || seen < p.z() - limit) continue;  // not known, or hidden
    if (seen > p.z() + limit) {
      ++violated;
      continue;
    }
    ++covered;
    out.pixels.push_back(static_cast<std::int32_t>(std::lround(at.v)) * view_->cloud.width +
                         static_cast<std::int32_t>(std::lround(at.u)));
    // Where the model ends, some cells on there is nothing of it: does the scene go on straight?
    const float size = std::max(2.0f, kCell * static_cast<float>(view_->camera.focal_x) / p.z());
    for (const auto& [dx, dy] : {Cell{3, 0}, Cell{-3, 0}, Cell{0, 3}, Cell{0, -3}}) {
      if (std::isfinite(nearestAround({cell.first + dx, cell.second + dy}))) continue;
      const float u = size * static_cast<float>(dx), v = size * static_cast<float>(dy);
      const float inner = depthNear({at.u - u, at.v - v}, seen);
      if (std::isnan(inner)) continue;
      ++outline;
      // Along a line in a plane the inverse of depth grows evenly.
      const float straight = 1.0f / (2.0f / seen - 1.0f / inner);
      flush += std::abs(depthNear({at.u + u, at.v + v}, straight) - straight) < 0.5f * limit;
    }
  }
  std::sort(out.pixels.begin(), out.pixels.end());
  out.pixels.erase(std::unique(out.pixels.begin(), out.pixels.end()), out.pixels.end());
  const auto share = [](int part, int whole) {
    return whole > 0 ? static_cast<double>(part) / whole : 0.0;
  };
  out.coverage = share(covered, covered + violated);
  out.violation = share(violated, covered + violated);
  out.visible = share(covered + violated, near_side);
  out.flush = share(flush, outline);
  return out;
}

}  // namespace hyselam_objects
