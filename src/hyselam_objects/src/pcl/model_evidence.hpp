// How well a scene agrees with a model at a pose, by what its camera could see of it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hyselam_objects/segmentation/organize_cloud.hpp"

namespace hyselam_objects {

struct ModelEvidence {
  double coverage = 0.0;   ///< share of the visible points that lie on the scene
  double violation = 0.0;  ///< share of the visible points that the camera looks through
  double visible = 0.0;    ///< share of the points on the near side that nothing hides
  /// Share of the outline at which the scene goes on straight beyond it: nothing tells it from
  /// what it lies in.
  double flush = 0.0;
  std::vector<std::int32_t> pixels;  ///< of the scene that it explains, sorted
};

/// One view of a camera at the origin.
class SceneView {
 public:
  /// @throws hyselam::InputError as organizeCloud().
  explicit SceneView(const OrganizedCloud& scene);

  /// Whether the scene is one view; otherwise nothing is known of what hides what.
  bool isOne() const { return view_.has_value(); }

  /// `points` of the model's surface at its pose; `tolerance` of depth at 0 m [m].
  ModelEvidence judge(const std::vector<Point>& points, double tolerance) const;

 private:
  struct Pixel {
    float u, v;
  };
  Pixel project(const Point& p) const;
  float depthNear(const Pixel& at, float depth) const;
  float cellSize(float depth) const;
  void addPixels(const Pixel& at, float size, std::vector<std::int32_t>& to) const;
  std::optional<bool> goesOn(const Pixel& at, float seen, float u, float v, float tolerance) const;

  float sign_ = 1.0f;  ///< -1: depth is negative in this scene
  std::optional<OrganizedView> view_;
};

}  // namespace hyselam_objects
