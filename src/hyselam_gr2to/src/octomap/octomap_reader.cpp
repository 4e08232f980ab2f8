#include "hyselam_gr2to/octomap/octomap_reader.hpp"

#include <cmath>
#include <cstring>
#include <optional>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"

namespace hyselam_topo {
namespace {

constexpr int kMaxDepth = 16;
constexpr std::int32_t kCentre = 32768;  // cell 0 in the keys of the tree
constexpr char kBinaryBegin[] = "# Octomap OcTree binary file";
constexpr char kFullBegin[] = "# Octomap OcTree file";

/// Walks the nodes of a tree in the order of the file, never deeper than the tree can be and never
/// beyond the data.
class Walk {
 public:
  Walk(const std::string& data, std::size_t at, const std::string& source,
       const OctoMapLimits& limits)
      : data_(data), at_(at), source_(source), limits_(limits) {}

  /// The nodes of a .bt file: two bits for each child.
  void binary() {
    inner({}, 0);
    finish();
  }

  /// The nodes of an .ot file: log odds, `skip` bytes of other data, one bit for each child.
  void full(std::size_t skip) {
    skip_ = skip;
    node({}, 0);
    finish();
  }

  std::size_t nodes() const { return nodes_; }
  std::vector<VoxelLeaf> takeLeaves() { return std::move(leaves_); }

 private:
  struct Corner {
    std::int32_t x = -kCentre, y = -kCentre, z = -kCentre;
  };

  [[noreturn]] void fail(const std::string& reason) const {
    throw hyselam::InputError(source_, "byte " + std::to_string(at_), reason);
  }

  const char* take(std::size_t count) {
    if (data_.size() - at_ < count) fail("the tree is cut off");
    at_ += count;
    return data_.data() + at_ - count;
  }

  static Corner child(const Corner& c, int i, int depth) {
    const std::int32_t half = std::int32_t{1} << (kMaxDepth - depth - 1);
    return {c.x + (i & 1 ? half : 0), c.y + (i & 2 ? half : 0), c.z + (i & 4 ? half : 0)};
  }

  void leaf(const Corner& c, int depth, float probability) {
    if (leaves_.size() == limits_.max_leaves) {
      fail("it has more than " + std::to_string(limits_.max_leaves) + " leaves");
    }
    leaves_.push_back({c.x, c.y, c.z, std::int32_t{1} << (kMaxDepth - depth), probability});
  }

  void descend(int depth) const {
    if (depth >= kMaxDepth) fail("the tree is deeper than 16 levels");
  }

  void inner(const Corner& corner, int depth) {
    ++nodes_;
    descend(depth);
    const char* bytes = take(2);
    const unsigned bits = static_cast<unsigned char>(bytes[0]) |
                          static_cast<unsigned>(static_cast<unsigned char>(bytes[1])) << 8;
    for (int i = 0; i < 8; ++i) {
      const unsigned kind = bits >> (2 * i) & 3u;
      if (kind == 0) continue;
      if (kind == 3) {
        inner(child(corner, i, depth), depth + 1);
      } else {
        ++nodes_;
        leaf(child(corner, i, depth), depth + 1, kind == 2 ? 1.0f : 0.0f);
      }
    }
  }

  void node(const Corner& corner, int depth) {
    ++nodes_;
    float log_odds = 0.0f;
    std::memcpy(&log_odds, take(sizeof log_odds), sizeof log_odds);
    take(skip_);
    const unsigned children = static_cast<unsigned char>(*take(1));
    if (children == 0) {
      if (std::isnan(log_odds)) fail("an occupancy is not a number");
      leaf(corner, depth, static_cast<float>(1.0 - 1.0 / (1.0 + std::exp(double{log_odds}))));
      return;
    }
    descend(depth);
    for (int i = 0; i < 8; ++i) {
      if (children >> i & 1u) node(child(corner, i, depth), depth + 1);
    }
  }

  void finish() const {
    if (at_ != data_.size()) fail("there are data after the tree");
  }

