#include <stdexcept>

#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

void SlamState::validate() const {
  const auto demand = [](bool holds, const char* complaint) {
    if (!holds) throw std::invalid_argument(complaint);
  };
  const auto n = static_cast<int>(keyframes.size());
  const auto known = [n](int k) { return k >= 0 && k < n; };
  for (const SlamKeyframe& k : keyframes)
    demand(k.scan && k.points && k.pose.isFinite() && k.odometry.isFinite(),
           "a keyframe lacks its scan or pose");
  for (const PlacedScan& p : scans) demand(known(p.keyframe), "a scan has no keyframe");
  for (const hyselam_pose_graph::PoseEdge& e : odometry)
    demand(known(e.from) && known(e.to) && e.from != e.to, "an edge lacks its keyframes");
  for (const auto* some : {&loops, &waiting})
    for (const SlamLoop& l : *some)
      demand(known(l.older) && known(l.newer) && l.older != l.newer, "a loop lacks its keyframes");
  const std::size_t observations = corpus.observations.size();
  for (const SlamMatch& m : matches)
    demand(known(m.keyframe_newer) && known(m.keyframe_older) && m.newer < observations &&
               m.older < observations,
           "a match lacks its keyframes or observations");
  for (const std::int32_t k : keyframe_of_observation)
    demand(known(k), "an observation has no keyframe");
  demand(keyframe_of_observation.size() == observations,
         "observations and their keyframes differ in number");
}

}  // namespace ngram_slam
