#include "hyselam_gr2to/segmentation/border_model.hpp"
#include "shipped_border_trees.hpp"

namespace hyselam_topo {

const BorderModel& BorderModel::shipped() {
  static const BorderModel model = fromText(kShippedBorderTrees[0].text, "shipped border trees");
  return model;
}

}  // namespace hyselam_topo
