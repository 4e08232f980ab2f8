// Takes poses out of a pose graph and leaves what they said of the others (marginalization),
// sparse: Kretzschmar and Stachniss 2012 for laser maps, Carlevaris-Bianco et al. 2014 for the
// information of the edges that replace a pose.
//
// The edges are linearized at the given poses. There each is a weight W = J^T Omega J and a force
// f = J^T Omega e on the difference of two small motions in one frame, so that edges in a row add
// up their covariances and poses are taken out as nodes of a network of springs. A pose with n
// neighbors would leave an edge between each two of them; instead its best known neighbor takes its
// place: n - 1 edges, each with the information of the two that it is composed of, which is the
// marginal of these two poses. They carry the forces of the exact marginal of all: the optimum of
// the remaining poses stays where it is. With two neighbors the information is exact as well; with
// more, the error of the best known neighbor's edge, which all the others share, counts in each as
// if it were its own.
#pragma once

#include <vector>

#include "hyselam_pose_graph/pose_graph.hpp"

namespace ngram_slam {

struct ReducedEdge {
  hyselam_pose_graph::PoseEdge edge;  ///< between poses as they were numbered before
  bool odometry = false;              ///< composed of nothing but odometry
};

/// Which edges have an inverse: a pose with another edge cannot be taken out.
bool isInvertible(const hyselam_pose_graph::PoseEdge& edge);

/// The edges that replace those of the `dropped` poses, sorted by their poses, at most one of
/// odometry and one other between two poses. `edges`: all of the graph; those between poses that
/// stay are not looked at. Poses that hang on dropped ones alone are not connected any more.
/// @throws hyselam::InputError for an edge of a dropped pose that is not invertible.
std::vector<ReducedEdge> marginalizedEdges(const std::vector<hyselam::Pose2>& poses,
                                           const std::vector<ReducedEdge>& edges,
                                           const std::vector<bool>& dropped);

/// One edge along several, each from where the one before ends: `path` [edge, whether it is gone
/// along backwards].
struct PathStep {
  hyselam_pose_graph::PoseEdge edge;
  bool backward = false;
};
/// Covariances and errors of the steps add up. @throws hyselam::InputError for an empty path or an
/// edge that is not invertible.
hyselam_pose_graph::PoseEdge composedEdge(const std::vector<hyselam::Pose2>& poses,
                                          const std::vector<PathStep>& path);

/// The mean of edges between the same two poses in the same direction, each weighted by its
/// information. Its own information is that of the strongest: they saw the same surfaces, with the
/// same errors.
hyselam_pose_graph::PoseEdge meanEdge(const std::vector<hyselam::Pose2>& poses,
                                      const std::vector<hyselam_pose_graph::PoseEdge>& edges);

}  // namespace ngram_slam
