// The augmented topological map as XML. The schema is
// share/hyselam_topological_map/xsd/topological_map.xsd.
#pragma once

#include <cstddef>
#include <string>

#include "hyselam_common/xml_document.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// Files beyond these limits are rejected before memory is allocated.
struct MapXmlLimits : hyselam::XmlLimits {
  std::size_t max_grid_cells = std::size_t{1} << 26;  ///< of the place grid
  std::size_t max_appearance_values = 1u << 24;       ///< of one appearance
};

/// The map as UTF-8 text. Equal maps give equal bytes, numbers are written so that they read back
/// exactly. @throws hyselam::InputError for a map that checkMap() refuses, and for extras that are
/// no XML.
std::string toXml(const AugmentedTopologicalMap& map, const std::string& source = "map");

/// The map in a text that toXml() or something else has written: fromXml(toXml(m)) == m for maps
/// that are normalised. Attributes and elements that do not belong to the format are kept as
/// extras, comments outside of them are not. @throws hyselam::InputError, with line and element,
/// for text that is no XML, another format or version, a document type declaration or entities,
/// more than the limits allow, missing or repeated parts, and for a map that checkMap() refuses.
AugmentedTopologicalMap fromXml(const std::string& text, const std::string& source = "map",
                                const MapXmlLimits& limits = {});

/// Writes a file as a whole or not at all. @throws as toXml(), or if the file cannot be written.
void saveXml(const std::string& path, const AugmentedTopologicalMap& map);

/// Reads a file, plain or gzip. @throws as fromXml(), or if the file cannot be read.
AugmentedTopologicalMap loadXml(const std::string& path, const MapXmlLimits& limits = {});

/// The graph for tools such as Gephi, yEd and networkx: one node per place (label, words, kind,
/// area, x, y), one edge per connection (label, doors, width of the widest, real, closed). It
/// cannot be read back. @throws as toXml().
std::string toGraphMl(const AugmentedTopologicalMap& map);

}  // namespace hyselam_topo
