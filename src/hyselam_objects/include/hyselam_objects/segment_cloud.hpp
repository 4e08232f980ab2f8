// Which points belong to one thing: the objects on a table, a shelf or the floor, without knowing
// them.
//
// A frame is split into smooth patches (normals that turn slowly); patches are joined where they
// meet convexly, as the faces of one box do, and kept apart where they meet concavely, as two boxes
// do that stand on each other (Stein et al., Object partitioning using local convexity, CVPR 2014);
// what a nearer thing cuts in two is joined again if its surface goes on behind it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "hyselam_objects/organised_cloud.hpp"

namespace hyselam_objects {

struct SegmentParams {
  int reduce = 2;                ///< the work is done on every n-th row and column, 1 .. 8
  double noise_floor = 0.0012;   ///< standard deviation of a depth at 0.4 m [m] ...
  double noise_growth = 0.0019;  ///< ... and what is added per (depth - 0.4 m)^2 [m]
  int normal_window = 4;         ///< half side of the window of a normal [reduced pixel], 1 .. 20
  double smooth_angle = 0.14;    ///< neighbours of one patch differ by less [rad]
  double flat = 0.018;           ///< patches grow where the surface variation is smaller, 0 .. 1/3
  double support_distance = 0.007;  ///< what is nearer to the support belongs to it [m], + noise
  double tallest = 0.6;             ///< above the support [m]
  double convex_share = 0.55;       ///< of a common border that must be convex to join two patches
  double concave_tolerance = 0.17;  ///< a border that bends inwards by less counts as flat [rad]
  double step = 0.007;              ///< faces that meet miss each other by less [m]
  double meeting_share = 0.2;       ///< of a border on which two patches must meet to be joined
  double border_share = 0.35;  ///< length of that part over the root of the smaller patch's size
  double hollow = 0.05;        ///< the inside of a cup turns by more over some pixels [rad]
  double hollow_share = 0.5;   ///< of its lower edge that hides behind the cup's outside
  double bridge_length = 0.3;  ///< longest way behind an occluder [m]
  double bridge_angle = 0.35;  ///< surfaces on both sides of an occluder differ by less [rad]
  double bridge_distance = 0.012;  ///< ... and continue each other within this [m]
  int smallest = 40;               ///< objects have at least so many reduced pixels
  int splinter = 120;              ///< smaller pieces join what surrounds them [reduced pixel]
  double splinter_gap = 0.08;      ///< ... within this distance [m]
  std::uint64_t seed = 1;          ///< of the search for the support plane
};

/// A plane normal . p = distance, |normal| = 1; the normal points to the camera.
struct Plane {
  Eigen::Vector3f normal{0.0f, 0.0f, -1.0f};
  float distance = 0.0f;
  float heightOf(const Point& p) const { return normal.dot(p) - distance; }
};

struct Segmentation {
  /// Of each point: 0 no measurement, 1 support and background, 2 ... objects. Objects are numbered
  /// from the nearest to the camera on.
  std::vector<std::uint32_t> labels;
  std::uint32_t objects = 0;     ///< labels 2 .. objects + 1 are in use
  std::optional<Plane> support;  ///< nothing: no plane was found, everything is background
};

/// Throws hyselam::InputError for a cloud whose sizes do not fit together or that is larger than 50
/// million points.
void checkCloud(const OrganisedCloud& cloud);

/// Throws as checkCloud(), and hyselam::ParameterError for a parameter out of range.
void checkSegment(const OrganisedCloud& cloud, const SegmentParams& params);

/// Segments one frame. The same arguments give the same labels. Throws as checkSegment().
Segmentation segmentCloud(const OrganisedCloud& cloud, const SegmentParams& params = {});

}  // namespace hyselam_objects
