// By how much two path segments are turned to each other: what is around both, in rings and
// sectors, laid over each other at all turns.
#pragma once

#include <vector>

#include "hyselam_scan_matching/surface_points.hpp"

namespace ngram_slam {

/// The likeliest turns of `newer` relative to `older`, likeliest first, at most `count`; [rad].
/// Both are points around the origin of their frames, about evenly spaced.
std::vector<double> likelyTurns(const hyselam_scan_matching::SurfacePoints& older,
                                const hyselam_scan_matching::SurfacePoints& newer,
                                std::size_t count);

}  // namespace ngram_slam
