// How two patches of a frame lie to each other: where they touch, and where one goes on beyond
// something nearer that hides what is between them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "patches.hpp"

namespace hyselam_objects {

constexpr std::size_t kContactFeatureCount = 11, kBridgeFeatureCount = 15;

/// A feature of a relation.
struct RelationFeature {
  const char* name;
  bool of_color;  ///< it needs colors
};
extern const std::array<RelationFeature, kContactFeatureCount> kContactFeatures;
extern const std::array<RelationFeature, kBridgeFeatureCount> kBridgeFeatures;

/// What is seen of two patches, `first < second`. Means are 0 where nothing was seen.
struct PatchRelation {
  int first = 0, second = 0;
  int smaller = 0;  ///< size of the smaller one [pixel]

  // Pixels of the first beside pixels of the second:
  int border = 0;              ///< on one surface, no jump in depth
  int jumps = 0;               ///< with a jump in depth
  int convex = 0;              ///< of `border`: the surfaces meet, bent outwards or hardly at all
  int concave = 0;             ///< of `border`: they meet, bent inwards
  float turn = 0.0f;           ///< where they meet: mean angle of the normals, < 0: inwards [rad]
  float border_chroma = 0.0f;  ///< of `border`: mean difference of color without lightness

  // Rows and columns of the image in which one ends and the other begins further on:
  int hidden = 0;          ///< all that is seen between is nearer than the line between them
  int seen_through = 0;    ///< something between is farther
  int continued = 0;       ///< of `hidden`: one goes on in the surface of the other
  float angle = 0.0f;      ///< of `hidden`: mean angle between the normals [rad]
  float offset = 0.0f;     ///< of `hidden`: mean distance from the other's plane [tolerance]
  float gap = 0.0f;        ///< of `hidden`: mean distance [m]
  float gap_ratio = 0.0f;  ///< `gap` over the shorter of the two, in the direction of the gap
  float outline = 0.0f;    ///< overlap (IoU) of their widths across the direction of the gap

  // Bhattacharyya distance of their colors, 0 if not known: of lightness and of what is left.
  float lightness = 0.0f, chroma = 0.0f;

  bool is_hollow = false;  ///< one is the inside of a cup or bowl, the other its outside

  bool touches() const { return convex + concave >= 3; }
  bool isBridged() const { return hidden >= 3; }
  std::array<float, kContactFeatureCount> contactFeatures() const;
  std::array<float, kBridgeFeatureCount> bridgeFeatures() const;
};

/// Relations of all pairs that touch, face each other or are one hollow thing, ordered by (first,
/// second).
std::vector<PatchRelation> relatePatches(const SurfaceGrid& grid, const Patches& patches,
                                         const SegmentParams& params);

}  // namespace hyselam_objects
