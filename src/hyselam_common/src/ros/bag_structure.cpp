#include "bag_structure.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "hyselam_common/errors.hpp"

namespace hyselam {
namespace {

constexpr char kMagic[] = "#ROSBAG V2.0\n";
enum Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

using Fields = std::map<std::string, std::string>;

template <typename T>
T littleEndian(const char* bytes) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value = static_cast<T>(
        value | static_cast<T>(static_cast<T>(static_cast<std::uint8_t>(bytes[i])) << (8 * i)));
  }
  return value;
}

class Checker {
 public:
  Checker(const std::string& file, std::string name)
      : in_(file, std::ios::binary), name_(std::move(name)) {
    in_.seekg(0, std::ios::end);
    const auto end = in_.tellg();
    if (!in_ || end < 0) throw InputError(name_, "", "cannot be read");
    size_ = static_cast<std::uint64_t>(end);
  }

  void run() {
    const std::string magic = bytesAt(0, std::min<std::uint64_t>(size_, sizeof kMagic - 1));
    if (magic.compare(0, 8, kMagic, 8) != 0) throw InputError(name_, "", "is no bag");
    if (magic != kMagic) {
      throw InputError(name_, "", "is a bag of another version than 2.0, or truncated");
    }
    std::uint64_t at = magic.size();
    for (bool first = true; at < size_; first = false) at = record(at, first);
    if (!seen_header_) fail(at, "ends before its first record");
    for (const auto& info : chunk_infos_) {
      if (chunks_.count(info.second) == 0) fail(info.first, "names a chunk where there is none");
    }
    if (chunk_infos_.size() != chunk_count_) fail(size_, "the index ends too early (truncated)");
  }

 private:
  [[noreturn]] void fail(std::uint64_t at, const std::string& reason) const {
    throw InputError(name_, "byte " + std::to_string(at), reason);
  }

