// What the reader and the writer of the XML format agree on.
#pragma once

namespace hyselam_topo {
namespace xml_format {

constexpr char kNamespace[] = "urn:hyselam:topological_map:1";
constexpr int kVersion = 1;
constexpr char kPacking[] = "zlib+base64";

}  // namespace xml_format
}  // namespace hyselam_topo
