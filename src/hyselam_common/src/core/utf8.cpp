#include "hyselam_common/utf8.hpp"

#include <algorithm>

namespace hyselam {
namespace {

constexpr std::size_t kMaxWordBytes = 1000;

// Base letters of U+00DF .. U+00FF ('*': see below) and of U+0100 .. U+017F.
constexpr char kLatin1[] = "*aaaaaa*ceeeeiiiidnooooo*ouuuuy*y";
constexpr char kLatinExtended[] =
    "aaaaaa"
    "cccccccc"
    "dddd"
    "eeeeeeeeee"
    "gggggggg"
    "hhhh"
    "iiiiiiiiii"
    "iijjkkk"
    "llllllllll"
    "nnnnnnnnn"
    "oooooooo"
    "rrrrrr"
    "ssssssss"
    "tttttt"
    "uuuuuuuuuuuu"
    "wwyyyzzzzzzs";
static_assert(sizeof kLatin1 == 0x100 - 0xdf + 1 && sizeof kLatinExtended == 0x80 + 1,
              "one letter for each");

std::uint32_t lower(std::uint32_t c) {
  if (c < 0x80) return c >= 'A' && c <= 'Z' ? c + 32 : c;
  if (c >= 0xc0 && c <= 0xde && c != 0xd7) return c + 32;
  if (c == 0x178) return 0xff;
  if ((c >= 0x100 && c <= 0x137) || (c >= 0x14a && c <= 0x177)) return c | 1u;
  if ((c >= 0x139 && c <= 0x148) || (c >= 0x179 && c <= 0x17e)) return c % 2 == 1 ? c + 1 : c;
  if (c >= 0x391 && c <= 0x3a9) return c + 32;
  if (c >= 0x410 && c <= 0x42f) return c + 32;
  if (c >= 0x400 && c <= 0x40f) return c + 80;
  if (c == 0x2019 || c == 0x2018 || c == 0x02bc || c == 0x00b4) return '\'';
  if (c >= 0x2010 && c <= 0x2015) return '-';
  return c;
}

void append(std::uint32_t c, std::string* out) {
  if (c < 0x80) {
    *out += static_cast<char>(c);
  } else if (c < 0x800) {
    *out += static_cast<char>(0xc0u | c >> 6);
    *out += static_cast<char>(0x80u | (c & 0x3fu));
  } else if (c < 0x10000) {
    *out += static_cast<char>(0xe0u | c >> 12);
    *out += static_cast<char>(0x80u | (c >> 6 & 0x3fu));
    *out += static_cast<char>(0x80u | (c & 0x3fu));
  } else {
    *out += static_cast<char>(0xf0u | c >> 18);
    *out += static_cast<char>(0x80u | (c >> 12 & 0x3fu));
    *out += static_cast<char>(0x80u | (c >> 6 & 0x3fu));
    *out += static_cast<char>(0x80u | (c & 0x3fu));
  }
}

void appendFolded(std::uint32_t c, std::string* out) {
  if (c >= 0x300 && c <= 0x36f) return;  // accents on their own
  if (c == 0xdf) {
    *out += "ss";
  } else if (c == 0xe6) {
    *out += "ae";
  } else if (c == 0xfe) {
    *out += "th";
  } else if (c > 0xdf && c <= 0xff && c != 0xf7) {
    *out += kLatin1[c - 0xdf];
  } else if (c >= 0x100 && c <= 0x17f) {
    *out += kLatinExtended[c - 0x100];
  } else if (c == 0xb2 || c == 0xb3) {
    *out += static_cast<char>('0' + (c - 0xb0));
  } else {
    append(c, out);
  }
}

template <typename Append>
std::string mapCharacters(const std::string& text, Append&& append_one) {
  std::string out;
  out.reserve(text.size());
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8CharacterAt(text, i, &code);
    if (length > 0) append_one(lower(code), &out);
    i += std::max<std::size_t>(length, 1);
  }
  return out;
}

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

bool isUnicodeSpace(std::uint32_t c) {
  return c <= 0x20 || c == 0x7f || c == 0xa0 || c == 0x85 || (c >= 0x2000 && c <= 0x200b) ||
         c == 0x2028 || c == 0x2029 || c == 0x202f || c == 0x3000 || c == 0xfeff;
}

bool isUnicodeDigit(std::uint32_t c) {
  return c >= '0' && c <= '9';
}

bool isUnicodeLetterOrDigit(std::uint32_t c) {
  if (c < 0x80) return isUnicodeDigit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  if (c < 0xc0) return c == 0xaa || c == 0xba || c == 0xb2 || c == 0xb3;
  if (c == 0xd7 || c == 0xf7) return false;
  // Punctuation, arrows, symbols, pictures.
  if (c >= 0x2000 && c <= 0x2bff) return false;
  if (c >= 0x3000 && c <= 0x303f) return false;
  return c < 0xe000 || (c >= 0xfb00 && c < 0xfe00) || (c >= 0x20000 && c < 0x30000);
}

bool isUnicodeUpper(std::uint32_t c) {
  return isUnicodeLetterOrDigit(c) && lower(c) != c;
}

std::uint32_t utf8CodeAt(const std::string& text, std::size_t i, std::size_t end,
                         std::size_t* length) {
  std::uint32_t code = 0;
  std::size_t bytes = 0;
  if (i < end) {
    bytes = utf8CharacterAt(text, i, &code);
    if (bytes == 0 || i + bytes > end) {
      bytes = 1;
      code = '?';
    }
  }
  if (length != nullptr) *length = bytes;
  return code;
}

std::string singleSpaced(const std::string& text) {
  std::string out;
  std::size_t length = 0;
  bool space = false;
  for (std::size_t i = 0; i < text.size(); i += length) {
    if (isUnicodeSpace(utf8CodeAt(text, i, text.size(), &length))) {
      space = true;
      continue;
    }
    if (space && !out.empty()) out += ' ';
    space = false;
    out.append(text, i, length);
  }
  return out;
}

std::string utf8Lower(const std::string& text) {
  return mapCharacters(text, append);
}
std::string utf8Fold(const std::string& text) {
  return mapCharacters(text, appendFolded);
}

}  // namespace hyselam
