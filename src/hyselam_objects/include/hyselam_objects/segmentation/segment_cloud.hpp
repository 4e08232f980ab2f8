// Segmentation of a frame into objects on a table, a shelf or the floor, without a model of them.
//
// A frame is split into smooth patches (normals that turn slowly). Of two patches that touch, or of
// which one goes on behind something nearer, a learnt model tells the odds that they are parts of
// one object: by convexity (Stein et al., Object partitioning using local convexity, CVPR 2014),
// by how well one continues the other, by their outlines and colors. Patches are joined while the
// odds of all pairs together are for it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_objects/segmentation/organize_cloud.hpp"

namespace hyselam_objects {

/// A reduced pixel stands for `downsampling` x `downsampling` pixels. Lengths, angles and shares
/// without a range of their own: 0 .. 10.
struct SegmentParams {
  int downsampling = 2;            ///< of rows and columns, 1 .. 8
  double noise_floor = 0.0012;     ///< standard deviation of a depth at 0.4 m [m] ...
  double noise_growth = 0.0019;    ///< ... and its growth with (depth - 0.4 m)^2 [1/m]
  int normal_window = 4;           ///< half side of the window of a normal [reduced pixel], 1 .. 20
  double max_smooth_angle = 0.14;  ///< between the normals of neighbors in one patch [rad]
  double max_surface_variation = 0.018;  ///< where patches grow, 0 .. 1/3
  double support_distance = 0.007;       ///< nearer points belong to the support plane [m], + noise
  double max_object_height = 0.6;        ///< above the support plane [m]
  double max_support_tilt = 0.35;        ///< of the support, where up is known [rad], 0 .. 1.5
  // What is measured of two patches, see docs/algorithms/objects.md:
  double join_bias = 0.0;             ///< log-odds added for each pair: > 0 joins more, -10 .. 10
  double concavity_tolerance = 0.17;  ///< a smaller concave angle counts as flat [rad]
  double max_step = 0.007;            ///< surfaces in contact miss each other by less [m]
  // In rooms (detect_objects.hpp) two patches are joined across a common border by rule, if
  double min_convex_ratio = 0.55;  ///< this share of their contact is convex,
  double min_contact_ratio = 0.2;  ///< this share of the border is in contact,
  double min_border_ratio = 0.35;  ///< and it is this long over the root of the smaller size
  // The inside of a hollow object such as a cup:
  double min_hollow_angle = 0.05;  ///< concave turn of the normals over some pixels [rad]
  double min_hollow_ratio = 0.5;   ///< share of its lower edge that the outside hides
  // Surfaces on both sides of an occluder continue each other if
  double max_occlusion_length = 0.3;    ///< they are this near [m] (farther ones are not compared),
  double max_occlusion_angle = 0.35;    ///< their normals differ by less [rad],
  double max_occlusion_offset = 0.012;  ///< and they continue each other within this [m]
  int min_object_pixels = 40;           ///< of an object [reduced pixel], >= 1
  int max_fragment_pixels = 120;        ///< smaller fragments join the object around them, >= 0
  double max_fragment_gap = 0.08;       ///< ... within this distance [m]
  std::uint64_t seed = 1;               ///< of the search for the support plane (RANSAC)

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// A plane normal . p = distance, |normal| = 1; the normal points to the camera.
struct Plane {
  Eigen::Vector3f normal{0.0f, 0.0f, -1.0f};
  float distance = 0.0f;
  float heightOf(const Point& p) const { return normal.dot(p) - distance; }
};

struct CloudSegmentation {
  /// Of each point: 0 no measurement, 1 support and background, 2 ... objects, ordered by their
  /// distance from the camera.
  std::vector<std::uint32_t> labels;
  std::uint32_t objects = 0;     ///< number of objects: labels 2 .. objects + 1
  std::optional<Plane> support;  ///< nothing: no plane was found, everything is background
  ImageTurn turn;                ///< how the image had to be turned first
};

/// @throws hyselam::InputError for a cloud whose sizes do not match or that is larger than 50
///         million points.
void checkCloud(const OrganizedCloud& cloud);

/// Segments one frame. `up`: against gravity, in the frame of the cloud, of any length; without it
/// the largest plane is the support, walls counting less. A cloud of one row gets rows as by
/// organizeCloud(); one with fewer than kLeastPoints usable points has neither support nor objects.
/// The same arguments give the same labels.
/// @throws hyselam::InputError as checkCloud(), for an `up` that is no direction, and for a cloud
///         of one row that was not seen from its origin; hyselam::ParameterError.
CloudSegmentation segmentCloud(const OrganizedCloud& cloud, const SegmentParams& params = {},
                               const std::optional<Eigen::Vector3f>& up = {});

}  // namespace hyselam_objects
