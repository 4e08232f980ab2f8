// Numbers as bytes, little-endian, with checksums.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

#include "hyselam_common/checksum.hpp"

namespace ngram_slam {

template <typename T>
using Bits = std::conditional_t<
    sizeof(T) == 8, std::uint64_t,
    std::conditional_t<sizeof(T) == 4, std::uint32_t,
                       std::conditional_t<sizeof(T) == 2, std::uint16_t, std::uint8_t>>>;

/// Puts numbers into a stream and sums them up.
class Writer {
 public:
  explicit Writer(std::ostream& out) : out_(out) {}
  template <typename T>
  void put(T value) {
    Bits<T> bits;
    std::memcpy(&bits, &value, sizeof(bits));
    for (std::size_t i = 0; i < sizeof(bits); ++i)
      buffer_.push_back(static_cast<char>(static_cast<std::uint64_t>(bits) >> 8 * i & 0xff));
    if (buffer_.size() >= kChunk) flush();
  }
  template <typename Values>
  void putAll(const Values& values) {
    for (std::size_t i = 0; i < values.size(); ++i) put(values[i]);
  }
  void putText(const char* text, std::size_t n) { buffer_.append(text, n); }
  void putChecksum() {
    flush();
    const std::uint32_t sum = crc_;
    put(sum);
    flush();
    crc_ = 0;
  }

 private:
  static constexpr std::size_t kChunk = 1 << 18;
  void flush() {
    crc_ = hyselam::crc32Of(buffer_, crc_);
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  std::ostream& out_;
  std::string buffer_;
  std::uint32_t crc_ = 0;
};

/// Takes numbers out of text whose length has been checked.
class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}
  template <typename T>
  T get() {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(text_[at_ + i])) << 8 * i;
    at_ += sizeof(T);
    const auto narrow = static_cast<Bits<T>>(bits);
    T value;
    std::memcpy(&value, &narrow, sizeof(value));
    return value;
  }
  template <typename Values>
  void getAll(Values& values, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) values.push_back(get<std::decay_t<decltype(values[0])>>());
  }
  void skip(std::size_t n) { at_ += n; }
  std::size_t at() const { return at_; }

 private:
  const std::string& text_;
  std::size_t at_ = 0;
};

inline std::uint32_t checksum(const std::string& text, std::size_t begin, std::size_t end) {
  return hyselam::crc32Of({text.data() + begin, end - begin});
}

}  // namespace ngram_slam
