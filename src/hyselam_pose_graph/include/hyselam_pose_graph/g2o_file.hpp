// Pose graphs in g2o's text format.
#pragma once

#include <string>

#include "hyselam_pose_graph/pose_graph.hpp"

namespace hyselam_pose_graph {

/// Reads VERTEX_SE2, EDGE_SE2 and FIX lines (FIX is accepted and has no effect: the first pose of
/// each connected component is fixed), plain or gzip; '#' begins a comment. Poses are ordered by
/// id. Poses named only by edges are added and, when no VERTEX_SE2 is given at all, composed along
/// the edges.
/// @throws hyselam::InputError naming file and line for anything else in the file, an id given
/// twice, numbers that are malformed or not finite, an edge from a pose to itself, information that
/// is not positive semidefinite; and for a file without any pose.
PoseGraph readG2o(const std::string& path);

/// Writes all poses and edges with 15 digits; atomic.
/// @throws hyselam::InputError when the place cannot be written.
void writeG2o(const std::string& path, const PoseGraph& graph);

}  // namespace hyselam_pose_graph
