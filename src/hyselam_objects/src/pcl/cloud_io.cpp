#include "hyselam_objects/pcl/cloud_io.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <sstream>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "pcd_header.hpp"

namespace hyselam_objects {
namespace {

using hyselam::InputError;

const pcl::PCLPointField* find(const pcl::PCLPointCloud2& cloud, const std::string& name) {
  for (const pcl::PCLPointField& field : cloud.fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

template <typename T>
T valueAt(const pcl::PCLPointCloud2& cloud, std::size_t i, const pcl::PCLPointField& field) {
  T value;
  std::memcpy(&value, &cloud.data[i * cloud.point_step + field.offset], sizeof value);
  return value;
}

using Axes = std::array<const pcl::PCLPointField*, 3>;

/// The fields of a point, their names with this prefix.
Axes findAxes(const pcl::PCLPointCloud2& cloud, const std::string& path,
              const std::string& prefix) {
  Axes out{};
  for (std::size_t a = 0; a < out.size(); ++a) {
    const std::string name = prefix + "xyz"[a];
    out[a] = find(cloud, name);
    if (out[a] == nullptr || out[a]->datatype != pcl::PCLPointField::FLOAT32) {
      throw InputError(path, "field " + name, "is missing or no 32-bit float");
    }
  }
  return out;
}

Point pointAt(const pcl::PCLPointCloud2& cloud, std::size_t i, const Axes& axes) {
  return {valueAt<float>(cloud, i, *axes[0]), valueAt<float>(cloud, i, *axes[1]),
          valueAt<float>(cloud, i, *axes[2])};
}

}  // namespace

CloudFile readPcd(const std::string& path) {
  constexpr std::size_t kMaxBytes = std::size_t{4} << 30;
  const std::string bytes = hyselam::readTextFile(path, kMaxBytes);
  const PcdHeader header = checkPcdHeader(bytes, path);
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::PCLPointCloud2 raw;
  pcl::PCDReader reader;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, type = 0;
  unsigned int start = 0;
  try {
    std::istringstream head(bytes.substr(0, header.length));
    if (reader.readHeader(head, raw, origin, orientation, version, type, start) < 0) {
      throw InputError(path, "header", "is not that of a PCD file");
    }
    constexpr int kText = 0, kPacked = 2;
    int status = 0;
    if (type == kText) {
      std::istringstream data(bytes.substr(header.length));
      status = reader.readBodyASCII(data, raw, version);
    } else {
      const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
      status = reader.readBodyBinary(data, raw, version, type == kPacked, start);
    }
    if (status < 0) throw InputError(path, "data", "is cut short or damaged");
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    throw InputError(path, "", std::string("is no usable PCD file: ") + e.what());
  }
  const std::size_t size = std::size_t{raw.width} * raw.height;
  // PCL reports data that cannot be unpacked by a cloud of another size.
  if (size != header.points || raw.data.size() < size * raw.point_step) {
    throw InputError(path, "data", "is cut short or damaged");
  }
  CloudFile out;
  out.cloud.width = static_cast<int>(raw.width);
  out.cloud.height = static_cast<int>(raw.height);
  const auto axes = findAxes(raw, path, "");
  const bool has_viewpoint = find(raw, "vp_x") != nullptr;
  const auto viewpoint = has_viewpoint ? findAxes(raw, path, "vp_") : axes;
  const pcl::PCLPointField* color = find(raw, "rgba");
  if (color == nullptr) color = find(raw, "rgb");
  const pcl::PCLPointField* label = find(raw, "label");
  for (const pcl::PCLPointField* field : {color, label}) {
    if (field != nullptr && (field->datatype < pcl::PCLPointField::INT32 ||
                             field->datatype > pcl::PCLPointField::FLOAT32)) {
      throw InputError(path, "field " + field->name, "has not 32 bits");
    }
  }
  out.cloud.points.resize(size);
  if (color != nullptr) out.cloud.colors.resize(size);
  if (label != nullptr) out.labels.resize(size);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < size; ++i) {
    const Point p = pointAt(raw, i, axes);
    if (has_viewpoint) out.seen_from.push_back(pointAt(raw, i, viewpoint));
    out.cloud.points[i] = p.allFinite() ? p : Point(nan, nan, nan);
    if (color != nullptr) {
      out.cloud.colors[i] = valueAt<std::uint32_t>(raw, i, *color) & 0xffffffu;
    }
    if (label != nullptr) out.labels[i] = valueAt<std::uint32_t>(raw, i, *label);
  }
  return out;
}

void writePcd(const std::string& path, const OrganizedCloud& cloud,
              const std::vector<std::uint32_t>& labels, const std::vector<Point>& seen_from) {
  const bool has_color = !cloud.colors.empty();
  pcl::PCLPointCloud2 raw;
  raw.width = static_cast<std::uint32_t>(cloud.width);
  raw.height = static_cast<std::uint32_t>(cloud.height);
  raw.is_dense = false;
  const auto add = [&raw](const char* name, std::uint8_t type) {
    pcl::PCLPointField field;
    field.name = name;
    field.offset = raw.point_step;
    field.datatype = type;
    field.count = 1;
    raw.fields.push_back(field);
    raw.point_step += 4;
  };
  for (const char* axis : {"x", "y", "z"}) add(axis, pcl::PCLPointField::FLOAT32);
  if (has_color) add("rgb", pcl::PCLPointField::FLOAT32);
  if (!seen_from.empty()) {
    for (const char* axis : {"vp_x", "vp_y", "vp_z"}) add(axis, pcl::PCLPointField::FLOAT32);
  }
  add("label", pcl::PCLPointField::UINT32);
  raw.row_step = raw.point_step * raw.width;
  raw.data.resize(cloud.size() * raw.point_step);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::uint8_t* at = &raw.data[i * raw.point_step];
    for (int a = 0; a < 3; ++a, at += 4) std::memcpy(at, &cloud.points[i][a], 4);
    if (has_color) {
      std::memcpy(at, &cloud.colors[i], 4);
      at += 4;
    }
    for (int a = 0; a < 3 && !seen_from.empty(); ++a, at += 4) {
      std::memcpy(at, &seen_from.at(i)[a], 4);
    }
    std::memcpy(at, &labels.at(i), 4);
  }
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  hyselam::replaceFileAtomically(path, [&](const std::string& temporary) {
    try {
      if (pcl::PCDWriter().writeBinaryCompressed(temporary, raw) < 0) {
        throw InputError(path, "", "cannot be written");
      }
    } catch (const pcl::PCLException& e) {
      throw InputError(path, "", std::string("cannot be written: ") + e.what());
    }
  });
}

}  // namespace hyselam_objects
