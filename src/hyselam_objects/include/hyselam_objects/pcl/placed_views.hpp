// Views of a camera in PCD files, with the poses of it in a file of the TUM format.
#pragma once

#include <string>
#include <vector>

#include "hyselam_objects/segmentation/placed_view.hpp"

namespace hyselam_objects {

/// `poses`: of each view, in their order, a line "stamp x y z qx qy qz qw" [m]; # begins a comment.
/// @throws hyselam::InputError as readPcd(); for a line that is no pose, and if there are not as
///         many poses as files.
std::vector<PlacedView> readPlacedViews(const std::vector<std::string>& files,
                                        const std::string& poses);

}  // namespace hyselam_objects
