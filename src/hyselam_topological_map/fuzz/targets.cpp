#include <string>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace hyselam_topo {
namespace {

using hyselam::testing::require;
using hyselam::testing::textOf;

/// Small, so that a bomb shows as a crash of the fuzzer's memory limit.
MapXmlLimits limits() {
  MapXmlLimits limits;
  limits.max_bytes = 1u << 20;
  limits.max_grid_cells = 1u << 20;
  limits.max_appearance_values = 1u << 20;
  return limits;
}

/// XML of a topological map: the same.
void mapXml(const std::uint8_t* data, std::size_t size) {
  const std::string text = textOf(data, size);
  AugmentedTopologicalMap map;
  try {
    map = fromXml(text, "fuzz", limits());
  } catch (const hyselam::InputError&) {
    return;
  }
  checkMap(map, "read");
  // Extras may hold XML that is written otherwise; everything else must stay.
  try {
    const AugmentedTopologicalMap again = fromXml(toXml(map));
    require(again.places.size() == map.places.size() && again.edges == map.edges &&
            again.grid == map.grid);
  } catch (const hyselam::InputError&) {
  }
}

}  // namespace
}  // namespace hyselam_topo

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace hyselam_topo;  // NOLINT: its own targets
  return {{"mapXml", mapXml}};
}
