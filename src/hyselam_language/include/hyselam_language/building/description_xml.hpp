// The description of a building as XML. The schema is
// share/hyselam_topo/xsd/description.xsd.
#pragma once

#include <string>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace hyselam_topo {

/// The description as UTF-8 text; equal descriptions give equal bytes, numbers read back exactly.
/// Throws hyselam::InputError for a description that checkDescription() refuses.
std::string toXml(const DescribedBuilding& building, const std::string& source = "description");

/// The description in a text: descriptionFromXml(toXml(d)) == d. Unlike in maps nothing foreign is
/// kept: attributes and elements that do not belong to the format are refused. Throws
/// hyselam::InputError, with line and element, for text that is no XML, another format or version,
/// a document type declaration or entities, more than the limits allow, missing parts, and a
/// description that checkDescription() refuses.
DescribedBuilding descriptionFromXml(const std::string& text,
                                     const std::string& source = "description",
                                     const hyselam::XmlLimits& limits = {});

/// Writes a file as a whole or not at all. Throws as toXml(), or if the file cannot be written.
void saveXml(const std::string& path, const DescribedBuilding& building);

/// Reads a file, plain or gzip. Throws as descriptionFromXml(), or if the file cannot be read.
DescribedBuilding loadDescription(const std::string& path, const hyselam::XmlLimits& limits = {});

}  // namespace hyselam_topo