  std::string bytesAt(std::uint64_t at, std::uint64_t count) {
    if (at > size_ || count > size_ - at) fail(at, "the bag ends too early (truncated or damaged)");
    std::string bytes(static_cast<std::size_t>(count), '\0');
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at));
    in_.read(&bytes[0], static_cast<std::streamsize>(count));
    if (!in_) fail(at, "cannot be read");
    return bytes;
  }
  std::uint32_t lengthAt(std::uint64_t at) {
    return littleEndian<std::uint32_t>(bytesAt(at, 4).data());
  }

  Fields fieldsOf(const std::string& header, std::uint64_t at) const {
    Fields fields;
    for (std::size_t i = 0; i < header.size();) {
      if (header.size() - i < 4) fail(at, "a record header is damaged");
      const std::size_t length = littleEndian<std::uint32_t>(&header[i]);
      i += 4;
      if (length > header.size() - i) fail(at, "a record header is damaged");
      const std::size_t equals = header.find('=', i);
      if (equals == std::string::npos || equals >= i + length)
        fail(at, "a record header is damaged");
      fields[header.substr(i, equals - i)] = header.substr(equals + 1, i + length - equals - 1);
      i += length;
    }
    return fields;
  }

  template <typename T>
  T number(const Fields& fields, const std::string& key, std::uint64_t at) const {
    const auto field = fields.find(key);
    if (field == fields.end() || field->second.size() != sizeof(T)) {
      fail(at, "a record has no field '" + key + "' of the right size");
    }
    return littleEndian<T>(field->second.data());
  }

  /// Checks the record at `at`; returns where the next one begins.
  std::uint64_t record(std::uint64_t at, bool first) {
    const std::uint64_t header_length = lengthAt(at);
    const Fields fields = fieldsOf(bytesAt(at + 4, header_length), at);
    const std::uint64_t data_at = at + 4 + header_length + 4;
    const std::uint64_t data_length = lengthAt(data_at - 4);
    if (data_length > size_ - data_at) fail(at, "the bag ends too early (truncated or damaged)");
    const auto op = number<std::uint8_t>(fields, "op", at);
    if (first != (op == kBagHeader)) fail(at, "the bag header is not in its place");
    switch (op) {
      case kBagHeader:
        seen_header_ = true;
        index_at_ = number<std::uint64_t>(fields, "index_pos", at);
        chunk_count_ = number<std::uint32_t>(fields, "chunk_count", at);
        if (index_at_ == 0) {
          throw InputError(name_, "",
                           "the bag has no index: it is truncated (rosbag reindex may help)");
        }
        if (index_at_ > size_) fail(at, "the index lies beyond the end (truncated)");
        break;
      case kChunk:
        chunk(at, fields, data_at, data_length);
        break;
      case kIndex:
        index(at, fields, data_at, data_length);
        break;
      case kChunkInfo:
        chunk_infos_.emplace_back(at, number<std::uint64_t>(fields, "chunk_pos", at));
        if (number<std::uint32_t>(fields, "count", at) > data_length / 8) {
          fail(at, "a chunk info is damaged");
        }
        break;
      case kConnection:
        number<std::uint32_t>(fields, "conn", at);
        connection(fields, bytesAt(data_at, data_length), at);
        break;
      default:
        fail(at, "a record of unknown kind " + std::to_string(op));
    }
    return data_at + data_length;
  }

  void connection(const Fields& fields, const std::string& data, std::uint64_t at) const {
    const Fields described = fieldsOf(data, at);
    bool complete = fields.count("topic") > 0;
    for (const char* key : {"type", "md5sum", "message_definition"}) {
      complete = complete && described.count(key) > 0;
    }
    if (!complete) fail(at, "a connection does not state its topic and type");
  }

  void chunk(std::uint64_t at, const Fields& fields, std::uint64_t data_at, std::uint64_t length) {
    chunks_.insert(at);
    messages_.clear();
    const auto compression = fields.find("compression");
    if (compression == fields.end()) fail(at, "a chunk does not state its compression");
    chunk_size_ = number<std::uint32_t>(fields, "size", at);
    compressed_ = compression->second != "none";
    if (compressed_) {
      // No compression of bags is better than this; more would be an attempt on the memory.
      constexpr std::uint64_t kBestRatio = 100000;
      if (chunk_size_ > (length + 1) * kBestRatio) fail(at, "a chunk states a size beyond reason");
      return;
    }
    if (chunk_size_ != length) fail(at, "a chunk has another size than it states");
    const std::string data = bytesAt(data_at, length);
    for (std::size_t i = 0; i < data.size();) {
      const std::size_t begin = i;
      const auto part = [&]() {
        if (data.size() - i < 4) fail(data_at + begin, "a record in a chunk is damaged");
        const std::size_t count = littleEndian<std::uint32_t>(&data[i]);
        i += 4;
        if (count > data.size() - i) fail(data_at + begin, "a record in a chunk is damaged");
        i += count;
        return std::make_pair(i - count, count);
      };
      const auto header = part();
      const Fields inner = fieldsOf(data.substr(header.first, header.second), data_at + begin);
      const auto body = part();
      const auto op = number<std::uint8_t>(inner, "op", data_at + begin);
      const auto connection_id = number<std::uint32_t>(inner, "conn", data_at + begin);
      if (op == kMessage) {
        number<std::uint64_t>(inner, "time", data_at + begin);
        messages_.emplace(static_cast<std::uint32_t>(begin), connection_id);
      } else if (op == kConnection) {
        connection(inner, data.substr(body.first, body.second), data_at + begin);
      } else {
        fail(data_at + begin, "a record of unknown kind in a chunk");
      }
    }
  }

  void index(std::uint64_t at, const Fields& fields, std::uint64_t data_at, std::uint64_t length) {
    constexpr std::uint64_t kEntry = 12;  // time, offset
    const std::uint64_t count = number<std::uint32_t>(fields, "count", at);
    const auto connection_id = number<std::uint32_t>(fields, "conn", at);
    if (number<std::uint32_t>(fields, "ver", at) != 1 || count * kEntry != length) {
      fail(at, "an index record is damaged");
    }
    if (chunks_.empty()) fail(at, "an index record without a chunk");
    const std::string data = bytesAt(data_at, length);
    for (std::size_t i = 0; i < data.size(); i += kEntry) {
      const auto offset = littleEndian<std::uint32_t>(&data[i + 8]);
      if (littleEndian<std::uint32_t>(&data[i + 4]) >= 1000000000U) {
        fail(at, "an index record holds a time that is none");
      }
      const auto message = messages_.find(offset);
      const bool found = compressed_
                             ? offset < chunk_size_
                             : message != messages_.end() && message->second == connection_id;
      if (!found) fail(at, "an index record points to no message");
    }
  }

  std::ifstream in_;
  std::string name_;
  std::uint64_t size_ = 0;
  bool seen_header_ = false;
  std::uint64_t index_at_ = 0;
  std::uint32_t chunk_count_ = 0;
  std::set<std::uint64_t> chunks_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> chunk_infos_;  ///< where, chunk_pos
  // Of the chunk last seen:
  bool compressed_ = false;
  std::uint64_t chunk_size_ = 0;
  std::map<std::uint32_t, std::uint32_t> messages_;  ///< offset -> connection
};

}  // namespace

void checkBagStructure(const std::string& file, const std::string& name) {
  Checker(file, name).run();
}

}  // namespace hyselam