  const std::string& data_;
  std::size_t at_;
  const std::string& source_;
  const OctoMapLimits& limits_;
  std::size_t skip_ = 0;
  std::size_t nodes_ = 0;
  std::vector<VoxelLeaf> leaves_;
};

struct Header {
  std::string id;
  std::size_t size = 0;
  double resolution = 0.0;
  std::size_t data_begin = 0;
};

Header readHeader(const std::string& bytes, const std::string& source) {
  Header header;
  std::size_t line_begin = 0;
  for (int number = 1; number <= 100; ++number) {
    const std::string place = "line " + std::to_string(number);
    const std::size_t end = bytes.find('\n', line_begin);
    if (end == std::string::npos || end - line_begin > 1000) break;
    std::string line = bytes.substr(line_begin, end - line_begin);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    line_begin = end + 1;
    if (line == "data") {
      header.data_begin = line_begin;
      return header;
    }
    const std::size_t blank = line.find(' ');
    const std::string key = line.substr(0, blank);
    const std::string value = blank == std::string::npos ? "" : line.substr(blank + 1);
    if (key == "id") {
      header.id = value;
    } else if (key == "res" || key == "size") {
      const auto parsed = hyselam::parseNumber(value);
      if (!parsed || *parsed < 0.0 || *parsed > 1e15) {
        throw hyselam::InputError(source, place, "'" + value + "' is no number of that kind");
      }
      if (key == "res") {
        header.resolution = *parsed;
      } else {
        header.size = static_cast<std::size_t>(*parsed);
      }
    } else if (!line.empty() && line[0] != '#') {
      throw hyselam::InputError(source, place, "'" + key.substr(0, 40) + "' is not known");
    }
  }
  throw hyselam::InputError(source, "header", "there is no line 'data'");
}

bool beginsWith(const std::string& text, const char* begin) {
  return text.compare(0, std::strlen(begin), begin) == 0;
}

VoxelMap read(const std::string& bytes, std::size_t at, bool binary, const std::string& id,
              double resolution, std::optional<std::size_t> size, const std::string& source,
              const OctoMapLimits& limits) {
  if (bytes.size() > limits.max_bytes) {
    throw hyselam::InputError(source, "",
                              "it has " + std::to_string(bytes.size()) + " bytes, more than " +
                                  std::to_string(limits.max_bytes));
  }
  if (!(resolution >= 1e-3 && resolution <= 100.0)) {
    throw hyselam::InputError(
        source, "resolution",
        "it is " + hyselam::formatNumber(resolution) + " m, but must be in [0.001, 100]");
  }
  const bool colour = id == "ColorOcTree";
  if (!colour && id != "OcTree") {
    throw hyselam::InputError(
        source, "id",
        "trees of type '" + id.substr(0, 40) + "' are not known, only OcTree and ColorOcTree");
  }
  VoxelMap map;
  map.resolution = resolution;
  // liboctomap writes nothing at all for an empty tree.
  if (at == bytes.size() && size.value_or(0) == 0) return map;
  Walk walk(bytes, at, source, limits);
  if (binary) {
    walk.binary();
  } else {
    walk.full(colour ? 3 : 0);
  }
  if (size && *size != walk.nodes()) {
    throw hyselam::InputError(source, "size",
                              "the header tells of " + std::to_string(*size) +
                                  " nodes, the data hold " + std::to_string(walk.nodes()));
  }
  map.leaves = walk.takeLeaves();
  return map;
}

}  // namespace

VoxelMap parseOctoMap(const std::string& bytes, const std::string& source,
                      const OctoMapLimits& limits) {
  const bool binary = beginsWith(bytes, kBinaryBegin);
  if (!binary && !beginsWith(bytes, kFullBegin)) {
    throw hyselam::InputError(source, "line 1",
                              "this is no OctoMap: it must begin with '" +
                                  std::string(kBinaryBegin) + "' or '" + kFullBegin + "'");
  }
  const Header header = readHeader(bytes, source);
  return read(bytes, header.data_begin, binary, header.id, header.resolution, header.size, source,
              limits);
}

VoxelMap loadOctoMap(const std::string& path, const OctoMapLimits& limits) {
  return parseOctoMap(hyselam::readTextFile(path, limits.max_bytes), path, limits);
}

VoxelMap octoMapFromData(const std::string& data, bool binary, const std::string& id,
                         double resolution, const std::string& source,
                         const OctoMapLimits& limits) {
  return read(data, 0, binary, id, resolution, std::nullopt, source, limits);
}

}  // namespace hyselam_topo
