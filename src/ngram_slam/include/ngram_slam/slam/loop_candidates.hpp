// Candidates for loop closures by the poses and their uncertainty in the graph; consistency between
// loops.
#pragma once

#include <utility>
#include <vector>

#include "ngram_slam/slam/run_connections.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// The length of the shortest path through the graph from one keyframe to all others [m]: along
/// odometry as far as the robot drove, through a loop for `LoopParams::loop_path_length`. The
/// longer the path, the more uncertain the relative pose. Infinite for keyframes of another part.
class GraphPathLengths {
 public:
  /// Adds an undirected edge.
  void addEdge(int a, int b, double length);
  std::vector<double> from(int keyframe) const;
  /// The same for the `wanted` keyframes only: what the others have is not used. Ends when these
  /// are known, which is soon where they are near.
  std::vector<double> from(int keyframe, const std::vector<int>& wanted) const;
  /// The keyframes that are no farther than `max_length` [m], with their lengths, by number.
  std::vector<std::pair<int, double>> within(int keyframe, double max_length) const;
  int keyframes() const { return static_cast<int>(edges_.size()); }
  void clear() { edges_.clear(); }

 private:
  struct Edge {
    int to;
    float length;
  };
  std::vector<double> search(int keyframe, const std::vector<int>* wanted) const;

  std::vector<std::vector<Edge>> edges_;
};

/// The keyframes before `keyframe` that may become candidates by where they are: loopCandidates()
/// asks for the path lengths of no others.
std::vector<int> keyframesInReach(const std::vector<SlamKeyframe>& keyframes, int keyframe,
                                  const LoopParams& params);

/// An older keyframe that may show the same place.
struct LoopCandidate {
  int older = 0;
  double position_uncertainty = 0.0;  ///< relative to the newer keyframe [m]
  double heading_uncertainty = 0.0;   ///< [rad]
};

/// The nearest keyframe of each segment of the old path that may be where `keyframe` is, nearest
/// first. `path_lengths`: GraphPathLengths::from(keyframe), of those in reach at least.
std::vector<LoopCandidate> loopCandidates(const std::vector<SlamKeyframe>& keyframes, int keyframe,
                                          const std::vector<double>& path_lengths,
                                          const LoopParams& params);

/// Whether two loops lie between the same keyframes.
bool isSamePair(const SlamLoop& a, const SlamLoop& b);

/// How much two loops contradict each other: the pose of the one as predicted from the other and
/// the poses between their ends.
struct LoopInconsistency {
  /// Between both ends, along the path or, from one run of a map to another, straight [m];
  /// infinite: other maps.
  double path_length = 0.0;
  double distance = 0.0;  ///< [m]
  double angle = 0.0;     ///< [rad], >= 0
};
LoopInconsistency loopInconsistency(const SlamLoop& a, const SlamLoop& b,
                                    const std::vector<SlamKeyframe>& keyframes,
                                    const RunConnections& connections);

/// Whether two loops cannot both be right, even if odometry between them is as bad as it may be.
bool isContradiction(const LoopInconsistency& inconsistency, const LoopParams& params);

/// The indices of the loops in `others` that are consistent with `loop`.
std::vector<std::size_t> consistentLoops(const SlamLoop& loop, const std::vector<SlamLoop>& others,
                                         const std::vector<SlamKeyframe>& keyframes,
                                         const RunConnections& connections,
                                         const LoopParams& params);

/// What the loops close to one along the newer path say of it: in a building that repeats itself
/// they find several places, of which at most one is right.
struct LoopCompany {
  double support = 0.0;        ///< sum of the inlier ratios of those that agree, its own included
  double contradiction = 0.0;  ///< and of those that cannot be right if it is
  bool isTrusted(const LoopParams& params) const {
    return contradiction < params.max_contradiction * support;
  }
};
LoopCompany companyOf(const SlamLoop& loop, const std::vector<SlamLoop>& others,
                      const std::vector<SlamKeyframe>& keyframes, const RunConnections& connections,
                      const LoopParams& params);

}  // namespace ngram_slam
