// Where to look for places seen before: by the poses and what the graph knows about them.
#pragma once

#include <vector>

#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// The shortest way through the graph from one keyframe to all others [m]: along odometry as far as
/// the robot drove, through a loop for `loop_way`. What lies at the end of a long way is known
/// badly. Infinite for keyframes of another part.
class GraphWays {
 public:
  /// Edges may come one by one; both directions are open.
  void add(int a, int b, double way);
  std::vector<double> from(int keyframe) const;
  int keyframes() const { return static_cast<int>(ways_.size()); }
  void clear() { ways_.clear(); }

 private:
  struct Way {
    int to;
    float length;
  };
  std::vector<std::vector<Way>> ways_;
};

struct LoopCandidate {
  int older = 0;
  double window = 0.0;  ///< how uncertain its position is, seen from the newer keyframe [m]
  double turn = 0.0;    ///< and its heading [rad]
};

/// The nearest keyframe of each stretch of the old way that may be where `keyframe` is, nearest
/// first. `ways`: GraphWays::from(keyframe).
std::vector<LoopCandidate> loopCandidates(const std::vector<SlamKeyframe>& keyframes, int keyframe,
                                          const std::vector<double>& ways,
                                          const LoopParams& params);

/// How much two loops contradict each other: what the one says about the other's pose, by the poses
/// between their ends.
struct LoopContradiction {
  double way = 0.0;       ///< between both ends, along the poses driven [m]
  double distance = 0.0;  ///< [m]
  double turn = 0.0;      ///< [rad], >= 0
};
LoopContradiction contradiction(const SlamLoop& a, const SlamLoop& b,
                                const std::vector<SlamKeyframe>& keyframes);

/// Of the loops in `others`, those that agree with `loop`.
std::vector<std::size_t> agreeing(const SlamLoop& loop, const std::vector<SlamLoop>& others,
                                  const std::vector<SlamKeyframe>& keyframes,
                                  const LoopParams& params);

}  // namespace ngram_slam
