#include "hyselam_conversation/example_map.hpp"

#include "hyselam_topological_map/topological_map_xml.hpp"
#include "shipped_maps.hpp"

namespace hyselam_conversation {

hyselam_topo::AugmentedTopologicalMap exampleMap() {
  return hyselam_topo::fromXml(kShippedMaps[0].text, "the example's map");
}

}  // namespace hyselam_conversation
