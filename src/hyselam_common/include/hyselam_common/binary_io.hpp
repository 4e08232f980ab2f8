// Numbers as bytes, little-endian on every machine, with checksums (CRC-32).
#pragma once

#include <cstdint>
#include <cstring>
#include <ostream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam {

/// The unsigned integer with as many bits as T.
template <typename T>
using BitsOf = std::conditional_t<
    sizeof(T) == 8, std::uint64_t,
    std::conditional_t<sizeof(T) == 4, std::uint32_t,
                       std::conditional_t<sizeof(T) == 2, std::uint16_t, std::uint8_t>>>;

/// Writes numbers to a stream. Buffered: the stream is complete after flush() or putChecksum(), or
/// when the writer is destroyed.
class BinaryWriter {
 public:
  explicit BinaryWriter(std::ostream& out) : out_(out) {}
  ~BinaryWriter() { flush(); }
  BinaryWriter(const BinaryWriter&) = delete;
  BinaryWriter& operator=(const BinaryWriter&) = delete;

  template <typename T>
  void put(T value) {
    static_assert((std::is_arithmetic_v<T> || std::is_enum_v<T>)&&sizeof(T) <= 8, "numbers only");
    BitsOf<T> bits;
    std::memcpy(&bits, &value, sizeof(bits));
    for (std::size_t i = 0; i < sizeof(bits); ++i) {
      buffer_.push_back(static_cast<char>(static_cast<std::uint64_t>(bits) >> 8 * i & 0xff));
    }
    if (buffer_.size() >= kChunk) flush();
  }
  template <typename Values>
  void putAll(const Values& values) {
    for (std::size_t i = 0; i < values.size(); ++i) put(values[i]);
  }
  /// The number of values as 64 bits, then the values.
  template <typename Values>
  void putSized(const Values& values) {
    put(static_cast<std::uint64_t>(values.size()));
    putAll(values);
  }
  void putText(const char* text, std::size_t n) { buffer_.append(text, n); }
  void putText(std::string_view text) { buffer_.append(text); }
  /// The checksum of all bytes since the last one.
  void putChecksum() {
    flush();
    const std::uint32_t sum = crc_;
    put(sum);
    flush();
    crc_ = 0;
  }
  void flush() {
    crc_ = crc32Of(buffer_, crc_);
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }

 private:
  static constexpr std::size_t kChunk = 1 << 18;

  std::ostream& out_;
  std::string buffer_;
  std::uint32_t crc_ = 0;
};

/// Reads what BinaryWriter wrote; `bytes` must outlive the reader.
class BinaryReader {
 public:
  /// `source` names the bytes in errors.
  explicit BinaryReader(std::string_view bytes, std::string source = "binary data")
      : bytes_(bytes), source_(std::move(source)) {}

  /// @throws InputError past the end, as all that read.
  template <typename T>
  T get() {
    static_assert((std::is_arithmetic_v<T> || std::is_enum_v<T>)&&sizeof(T) <= 8, "numbers only");
    require(sizeof(T));
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[at_ + i])) << 8 * i;
    }
    at_ += sizeof(T);
    const auto narrow = static_cast<BitsOf<T>>(bits);
    T value;
    std::memcpy(&value, &narrow, sizeof(value));
    return value;
  }
  /// Appends n values.
  template <typename Values>
  void getAll(Values& values, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) values.push_back(get<std::decay_t<decltype(values[0])>>());
  }
  /// What putSized() wrote; a number of values larger than the rest of the bytes is refused.
  template <typename T>
  std::vector<T> getSized() {
    const auto n = get<std::uint64_t>();
    if (n > left() / sizeof(T)) refuse("ends early");
    std::vector<T> values;
    values.reserve(static_cast<std::size_t>(n));
    getAll(values, static_cast<std::size_t>(n));
    return values;
  }
  void skip(std::size_t n) {
    require(n);
    at_ += n;
  }
  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  /// @throws InputError if bytes are left.
  void requireEnd() const {
    if (left() > 0) refuse("has bytes after its end");
  }

 private:
  void require(std::size_t n) const {
    if (n > left()) refuse("ends early");
  }
  [[noreturn]] void refuse(const std::string& reason) const {
    throw InputError(source_, "byte " + std::to_string(at_), reason);
  }

  std::string_view bytes_;
  std::string source_;
  std::size_t at_ = 0;
};

/// The checksum of bytes begin .. end - 1.
inline std::uint32_t checksumOf(std::string_view bytes, std::size_t begin, std::size_t end) {
  return crc32Of(bytes.substr(begin, end - begin));
}

}  // namespace hyselam
