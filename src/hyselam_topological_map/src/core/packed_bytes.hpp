// Numbers as text for XML: little-endian bytes, deflated (zlib), in base64.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hyselam_topo {

std::string pack(const std::vector<std::uint16_t>& values);
std::string pack(const std::vector<float>& values);

/// Exactly `count` values. White space in the text is passed over. Throws hyselam::Error
/// with the reason if the text is no base64, the data are damaged, too short or too long; never
/// takes more memory than the values need.
std::vector<std::uint16_t> unpackShorts(const char* text, std::size_t count);
std::vector<float> unpackFloats(const char* text, std::size_t count);

}  // namespace hyselam_topo
