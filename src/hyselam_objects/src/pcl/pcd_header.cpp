#include "pcd_header.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <vector>

#include "hyselam_common/errors.hpp"

namespace hyselam_objects {
namespace {

using hyselam::InputError;

constexpr std::uint64_t kMaxPoints = 50000000;

/// In the order of the format. PCL goes by the order as well.
const std::vector<std::string> kKeys{"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                     "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

class HeaderReader {
 public:
  HeaderReader(const std::string& bytes, const std::string& source)
      : bytes_(bytes), source_(source) {}

  PcdHeader check() {
    while (key_ != "DATA") readLine();
    if (fields_.empty()) fail("has no FIELDS");
    if (sizes_.empty() || types_.empty()) fail("has no SIZE or no TYPE");
    if (counts_.empty()) counts_.assign(fields_.size(), 1);
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const bool real = types_[i] == "F";
      if (!real && types_[i] != "I" && types_[i] != "U") fail("knows the TYPEs I, U and F only");
      if (sizes_[i] != 8 && sizes_[i] != 4 && (real || (sizes_[i] != 2 && sizes_[i] != 1))) {
        fail("has a SIZE that no number of its TYPE has");
      }
      if (counts_[i] == 0) fail("has a COUNT of 0");
    }
    if (points_ == 0) fail("announces no points");
    if (points_ > kMaxPoints || width_ > kMaxPoints || height_ > kMaxPoints) {
      fail("announces more than 50 million points");
    }
    if (width_ * height_ != points_ && width_ + height_ != 0) {
      fail("announces POINTS that are not WIDTH times HEIGHT");
    }
    checkData();
    return {at_, points_};
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(source_, "line " + std::to_string(line_), "the PCD header " + reason);
  }

  void readLine() {
    constexpr std::size_t kLongest = 100000;
    ++line_;
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos) fail("ends before DATA");
    const std::string line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (line.size() > kLongest || std::any_of(line.begin(), line.end(), [](unsigned char c) {
          return c < ' ' && c != '\t' && c != '\r';
        })) {
      fail("holds what is no text");
    }
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    if (words.empty() || words[0][0] == '#') return;
    const auto at = std::find(kKeys.begin() + next_key_, kKeys.end(), words[0]);
    if (at == kKeys.end())
      fail("has '" + words[0].substr(0, 40) + "' in a place where it cannot be");
    next_key_ = at - kKeys.begin() + 1;
    key_ = words[0];
    words.erase(words.begin());
    take(words);
  }

  void take(const std::vector<std::string>& words) {
    if (words.empty()) fail("has nothing behind " + key_);
    if (key_ == "FIELDS") fields_ = words;
    if (key_ == "TYPE") types_ = words;
    if (key_ == "SIZE") sizes_ = numbersOf(words);
    if (key_ == "COUNT") counts_ = numbersOf(words);
    const bool many = key_ == "FIELDS" || key_ == "SIZE" || key_ == "TYPE" || key_ == "COUNT";
    if (words.size() != (many ? fields_.size() : key_ == "VIEWPOINT" ? 7 : 1)) {
      fail("has " + std::to_string(words.size()) + " values of " + key_);
    }
    if (key_ == "WIDTH") width_ = numbersOf(words)[0];
    if (key_ == "HEIGHT") height_ = numbersOf(words)[0];
    if (key_ == "POINTS") points_ = numbersOf(words)[0];
    if (key_ == "DATA") data_ = words[0];
  }

  std::vector<std::uint64_t> numbersOf(const std::vector<std::string>& words) const {
    constexpr std::size_t kDigits = 15;
    std::vector<std::uint64_t> numbers;
    for (const std::string& word : words) {
      if (word.size() > kDigits || word.find_first_not_of("0123456789") != std::string::npos) {
        fail("has '" + word.substr(0, 40) + "' behind " + key_ + ", not a whole number");
      }
      numbers.push_back(std::stoull(word));
    }
    return numbers;
  }

  /// What is announced against the bytes that are there.
  void checkData() {
    std::uint64_t point_bytes = 0, values = 0, packed_bytes = 0;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (counts_[i] > kMaxPoints) fail("announces more than a file can hold");
      const std::uint64_t bytes = sizes_[i] * counts_[i];
      point_bytes += bytes;
      values += counts_[i];
      if (fields_[i] != "_") packed_bytes += bytes;  // PCL leaves fillers out
      if (point_bytes > kMaxPoints) fail("announces more than a file can hold");
    }
    const std::uint64_t rest = bytes_.size() - at_;
    const auto atMost = [&](std::uint64_t bytes) {
      if (bytes > rest) fail("announces more than the file holds: it is cut short");
    };
    if (data_ == "binary") {
      atMost(points_ * point_bytes);
    } else if (data_ == "ascii") {
      atMost(points_ * values * 2 - 1);  // a digit and a blank for each value
    } else if (data_ == "binary_compressed") {
      std::uint32_t lengths[2] = {0, 0};  // packed, unpacked
      atMost(sizeof lengths);
      std::memcpy(lengths, &bytes_[at_], sizeof lengths);
      atMost(sizeof lengths + lengths[0]);
      if (lengths[1] != points_ * packed_bytes) fail("announces another length than the data do");
      constexpr std::uint64_t kMaxPacking = 100;  // LZF packs 264 bytes into 3
      if (points_ * point_bytes > kMaxPacking * rest) fail("announces more than a file can hold");
    } else {
      fail("has '" + data_.substr(0, 40) + "' behind DATA");
    }
  }

  const std::string& bytes_;
  const std::string& source_;
  std::size_t at_ = 0;
  int line_ = 0;
  std::string key_, data_;
  std::ptrdiff_t next_key_ = 0;
  std::vector<std::string> fields_, types_;
  std::vector<std::uint64_t> sizes_, counts_;
  std::uint64_t width_ = 0, height_ = 0, points_ = 0;
};

}  // namespace

PcdHeader checkPcdHeader(const std::string& bytes, const std::string& source) {
  return HeaderReader(bytes, source).check();
}

}  // namespace hyselam_objects
