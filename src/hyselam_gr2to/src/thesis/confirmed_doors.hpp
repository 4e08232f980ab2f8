// Doors of the thesis' pipeline (section 4.2): which candidates are doors, and their lines between
// the places.
#pragma once

#include <vector>

#include "hyselam_gr2to/map_builder/doors.hpp"
#include "hyselam_gr2to/thesis/thesis.hpp"

namespace hyselam_topo {

/// The borders between the places: confirmed doors where they were closed, the others virtual. In
/// the order of their places.
std::vector<DoorLine> doorLines(const hyselam::OccupancyGrid& grid, const cv::Mat& labels,
                                const std::vector<ConfirmedDoor>& doors,
                                const ThesisParams& params);

}  // namespace hyselam_topo
