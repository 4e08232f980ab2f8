// A downsampled frame with normals: the input of the segmentation.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "hyselam_objects/segmentation/segment_cloud.hpp"

namespace hyselam_objects {

class SurfaceGrid {
 public:
  SurfaceGrid(const OrganizedCloud& cloud, const SegmentParams& params);

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t size() const { return points_.size(); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  /// The neighboring pixel; nothing beyond the border.
  std::optional<std::size_t> neighbor(std::size_t i, int dx, int dy) const {
    const int x = static_cast<int>(i % static_cast<std::size_t>(width_)) + dx;
    const int y = static_cast<int>(i / static_cast<std::size_t>(width_)) + dy;
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return std::nullopt;
    return index(x, y);
  }
  template <typename Visit>
  void forNeighbors(std::size_t i, Visit visit) const {
    const auto w = static_cast<std::size_t>(width_);
    const std::size_t x = i % w;
    if (x + 1 < w) visit(i + 1);
    if (x > 0) visit(i - 1);
    if (i + w < size()) visit(i + w);
    if (i >= w) visit(i - w);
  }

  bool isValid(std::size_t i) const { return sigma_[i] > 0.0f; }
  const Point& point(std::size_t i) const { return points_[i]; }
  /// Standard deviation of the depth [m]; 0 without a measurement.
  float sigma(std::size_t i) const { return sigma_[i]; }
  bool hasNormal(std::size_t i) const { return variation_[i] < 1.0f; }
  /// Of length 1, towards the camera.
  const Point& normal(std::size_t i) const { return normals_[i]; }
  /// Surface variation (Pauly et al. 2002): share of the smallest eigenvalue of the neighborhood's
  /// covariance, 0 (plane) .. 1/3.
  float variation(std::size_t i) const { return variation_[i]; }
  bool hasColors() const { return !colors_.empty(); }
  /// Lightness (R + G + B) / 3, (R - G) / 2 and (R + G - 2 B) / 4, of a white of 1; zero if colors
  /// are not known.
  Point color(std::size_t i) const { return hasColors() ? colors_[i] : Point::Zero(); }
  /// Whether two neighbors lie on one surface: no jump in depth.
  bool areConnected(std::size_t i, std::size_t j) const;

 private:
  void downsample(const OrganizedCloud& cloud, const SegmentParams& params);
  void computeNormals(int window);

  int width_ = 0;
  int height_ = 0;
  std::vector<Point> points_;
  std::vector<float> sigma_;
  std::vector<Point> colors_;  // of each pixel, or none
  std::vector<Point> normals_;
  std::vector<float> variation_;
};

}  // namespace hyselam_objects
