// The checksum of all files of the stack: CRC-32, as zlib has it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace hyselam {

/// `before`: the checksum of what goes before these bytes.
std::uint32_t crc32Of(std::string_view bytes, std::uint32_t before = 0);

/// In eight hexadecimal digits.
std::string crc32Text(std::string_view bytes);

}  // namespace hyselam
