#include "graph_blocks.hpp"

namespace hyselam_pose_graph {

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
__attribute__((flatten, target_clones("avx2", "default")))
#endif
bool
factorPoses(BlockCholesky<Block3>* matrix) {
  return matrix->factor();
}

}  // namespace hyselam_pose_graph
