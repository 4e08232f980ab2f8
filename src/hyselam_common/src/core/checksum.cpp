#include "hyselam_common/checksum.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstdio>

namespace hyselam {

std::uint32_t crc32Of(std::string_view bytes, std::uint32_t before) {
  constexpr std::size_t kPiece = std::size_t{1} << 30;  // zlib counts in unsigned int
  uLong crc = before;
  while (!bytes.empty()) {
    const std::size_t n = std::min(bytes.size(), kPiece);
    crc = crc32(crc, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(n));
    bytes.remove_prefix(n);
  }
  return static_cast<std::uint32_t>(crc);
}

std::string crc32Text(std::string_view bytes) {
  char text[16];
  std::snprintf(text, sizeof text, "%08lx", static_cast<unsigned long>(crc32Of(bytes)));
  return text;
}

}  // namespace hyselam
