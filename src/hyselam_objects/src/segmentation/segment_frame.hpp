// Segmentation of one frame with any model of relations, for its training.
#pragma once

#include <optional>

#include "hyselam_objects/segmentation/organize_cloud.hpp"
#include "relation_model.hpp"

namespace hyselam_objects {

/// A cloud as the segmentation wants it: with rows, in front of the camera, x and y running with
/// columns and rows, up in the image up in the world; and its support.
class UprightFrame {
 public:
  /// @throws hyselam::InputError as segmentCloud().
  UprightFrame(const OrganizedCloud& cloud, const SegmentParams& params,
               const std::optional<Eigen::Vector3f>& up);
  UprightFrame(const UprightFrame&) = delete;
  UprightFrame& operator=(const UprightFrame&) = delete;

  const OrganizedCloud& cloud() const { return *cloud_; }
  const SurfaceGrid& grid() const { return *grid_; }
  const std::optional<Plane>& support() const { return support_; }
  const ImageTurn& turn() const { return turn_; }
  /// The pixel of a point of the original; -1: in none.
  std::int32_t pixelOf(std::size_t i) const {
    return pixel_of_.empty() ? static_cast<std::int32_t>(i) : pixel_of_[i];
  }
  /// The support in the frame of the original cloud.
  std::optional<Plane> originalSupport() const;
  /// Labels of the points of the original from labels of the pixels.
  std::vector<std::uint32_t> originalLabels(const std::vector<std::uint32_t>& labels) const;

 private:
  void organize(const OrganizedCloud& cloud);
  void alignAxes();
  void turnOver();
  OrganizedCloud& ownCloud();

  const OrganizedCloud& original_;
  const OrganizedCloud* cloud_;  ///< the original or own_
  OrganizedCloud own_;
  std::vector<std::int32_t> pixel_of_;  ///< of each point of the original; empty: the same
  Eigen::Array3f sign_ = Eigen::Array3f::Ones();  ///< of the axes
  ImageTurn turn_;
  std::optional<SurfaceGrid> grid_;
  std::optional<Plane> support_;
};

/// segmentCloud() with another model.
CloudSegmentation segmentCloudBy(const OrganizedCloud& cloud, const SegmentParams& params,
                                 const std::optional<Eigen::Vector3f>& up,
                                 const RelationModel& model);

}  // namespace hyselam_objects
