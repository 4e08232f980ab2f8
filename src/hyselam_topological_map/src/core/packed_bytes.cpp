#include "packed_bytes.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace {

constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr unsigned char kNoDigit = 255;
using Bytes = std::vector<unsigned char>;

const std::array<unsigned char, 256>& digitValues() {
  static const std::array<unsigned char, 256> table = [] {
    std::array<unsigned char, 256> values{};
    values.fill(kNoDigit);
    for (unsigned char i = 0; i < 64; ++i) values[static_cast<unsigned char>(kDigits[i])] = i;
    return values;
  }();
  return table;
}

std::string toBase64(const Bytes& bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return text;
}

Bytes fromBase64(const char* text) {
  const auto& values = digitValues();
  Bytes bytes;
  std::uint32_t group = 0;
  int digits = 0, padding = 0;
  for (; *text != '\0'; ++text) {
    const char c = *text;
    if (c == ' ' || c == '\t' || c == '\n' || c == '\r') continue;
    if (c == '=') {
      ++padding;
      group <<= 6;
    } else {
      const unsigned char value = values[static_cast<unsigned char>(c)];
      if (value == kNoDigit || padding > 0) throw hyselam::Error("this is no base64");
      group = group << 6 | value;
    }
    if (++digits == 4) {
      if (padding > 2) throw hyselam::Error("this is no base64");
      for (int k = 0; k < 3 - padding; ++k) {
        bytes.push_back(static_cast<unsigned char>(group >> (16 - 8 * k) & 255u));
      }
      group = 0;
      digits = 0;
    }
  }
  if (digits != 0) throw hyselam::Error("the base64 text is cut off");
  return bytes;
}

std::string packBytes(const Bytes& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  Bytes packed(size);
  // A compressor that fails has no memory: compressBound() is always enough.
  if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 6) != Z_OK) {
    throw std::bad_alloc();
  }
  packed.resize(size);
  return toBase64(packed);
}

Bytes unpackBytes(const char* text, std::size_t size) {
  const Bytes packed = fromBase64(text);
  // Deflate gains at most a factor of about 1032: less text cannot fill the values.
  if (packed.size() < size / 1100) throw hyselam::Error("the packed data are too short");
  Bytes bytes(size + 1);  // one more, to see what is too long
  uLongf got = static_cast<uLongf>(bytes.size());
  const int status =
      uncompress(bytes.data(), &got, packed.data(), static_cast<uLong>(packed.size()));
  if (status == Z_BUF_ERROR && got == bytes.size()) {
    throw hyselam::Error("there are more packed data than the sizes say");
  }
  if (status != Z_OK) throw hyselam::Error("the packed data are damaged");
  if (got != size) {
    throw hyselam::Error(got < size ? "the packed data are too short"
                                    : "there are more packed data than the sizes say");
  }
  bytes.pop_back();
  return bytes;
}

template <typename Word, typename T>
Bytes littleEndian(const std::vector<T>& values) {
  static_assert(sizeof(Word) == sizeof(T), "one word per value");
  Bytes bytes(values.size() * sizeof(Word));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Word word;
    std::memcpy(&word, &values[i], sizeof word);
    for (std::size_t k = 0; k < sizeof(Word); ++k) {
      bytes[i * sizeof(Word) + k] = static_cast<unsigned char>(word >> (8 * k) & 255u);
    }
  }
  return bytes;
}

template <typename Word, typename T>
std::vector<T> fromLittleEndian(const Bytes& bytes) {
  std::vector<T> values(bytes.size() / sizeof(Word));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Word word = 0;
    for (std::size_t k = sizeof(Word); k-- > 0;) {
      word = static_cast<Word>(static_cast<std::uint64_t>(word) << 8 | bytes[i * sizeof(Word) + k]);
    }
    std::memcpy(&values[i], &word, sizeof word);
  }
  return values;
}

}  // namespace

std::string pack(const std::vector<std::uint16_t>& values) {
  return packBytes(littleEndian<std::uint16_t>(values));
}

std::string pack(const std::vector<float>& values) {
  return packBytes(littleEndian<std::uint32_t>(values));
}

std::vector<std::uint16_t> unpackShorts(const char* text, std::size_t count) {
  return fromLittleEndian<std::uint16_t, std::uint16_t>(unpackBytes(text, 2 * count));
}

std::vector<float> unpackFloats(const char* text, std::size_t count) {
  return fromLittleEndian<std::uint32_t, float>(unpackBytes(text, 4 * count));
}

}  // namespace hyselam_topo
