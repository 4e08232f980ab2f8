#include "hyselam_common/utf8.hpp"

namespace hyselam {
namespace {

constexpr std::size_t kMaxWordBytes = 1000;

}  // namespace

std::size_t utf8CharacterAt(const std::string& bytes, std::size_t i, std::uint32_t* code) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(bytes[k]); };
  const unsigned char first = byte(i);
  std::size_t length = 1;
  *code = first;
  if (first >= 0xf0 && first < 0xf5) {
    length = 4;
    *code = first & 0x07u;
  } else if (first >= 0xe0 && first < 0xf0) {
    length = 3;
    *code = first & 0x0fu;
  } else if (first >= 0xc2 && first < 0xe0) {
    length = 2;
    *code = first & 0x1fu;
  } else if (first >= 0x80) {
    return 0;
  }
  if (i + length > bytes.size()) return 0;
  for (std::size_t k = i + 1; k < i + length; ++k) {
    if ((byte(k) & 0xc0u) != 0x80u) return 0;
    *code = *code << 6 | (byte(k) & 0x3fu);
  }
  const bool overlong = (length == 3 && *code < 0x800) || (length == 4 && *code < 0x10000);
  const bool surrogate = *code >= 0xd800 && *code < 0xe000;
  return overlong || surrogate || *code > 0x10ffff ? 0 : length;
}

bool isUtf8(const std::string& bytes) {
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < bytes.size();) {
    const std::size_t length = utf8CharacterAt(bytes, i, &code);
    if (length == 0) return false;
    i += length;
  }
  return true;
}

std::string wordError(const std::string& word) {
  if (word.empty()) return "is empty";
  if (word.size() > kMaxWordBytes) {
    return "is longer than " + std::to_string(kMaxWordBytes) + " bytes";
  }
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < word.size();) {
    const std::size_t length = utf8CharacterAt(word, i, &code);
    if (length == 0) return "is not UTF-8";
    if (code < 0x20 || (code >= 0x7f && code < 0xa0)) return "holds a control character";
    // XML cannot carry these two.
    if (code == 0xfffe || code == 0xffff) return "holds a character that is none";
    i += length;
  }
  return "";
}

}  // namespace hyselam
