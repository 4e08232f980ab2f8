// How well a scene agrees with a model at a pose, by what its camera could see of it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hyselam_objects/segmentation/organize_cloud.hpp"

namespace hyselam_objects {

/// Points of the model's surface, counted; those of several views add up.
struct ModelEvidence {
  int near_side = 0;  ///< that nothing of the model itself hides
  int covered = 0;    ///< ... and that lie on the scene
  int violated = 0;   ///< ... and that the camera looks through
  int outline = 0;    ///< places at its outline beyond which something is seen
  int flush = 0;  ///< ... where the scene goes on straight: nothing tells it from what it lies in

  /// Share of the visible points that lie on the scene.
  double coverage() const { return share(covered, covered + violated); }
  /// Share of the points on the near side that nothing hides.
  double visible() const { return share(covered + violated, near_side); }
  /// Share of the outline at which the scene goes on straight.
  double flushShare() const { return share(flush, outline); }

  ModelEvidence& operator+=(const ModelEvidence& other) {
    near_side += other.near_side;
    covered += other.covered;
    violated += other.violated;
    outline += other.outline;
    flush += other.flush;
    return *this;
  }

 private:
  static double share(int part, int whole) {
    return whole > 0 ? static_cast<double>(part) / whole : 0.0;
  }
};

/// One view of a camera at the origin.
class SceneView {
 public:
  /// @throws hyselam::InputError as organizeCloud().
  explicit SceneView(const OrganizedCloud& scene);

  /// Whether the scene is one view; otherwise nothing is known of what hides what.
  bool isOne() const { return view_.has_value(); }

  /// `points` of the model's surface at its pose; `tolerance` of depth at 0 m [m]. `explains`, if
  /// given, becomes the pixels of the scene that it explains, sorted.
  ModelEvidence judge(const std::vector<Point>& points, double tolerance,
                      std::vector<std::int32_t>* explains = nullptr) const;

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
