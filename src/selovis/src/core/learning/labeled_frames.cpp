#include "selovis/learning/labeled_frames.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "selovis/learning/error_source.hpp"

namespace selovis {
namespace {

constexpr std::size_t kMaxColumns = 4096;

/// Cells of a line of CSV (RFC 4180, without line breaks in cells).
std::vector<std::string> split(std::string line, const std::string& path,
                               const std::string& where) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted) {
      if (c != '"') {
        cells.back() += c;
      } else if (i + 1 < line.size() && line[i + 1] == '"') {
        cells.back() += line[++i];
      } else {
        quoted = false;
        if (i + 1 < line.size() && line[i + 1] != ',') {
          throw hyselam::InputError(path, where, "has text after a closing quotation mark");
        }
      }
    } else if (c == ',') {
      cells.emplace_back();
    } else if (c == '"' && (i == 0 || line[i - 1] == ',')) {
      quoted = true;
    } else {
      cells.back() += c;
    }
  }
  if (quoted) throw hyselam::InputError(path, where, "has a quotation mark that is not closed");
  return cells;
}

enum class Column {
  kSkip,
  kImage,
  kPlace,
  kDepth,
  kHeading,
  kMagX,
  kMagY,
  kMagZ,
  kRange,
  kScan,
  kStamp,
  kX,
  kY,
  kTheta,
  kOdomX,
  kOdomY,
  kOdomTheta
};

Column columnOf(const std::string& name) {
  if (name == "image_path" || name == "image" || name == "file" || name == "path")
    return Column::kImage;
  if (name == "place") return Column::kPlace;
  if (name == "depth_path") return Column::kDepth;
  if (name == "psi") return Column::kHeading;
  if (name == "mag_x") return Column::kMagX;
  if (name == "mag_y") return Column::kMagY;
  if (name == "mag_z") return Column::kMagZ;
  if (name == "stamp") return Column::kStamp;
  if (name == "x") return Column::kX;
  if (name == "y") return Column::kY;
  if (name == "theta") return Column::kTheta;
  if (name == "odom_x") return Column::kOdomX;
  if (name == "odom_y") return Column::kOdomY;
  if (name == "odom_theta") return Column::kOdomTheta;
  if (name.compare(0, 6, "range_") == 0) return Column::kRange;
  if (name.compare(0, 5, "scan_") == 0) return Column::kScan;
  return Column::kSkip;
}

double number(const std::string& cell, const std::string& path, const std::string& where) {
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (end != cell.c_str() + cell.size()) {
    throw hyselam::InputError(path, where, "'" + cell.substr(0, 40) + "' is no number");
  }
  return value;
}

void put(LabeledFrame& frame, hyselam::Pose2& odometry, Column column, const std::string& cell,
         const std::string& folder, const std::string& path, const std::string& where) {
  const auto file = [&]() {
    return (std::filesystem::path(folder) / cell).lexically_normal().string();
  };
  switch (column) {
    case Column::kSkip:
      break;
    case Column::kImage:
      if (!cell.empty()) frame.image = file();
      break;
    case Column::kPlace:
      frame.place = cell;
      break;
    case Column::kDepth:
      if (!cell.empty()) frame.depth = file();
      break;
    case Column::kHeading:
      frame.readings.heading = number(cell, path, where);
      break;
    case Column::kMagX:
      frame.readings.magnetic[0] = number(cell, path, where);
      break;
    case Column::kMagY:
      frame.readings.magnetic[1] = number(cell, path, where);
      break;
    case Column::kMagZ:
      frame.readings.magnetic[2] = number(cell, path, where);
      break;
    case Column::kStamp:
      frame.readings.stamp = number(cell, path, where);
      break;
    case Column::kX:
      frame.pose.x = number(cell, path, where);
      break;
    case Column::kY:
      frame.pose.y = number(cell, path, where);
      break;
    case Column::kTheta:
      frame.pose.theta = number(cell, path, where);
      break;
    case Column::kOdomX:
      odometry.x = number(cell, path, where);
      break;
    case Column::kOdomY:
      odometry.y = number(cell, path, where);
      break;
    case Column::kOdomTheta:
      odometry.theta = number(cell, path, where);
      break;
    case Column::kRange:
      frame.readings.ranges.push_back(static_cast<float>(number(cell, path, where)));
      break;
    case Column::kScan:
      frame.readings.scan.push_back(static_cast<float>(number(cell, path, where)));
      break;
  }
}

