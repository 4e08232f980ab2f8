// Built where Ceres is not.
#include "peer.hpp"

namespace pose_graph_bench {

std::vector<PeerRun> runCeres(const hyselam_pose_graph::PoseGraph&) {
  return {};
}

}  // namespace pose_graph_bench
