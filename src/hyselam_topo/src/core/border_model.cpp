#include "agglomeration.hpp"

namespace hyselam_topo {

const BoostedTrees& borderModel() {
  static const BoostedTrees model(
      {
#include "border_model_nodes.inc"
      },
      {
#include "border_model_roots.inc"
      });
  return model;
}

}  // namespace hyselam_topo
