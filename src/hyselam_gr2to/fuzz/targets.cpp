#include <string>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_gr2to/octomap/octomap_reader.hpp"
#include "hyselam_gr2to/segmentation/border_model.hpp"

namespace hyselam_topo {
namespace {

using hyselam::testing::require;
using hyselam::testing::textOf;

/// The file of an OctoMap, .bt or .ot: refused, or cubes within the space that keys can tell.
void octoMap(const std::uint8_t* data, std::size_t size) {
  constexpr int kEdge = 32768;
  OctoMapLimits few;
  few.max_leaves = 1u << 16;
  VoxelMap map;
  try {
    map = parseOctoMap(textOf(data, size), "fuzz", few);
  } catch (const hyselam::InputError&) {
    return;
  }
  require(map.leaves.size() <= few.max_leaves);
  for (const VoxelLeaf& leaf : map.leaves) {
    require(leaf.size >= 1 && leaf.probability >= 0.0f && leaf.probability <= 1.0f);
    for (const int at : {leaf.x, leaf.y, leaf.z}) require(at >= -kEdge && at + leaf.size <= kEdge);
  }
}

/// The file of a border model: refused, or trees whose text is the same again, and whose odds of
/// any border are found.
void borderTrees(const std::uint8_t* data, std::size_t size) {
  const std::string text = hyselam::testing::withRightChecksum(textOf(data, size));
  try {
    const auto model = hyselam::testing::modelWrittenBack<BorderModel>(text);
    model.oddsOfOnePlace({});
  } catch (const hyselam::InputError&) {
    return;
  }
}

}  // namespace
}  // namespace hyselam_topo

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace hyselam_topo;  // NOLINT: its own targets
  return {{"octoMap", octoMap}, {"borderTrees", borderTrees}};
}
