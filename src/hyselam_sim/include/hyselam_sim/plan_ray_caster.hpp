// Analytic ray casting against segments, found through a uniform grid of buckets.
#pragma once

#include <cstdint>
#include <vector>

#include "hyselam_sim/geometry.hpp"

namespace hyselam_sim {

/// Immutable after construction; all queries may run concurrently.
class PlanRayCaster {
 public:
  /// `bucket_size` [m], > 0: side of a bucket; only speed depends on it.
  explicit PlanRayCaster(std::vector<Segment> segments, double bucket_size = 1.0);

  /// Distance from `origin` along `direction` (unit vector) to the first segment, or `max_range` if
  /// none is nearer. [m]
  double cast(Point2 origin, Point2 direction, double max_range) const;

  const std::vector<Segment>& segments() const { return segments_; }

 private:
  std::vector<Segment> segments_;
  double bucket_size_;
  Point2 min_;
  Point2 max_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint32_t>
      first_;  ///< bucket -> first entry in `entries_`; one more than buckets
  std::vector<std::uint32_t> entries_;  ///< indices into `segments_`
};

/// Distance along the ray to one segment, or infinity. A segment parallel to the ray is not hit.
double hitDistance(Point2 origin, Point2 direction, const Segment& segment);

/// Distance along the ray to a disc (0 from inside it), or infinity.
double hitDistance(Point2 origin, Point2 direction, Point2 center, double radius);

}  // namespace hyselam_sim
