// A model of a thing from several views of it, as it stands alone on a level surface.
#pragma once

#include <vector>

#include "hyselam_objects/segmentation/placed_view.hpp"
#include "hyselam_objects/segmentation/segment_cloud.hpp"

namespace hyselam_objects {

/// The surface of a thing, as it was seen.
struct SurfaceModel {
  OrganizedCloud cloud;  ///< in any frame, also of one row
  /// Where the camera was that saw each point, view by view; empty: all from the origin.
  std::vector<Point> seen_from;
};

/// What stands on the surface in all views, one after the other, in the frame of the surface: a
/// cloud of one row, with colors if all views have them. z of the views' frame is up.
/// @throws hyselam::InputError without a view, for one that shows nothing on a level surface, and
///         as segmentCloud(); hyselam::ParameterError.
SurfaceModel learnModel(const std::vector<PlacedView>& views, const SegmentParams& params = {});

}  // namespace hyselam_objects
