#include "hyselam_common/map_io.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/yaml_text.hpp"
#include "pgm.hpp"

namespace hyselam {
namespace {

constexpr std::size_t kMaxYamlBytes = 1 << 20;
// What map_saver writes; 205 lies between these thresholds.
constexpr double kOccupiedThreshold = 0.65;
constexpr double kFreeThreshold = 0.196;
constexpr int kGreyFree = 254, kGreyOccupied = 0, kGreyUnknown = 205;
// Thresholds of scale maps: far apart, so that 1 .. 99 spread over many gray values.
constexpr double kScaleOccupied = 0.99, kScaleFree = 0.01;

struct MapFile {
  std::string image;
  double resolution = 0.0;
  Pose2 origin;
  bool negate = false;
  double occupied_thresh = 0.0;
  double free_thresh = 0.0;
  MapMode mode = MapMode::kTrinary;
};

std::string directoryOf(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

/// One YAML file; every question that it cannot answer is an InputError with the key.
class YamlFile {
 public:
  explicit YamlFile(const std::string& path)
      : path_(path), root_(parseYaml(readTextFile(path, kMaxYamlBytes), path)) {
    if (!root_.IsMap()) throw InputError(path_, "", "is not a YAML file of keys and values");
  }

  bool has(const std::string& key) const { return static_cast<bool>(root_[key]); }

  YAML::Node node(const std::string& key) const {
    const YAML::Node n = root_[key];
    if (!n) fail(key, "is missing");
    return n;
  }
  std::string text(const std::string& key) const {
    const YAML::Node n = node(key);
    if (!n.IsScalar() || n.Scalar().empty()) fail(key, "must be a text");
    return n.Scalar();
  }
  double number(const std::string& key) const { return number(key, node(key)); }
  double number(const std::string& key, const YAML::Node& n) const {
    if (!n.IsScalar()) fail(key, "must be a number");
    double value = 0.0;
    if (!YAML::convert<double>::decode(n, value)) fail(key, "'" + n.Scalar() + "' is not a number");
    if (!std::isfinite(value)) fail(key, "must be finite, but is " + n.Scalar());
    return value;
  }
  [[noreturn]] void fail(const std::string& key, const std::string& reason) const {
    throw InputError(path_, "key '" + key + "'", reason);
  }

 private:
  std::string path_;
  YAML::Node root_;
};

MapFile readMapFile(const std::string& path) {
  const YamlFile yaml(path);
  MapFile map;
  map.image = yaml.text("image");
  if (map.image[0] != '/') map.image = directoryOf(path) + map.image;
  map.resolution = yaml.number("resolution");
  if (map.resolution <= 0.0) yaml.fail("resolution", "must be > 0 metres per cell");
  const YAML::Node origin = yaml.node("origin");
  if (!origin.IsSequence() || origin.size() != 3) yaml.fail("origin", "must be [x, y, yaw]");
  map.origin = {yaml.number("origin", origin[0]), yaml.number("origin", origin[1]),
                normalizeAngle(yaml.number("origin", origin[2]))};
  const std::string negate = yaml.text("negate");
  if (negate == "1" || negate == "true") {
    map.negate = true;
  } else if (negate != "0" && negate != "false") {
    yaml.fail("negate", "must be 0 or 1, but is '" + negate + "'");
  }
  map.occupied_thresh = yaml.number("occupied_thresh");
  map.free_thresh = yaml.number("free_thresh");
  if (map.occupied_thresh < 0.0 || map.occupied_thresh > 1.0) {
    yaml.fail("occupied_thresh", "must be in [0, 1]");
  }
  if (map.free_thresh < 0.0 || map.free_thresh > 1.0) yaml.fail("free_thresh", "must be in [0, 1]");
  if (map.free_thresh > map.occupied_thresh) {
    yaml.fail("free_thresh", "must not exceed occupied_thresh");
  }
  if (yaml.has("mode")) {
    const std::string mode = yaml.text("mode");
    if (mode == "scale") {
      map.mode = MapMode::kScale;
    } else if (mode == "raw") {
      map.mode = MapMode::kRaw;
    } else if (mode != "trinary") {
      yaml.fail("mode", "must be trinary, scale or raw, but is '" + mode + "'");
    }
  }
  return map;
}

/// Told here, since the decoder would write to stderr.
bool isTruncatedPng(const std::string& bytes) {
  constexpr char kSignature[] = "\x89PNG\r\n";
  constexpr std::size_t kTail = 64;  // the last chunk may be followed by a little padding
  return bytes.compare(0, sizeof kSignature - 1, kSignature) == 0 &&
         bytes.find("IEND", bytes.size() - std::min(bytes.size(), kTail)) == std::string::npos;
}

cv::Mat readImage(const std::string& yaml_path, const std::string& path, std::size_t max_cells) {
  const auto fail = [&](const std::string& reason) {
    throw InputError(yaml_path, "key 'image'", path + ": " + reason);
  };
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) fail("no such image");
  if (S_ISDIR(info.st_mode)) fail("is a directory, not an image");
  if (info.st_size == 0) fail("is empty");
  const std::string bytes = readTextFile(path);
  cv::Mat image;
  try {
    if (isPgm(bytes)) {
      image = decodePgm(bytes, max_cells);
    } else if (isTruncatedPng(bytes)) {
      fail("is truncated");
    } else {
      const std::vector<char> buffer(bytes.begin(), bytes.end());
      image = cv::imdecode(buffer, cv::IMREAD_UNCHANGED);
    }
  } catch (const cv::Exception& e) {
    fail("cannot be decoded (" + e.err + ")");
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& e) {
    fail(e.what());
  }
  if (image.empty()) fail("is not an image that can be decoded");
  if (image.total() > max_cells) {
    fail("has " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
         " pixels, more than the limit of " + std::to_string(max_cells));
  }
  if (image.depth() == CV_16U) {
    image.convertTo(image, CV_8U, 1.0 / 257.0);
  } else if (image.depth() != CV_8U) {
    fail("has an unusual pixel type; 8 or 16 bit are needed");
  }
  return image;
}

std::int8_t cellValue(const MapFile& map, const std::uint8_t* pixel, int channels) {
  // As in map_server: trinary mode averages the alpha channel in, the other modes do not.
  const bool has_alpha = channels == 2 || channels == 4;
  const int averaged = has_alpha && map.mode != MapMode::kTrinary ? channels - 1 : channels;
  int sum = 0;
  for (int k = 0; k < averaged; ++k) sum += pixel[k];
  double gray = static_cast<double>(sum) / averaged;
  if (map.negate) gray = 255.0 - gray;
  if (map.mode == MapMode::kRaw) {
    return gray <= 100.0 ? static_cast<std::int8_t>(gray) : OccupancyGrid::kUnknown;
  }
  const double p = (255.0 - gray) / 255.0;
  const bool transparent = map.mode == MapMode::kScale && has_alpha && pixel[channels - 1] < 255;
  if (transparent) return OccupancyGrid::kUnknown;
  if (p > map.occupied_thresh) return OccupancyGrid::kOccupied;
  if (p < map.free_thresh) return OccupancyGrid::kFree;
  if (map.mode == MapMode::kTrinary) return OccupancyGrid::kUnknown;
  const double span = map.occupied_thresh - map.free_thresh;
  const double ratio = span > 0.0 ? (p - map.free_thresh) / span : 0.5;
  return static_cast<std::int8_t>(1.0 + 98.0 * ratio);
}

void checkGrid(const OccupancyGrid& grid, const std::string& path) {
  const auto refuse = [&](const std::string& reason) {
    throw InputError(path, "grid to be written", reason);
  };
  const GridGeometry& g = grid.geometry;
  if (g.width <= 0 || g.height <= 0) refuse("is empty");
  if (grid.cells.size() != g.cellCount()) {
    refuse("the number of cells does not match width and height");
  }
  if (!(g.resolution > 0.0) || !g.origin.isFinite()) {
    refuse("resolution or origin are invalid");
  }
  for (const std::int8_t v : grid.cells) {
    if (v < -1 || v > 100) refuse("a cell lies outside -1 .. 100");
  }
}

std::uint8_t grayOf(std::int8_t value, MapMode mode) {
  switch (mode) {
    case MapMode::kTrinary:
      if (value == OccupancyGrid::kFree) return kGreyFree;
      return value == OccupancyGrid::kOccupied ? kGreyOccupied : kGreyUnknown;
    case MapMode::kScale: {
      if (value <= 0) return 255;
      if (value >= 100) return 0;
      // The middle of the interval of p that is read as `value`; 99 is a single point there.
      const double ratio = std::min((value - 0.5) / 98.0, 1.0);
      const double p = kScaleFree + ratio * (kScaleOccupied - kScaleFree);
      return static_cast<std::uint8_t>(value == 99 ? std::ceil(255.0 * (1.0 - p))
                                                   : std::round(255.0 * (1.0 - p)));
    }
    case MapMode::kRaw:
      break;
  }
  return value < 0 ? 255 : static_cast<std::uint8_t>(value);
}

std::string quoted(const std::string& text) {
  if (text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") ==
          std::string::npos &&
      text[0] != '-') {
    return text;
  }
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

}  // namespace

OccupancyGrid loadMap(const std::string& yaml_path, const MapIoOptions& options) {
  const MapFile map = readMapFile(yaml_path);
  const cv::Mat image = readImage(yaml_path, map.image, options.max_cells);
  GridGeometry geometry;
  geometry.width = image.cols;
  geometry.height = image.rows;
  geometry.resolution = map.resolution;
  geometry.origin = map.origin;
  OccupancyGrid grid(geometry);
  const int channels = image.channels();
  for (int y = 0; y < geometry.height; ++y) {
    // The first row of the image is the top: the largest y.
    const std::uint8_t* pixel = image.ptr<std::uint8_t>(geometry.height - 1 - y);
    for (int x = 0; x < geometry.width; ++x, pixel += channels) {
      grid.at({x, y}) = cellValue(map, pixel, channels);
    }
  }
  return grid;
}

void saveMap(const std::string& yaml_path, const OccupancyGrid& grid, MapMode mode) {
  checkGrid(grid, yaml_path);
  const std::string directory = directoryOf(yaml_path);
  std::string name = yaml_path.substr(directory.size());
  const std::size_t dot = name.rfind('.');
  const std::string extension = mode == MapMode::kScale ? ".png" : ".pgm";
  if (dot != std::string::npos && dot > 0) {
    if (name.substr(dot) == extension) {
      throw InputError(yaml_path, "", "is the name of the image, not of the YAML file");
    }
    name.resize(dot);
  }
  name += extension;

  const GridGeometry& g = grid.geometry;
  const int channels = mode == MapMode::kScale ? 4 : 1;
  cv::Mat image(g.height, g.width, CV_8UC(channels));
  for (int y = 0; y < g.height; ++y) {
    std::uint8_t* pixel = image.ptr<std::uint8_t>(g.height - 1 - y);
    for (int x = 0; x < g.width; ++x) {
      const std::int8_t value = grid.at({x, y});
      const std::uint8_t gray = grayOf(value, mode);
      for (int k = 0; k < std::min(channels, 3); ++k) *pixel++ = gray;
      if (channels == 4) *pixel++ = value < 0 ? 0 : 255;
    }
  }
  if (mode == MapMode::kScale) {
    std::vector<std::uint8_t> png;
    if (!cv::imencode(".png", image, png)) throw std::runtime_error("saveMap: PNG encoding failed");
    writeFileAtomically(directory + name, [&](std::ostream& out) {
      out.write(reinterpret_cast<const char*>(png.data()),
                static_cast<std::streamsize>(png.size()));
    });
  } else {
    writeFileAtomically(directory + name, [&](std::ostream& out) {
      out << "P5\n" << g.width << ' ' << g.height << "\n255\n";
      out.write(reinterpret_cast<const char*>(image.data),
                static_cast<std::streamsize>(image.total()));
    });
  }
  const bool scale = mode == MapMode::kScale;
  writeFileAtomically(yaml_path, [&](std::ostream& out) {
    out << "image: " << quoted(name) << '\n';
    if (mode != MapMode::kTrinary) out << "mode: " << (scale ? "scale" : "raw") << '\n';
    out << "resolution: " << formatNumber(g.resolution) << '\n'
        << "origin: [" << formatNumber(g.origin.x) << ", " << formatNumber(g.origin.y) << ", "
        << formatNumber(g.origin.theta) << "]\n"
        << "negate: 0\n"
        << "occupied_thresh: " << formatNumber(scale ? kScaleOccupied : kOccupiedThreshold) << '\n'
        << "free_thresh: " << formatNumber(scale ? kScaleFree : kFreeThreshold) << '\n';
  });
}

}  // namespace hyselam
