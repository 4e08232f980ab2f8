#include "pgm.hpp"

#include <cctype>
#include <cstdint>
#include <optional>
#include <stdexcept>

namespace hyselam {
namespace {

constexpr unsigned kMaxNumber = 1000000000;

bool isSpace(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

/// Numbers between white space and comments.
class Tokens {
 public:
  Tokens(const std::string& bytes, std::size_t begin) : bytes_(bytes), at_(begin) {}

  std::optional<unsigned> next() {
    skipBlanks();
    std::optional<unsigned> value;
    while (at_ < bytes_.size() && std::isdigit(static_cast<unsigned char>(bytes_[at_])) != 0) {
      value = value.value_or(0) * 10 + static_cast<unsigned>(bytes_[at_++] - '0');
      if (*value > kMaxNumber) return std::nullopt;
    }
    return value;
  }
  std::size_t position() const { return at_; }

 private:
  void skipBlanks() {
    while (at_ < bytes_.size() && (isSpace(bytes_[at_]) || bytes_[at_] == '#')) {
      if (bytes_[at_] == '#') {
        while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
      } else {
        ++at_;
      }
    }
  }

  const std::string& bytes_;
  std::size_t at_;
};

std::uint8_t scaled(unsigned value, unsigned largest) {
  if (value > largest) throw std::runtime_error("holds a pixel above its stated maximum");
  return static_cast<std::uint8_t>((value * 255U + largest / 2U) / largest);
}

}  // namespace

bool isPgm(const std::string& bytes) {
  return bytes.size() > 2 && bytes[0] == 'P' && (bytes[1] == '2' || bytes[1] == '5') &&
         (isSpace(bytes[2]) || bytes[2] == '#');
}

cv::Mat decodePgm(const std::string& bytes, std::size_t max_pixels) {
  Tokens tokens(bytes, 2);
  const auto width = tokens.next(), height = tokens.next(), largest = tokens.next();
  if (!width || !height || !largest || *width == 0 || *height == 0 || *largest == 0 ||
      *largest > 65535) {
    throw std::runtime_error("has a damaged PGM header");
  }
  const std::string size = std::to_string(*width) + " x " + std::to_string(*height) + " pixels";
  const std::size_t pixels = static_cast<std::size_t>(*width) * *height;
  if (pixels > max_pixels) {
    throw std::runtime_error("has " + size + ", more than the limit of " +
                             std::to_string(max_pixels));
  }
  const bool text = bytes[1] == '2';
  const std::size_t depth = *largest > 255 ? 2 : 1;
  const std::size_t begin = tokens.position() + 1;  // one white space ends the header
  const std::size_t left = bytes.size() > begin ? bytes.size() - begin : 0;
  // As text, a pixel and what separates it from the next take two bytes, the last one alone one.
  const std::size_t needed = text ? 2 * pixels - 1 : depth * pixels;
  if (left < needed) throw std::runtime_error("is truncated: " + size + " announced");

  cv::Mat image(static_cast<int>(*height), static_cast<int>(*width), CV_8UC1);
  std::uint8_t* out = image.ptr<std::uint8_t>();
  for (std::size_t i = 0; i < pixels; ++i) {
    if (text) {
      const auto value = tokens.next();
      if (!value) throw std::runtime_error("is truncated or damaged at pixel " + std::to_string(i));
      out[i] = scaled(*value, *largest);
    } else {
      const auto byte = [&](std::size_t k) { return static_cast<std::uint8_t>(bytes[begin + k]); };
      const unsigned value = depth == 1 ? byte(i) : byte(2 * i) * 256U + byte(2 * i + 1);
      out[i] = scaled(value, *largest);
    }
  }
  return image;
}

}  // namespace hyselam