bool endsWithin(const std::string& bytes, const char* mark, std::size_t length, std::size_t tail) {
  const std::size_t from = bytes.size() > tail ? bytes.size() - tail : 0;
  return bytes.find(std::string(mark, length), from) != std::string::npos;
}

}  // namespace

std::vector<LabeledFrame> readLabeledFrames(const std::string& path) {
  std::istringstream in(hyselam::readTextFile(path, std::size_t{1} << 30));
  const std::string folder = std::filesystem::path(path).parent_path().string();
  std::vector<LabeledFrame> frames;
  std::vector<Column> columns;
  std::string line;
  bool header = false, poses = true;
  for (std::size_t n = 1; std::getline(in, line); ++n) {
    const std::string where = "line " + std::to_string(n);
    if (line.empty() || line == "\r" || line.front() == '#') continue;
    if (line.find('\0') != std::string::npos) throw hyselam::InputError(path, where, "is no text");
    const std::vector<std::string> cells = split(line, path, where);
    if (cells.size() > kMaxColumns) throw hyselam::InputError(path, where, "has too many columns");
    if (columns.empty()) {
      std::vector<Column> named;
      named.reserve(cells.size());
      for (const auto& cell : cells) named.push_back(columnOf(cell));
      header = std::count(named.begin(), named.end(), Column::kPlace) == 1 &&
               std::count(named.begin(), named.end(), Column::kImage) == 1;
      if (header) {
        for (const Column c : {Column::kX, Column::kY, Column::kTheta}) {
          poses = poses && std::count(named.begin(), named.end(), c) == 1;
        }
        columns = named;
        continue;
      }
      if (cells.size() < 2) {
        throw hyselam::InputError(path, where, "needs at least an image and a place");
      }
      columns.assign(cells.size(), Column::kRange);
      columns[0] = Column::kImage;
      columns[1] = Column::kPlace;
    }
    if (cells.size() != columns.size()) {
      throw hyselam::InputError(path, where,
                                "has " + std::to_string(cells.size()) + " columns, but " +
                                    std::to_string(columns.size()) + " were expected");
    }
    LabeledFrame frame;
    frame.line = n;
    hyselam::Pose2 odometry{kNoPose.x, kNoPose.x, kNoPose.x};
    frame.pose = odometry;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      put(frame, odometry, columns[i], cells[i], folder, path, where);
    }
    if (!poses) frame.pose = kNoPose;
    if (odometry.isFinite()) frame.readings.odometry = odometry;
    if (frame.place.empty()) throw hyselam::InputError(path, where, "has no place");
    if (frame.image.empty()) {
      throw hyselam::InputError(path, where, "has no image");
    }
    frames.push_back(std::move(frame));
  }
  if (frames.empty()) throw hyselam::InputError(path, "", "lists no frames");
  return frames;
}

std::string csvCell(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos && text.find('\r') == std::string::npos) {
    return text;
  }
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

cv::Mat readImage(const std::string& path) {
  return decodeImage(hyselam::readTextFile(path, std::size_t{256} << 20), path);
}

cv::Mat decodeImage(const std::string& bytes, const std::string& path) {
  if (bytes.empty()) throw hyselam::InputError(path, "", "is empty");
  const bool jpeg = bytes.compare(0, 2, "\xFF\xD8") == 0, png = bytes.compare(0, 4, "\x89PNG") == 0;
  if ((jpeg && !endsWithin(bytes, "\xFF\xD9", 2, 4096)) ||
      (png && !endsWithin(bytes, "IEND", 4, 4096))) {
    throw hyselam::InputError(path, "byte " + std::to_string(bytes.size()),
                              "the image is cut short");
  }
  cv::Mat image;
  try {
    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    image = cv::imdecode(raw, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& e) {
    throw hyselam::InputError(path, "", "cannot be decoded: " + e.err);
  }
  if (image.empty()) throw hyselam::InputError(path, "", "is no image that can be decoded");
  if (image.channels() == 4 && image.depth() == CV_8U) {
    cv::Mat color(image.size(), CV_8UC3);
    const int from_to[] = {0, 0, 1, 1, 2, 2};
    cv::mixChannels(&image, 1, &color, 1, from_to, 3);
    return color;
  }
  return image;
}

SensorReadings readingsOf(const LabeledFrame& frame) {
  SensorReadings readings = frame.readings;
  if (!frame.depth.empty() && readings.ranges.empty()) {
    const cv::Mat depth = readImage(frame.depth);
    withSource(frame.depth, [&] { readings.ranges = rangesOfDepth(depth, kDepthColumns); });
  }
  return readings;
}

}  // namespace selovis
