#include "hyselam_objects/ros/conversions.hpp"

#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"

namespace hyselam_objects {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

geometry_msgs::Pose poseMsg(const ObjectPose& pose) {
  geometry_msgs::Pose msg;
  msg.position.x = pose.position.x;
  msg.position.y = pose.position.y;
  msg.position.z = pose.position.z;
  msg.orientation.z = std::sin(0.5 * pose.yaw);
  msg.orientation.w = std::cos(0.5 * pose.yaw);
  return msg;
}

void checkImage(const sensor_msgs::Image& image, std::size_t pixel_bytes, const char* topic) {
  const std::size_t row = pixel_bytes * image.width;
  if (image.is_bigendian != 0 && pixel_bytes != 3) {
    throw hyselam::InputError(topic, "", "big-endian pixels are not read");
  }
  if (image.width == 0 || image.height == 0 || image.step < row ||
      image.data.size() < static_cast<std::size_t>(image.step) * image.height) {
    throw hyselam::InputError(topic, "", "the data are shorter than the size says");
  }
}

std::uint32_t colorOf(const std::uint8_t* pixel, bool bgr) {
  const std::uint32_t first = pixel[0], green = pixel[1], last = pixel[2];
  return bgr ? last << 16 | green << 8 | first : first << 16 | green << 8 | last;
}

std_msgs::ColorRGBA markerColor(const ObjectInstance& object) {
  struct Named {
    const char* name;
    float r, g, b;
  };
  static constexpr Named kColours[] = {
      {"red", 0.85f, 0.1f, 0.1f},   {"orange", 0.95f, 0.55f, 0.1f}, {"yellow", 0.9f, 0.85f, 0.1f},
      {"green", 0.1f, 0.65f, 0.2f}, {"blue", 0.15f, 0.3f, 0.9f},    {"purple", 0.55f, 0.2f, 0.7f},
      {"pink", 0.95f, 0.5f, 0.7f},  {"black", 0.12f, 0.12f, 0.12f}, {"white", 0.95f, 0.95f, 0.95f},
      {"grey", 0.55f, 0.55f, 0.55f}};
  std_msgs::ColorRGBA out;
  out.r = out.g = out.b = 0.6f;
  out.a = object.existence < 0.5 ? 0.25f : object.properties.count("furniture") != 0 ? 0.35f : 0.9f;
  const auto found = object.properties.find("colour");
  for (const Named& each : kColours) {
    if (found == object.properties.end() || found->second != each.name) continue;
    out.r = each.r;
    out.g = each.g;
    out.b = each.b;
  }
  return out;
}

const sensor_msgs::PointField* findField(const sensor_msgs::PointCloud2& msg,
                                         const std::string& name) {
  for (const auto& field : msg.fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

/// Over the center of an object; if others rest on it, over one of its edges, as far from their
/// names as possible.
geometry_msgs::Point namePosition(const ObjectMap& map, const ObjectInstance& object) {
  constexpr double kOver = 0.09;  // [m]
  constexpr double kInset = 0.8;  // from the center to an edge
  std::vector<Point3> resting;
  for (const ObjectRelation& relation : map.relations) {
    if (relation.other != object.id || !isSupport(relation.word)) continue;
    const ObjectInstance* other = map.find(relation.object);
    if (other != nullptr && other->pose) resting.push_back(other->pose->position);
  }
  const ObjectPose& pose = *object.pose;
  geometry_msgs::Point best = poseMsg(pose).position;
  best.z += 0.5 * pose.size[2] + kOver;
  if (resting.empty()) return best;
  const geometry_msgs::Point middle = best;
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  double farthest = -1.0;
  for (const auto& [u, v] :
       {std::pair{0, -1}, std::pair{-1, 0}, std::pair{1, 0}, std::pair{0, 1}}) {
    const double x = 0.5 * kInset * u * pose.size[0], y = 0.5 * kInset * v * pose.size[1];
    geometry_msgs::Point p = middle;
    p.x += c * x - s * y;
    p.y += s * x + c * y;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Point3& other : resting) {
      nearest = std::min(nearest, std::hypot(p.x - other.x, p.y - other.y));
    }
    if (nearest <= farthest) continue;
    farthest = nearest;
    best = p;
  }
  return best;
}

std::uint32_t countMoves(const ObjectInstance& object) {
  std::uint32_t moves = 0;
  for (std::size_t i = 1; i < object.history.size(); ++i) {
    const Point3 &a = object.history[i - 1].position, &b = object.history[i].position;
    moves += std::hypot(a.x - b.x, a.y - b.y, a.z - b.z) > MovabilityParams().min_move;
  }
  return moves;
}

hyselam_msgs::ObjectInstance instanceMsg(const ObjectMap& map, const ObjectInstance& object) {
  hyselam_msgs::ObjectInstance out;
  out.id = object.id;
  out.kind = object.kind;
  for (const auto& [name, value] : object.properties) {
    out.property_names.push_back(name);
    out.property_values.push_back(value);
  }
  out.described = object.described;
  out.has_pose = object.pose.has_value();
  out.pose.orientation.w = 1.0;
  if (object.pose) {
    out.pose = poseMsg(*object.pose);
    out.size.x = object.pose->size[0];
    out.size.y = object.pose->size[1];
    out.size.z = object.pose->size[2];
    std::copy(object.pose->covariance.begin(), object.pose->covariance.end(),
              out.position_covariance.begin());
  }
  out.existence = object.existence;
  out.movability = movability(map, object.id);
  out.detections = static_cast<std::uint32_t>(object.detections);
  out.missed_detections = static_cast<std::uint32_t>(object.missed_detections);
  out.last_seen = hyselam::toRosTime(object.last_seen);
  out.moves = countMoves(object);
  return out;
}

hyselam_msgs::ObjectRelation relationMsg(const ObjectMap& map, const ObjectRelation& relation) {
  hyselam_msgs::ObjectRelation out;
  out.object = relation.object;
  out.word = toString(relation.word);
  out.other = relation.other;
  if (const ObjectPlace* place = map.findPlace(relation.place)) {
    out.place = place->name;
    out.place_id = place->topological;
  }
  out.has_vector = relation.vector.has_value();
  if (relation.vector) {
    out.vector.x = relation.vector->x;
    out.vector.y = relation.vector->y;
    out.vector.z = relation.vector->z;
  }
  out.movability = relation.movability;
  out.described = relation.described;
  return out;
}

using visualization_msgs::Marker;

Marker boxMarker(const ObjectInstance& object, const Marker& base) {
  constexpr double kMinSize = 0.01;  // [m]: a flat box would not be shown
  Marker box = base;
  box.ns = "boxes";
  box.id = static_cast<int>(object.id);
  box.type = Marker::CUBE;
  box.pose = poseMsg(*object.pose);
  box.scale.x = std::max(kMinSize, object.pose->size[0]);
  box.scale.y = std::max(kMinSize, object.pose->size[1]);
  box.scale.z = std::max(kMinSize, object.pose->size[2]);
  box.color = markerColor(object);
  return box;
}

Marker nameMarker(const ObjectMap& map, const ObjectInstance& object, const Marker& base) {
  Marker text = base;
  text.ns = "names";
  text.id = static_cast<int>(object.id);
  text.type = Marker::TEXT_VIEW_FACING;
  text.pose = poseMsg(*object.pose);
  text.pose.position = namePosition(map, object);
  text.scale.z = 0.12;
  text.color.r = text.color.g = text.color.b = 0.05f;
  text.color.a = 1.0f;
  text.text = object.kind;
  return text;
}

Marker relationMarker(const ObjectPose& a, const ObjectPose& b, bool support, const Marker& base) {
  constexpr double kOver = 0.03;  // [m]
  Marker arrow = base;
  arrow.ns = "relations";
  arrow.type = Marker::ARROW;
  arrow.points.push_back(poseMsg(a).position);
  arrow.points.push_back(poseMsg(b).position);
  if (!support) {  // over both, where the boxes do not hide it
    const double top = std::max(a.position.z + 0.5 * a.size[2], b.position.z + 0.5 * b.size[2]);
    arrow.points[0].z = arrow.points[1].z = top + kOver;
  }
  arrow.scale.x = 0.015;
  arrow.scale.y = 0.04;
  arrow.scale.z = 0.05;
  arrow.color.a = 0.9f;
  arrow.color.r = support ? 0.1f : 0.85f;
  arrow.color.g = 0.45f;
  arrow.color.b = support ? 0.9f : 0.1f;
  return arrow;
}

}  // namespace

hyselam_msgs::ObjectMap toMsg(const ObjectMap& map) {
  hyselam_msgs::ObjectMap msg;
  msg.header.frame_id = map.frame_id;
  msg.header.stamp = hyselam::toRosTime(map.stamp);
  for (const ObjectInstance& object : map.objects) msg.objects.push_back(instanceMsg(map, object));
  for (const ObjectRelation& relation : map.relations) {
    msg.relations.push_back(relationMsg(map, relation));
  }
  return msg;
}

visualization_msgs::MarkerArray objectMarkers(const ObjectMap& map) {
  visualization_msgs::MarkerArray array;
  Marker base;
  base.header.frame_id = map.frame_id;
  base.pose.orientation.w = 1.0;
  base.action = Marker::DELETEALL;
  array.markers.push_back(base);
  base.action = Marker::ADD;
  for (const ObjectInstance& object : map.objects) {
    if (!object.pose) continue;
    array.markers.push_back(boxMarker(object, base));
    array.markers.push_back(nameMarker(map, object, base));
  }
  int number = 0;
  for (const ObjectRelation& relation : map.relations) {
    const ObjectInstance *a = map.find(relation.object), *b = map.find(relation.other);
    if (b == nullptr || !a->pose || !b->pose) continue;
    // "near" adds little to "left" and "right", and would hide them.
    if (relation.word == RelationWord::kNear) continue;
    Marker arrow = relationMarker(*a->pose, *b->pose, isSupport(relation.word), base);
    arrow.id = number++;
    array.markers.push_back(arrow);
  }
  return array;
}

PinholeCamera cameraFromInfo(const sensor_msgs::CameraInfo& info) {
  PinholeCamera camera;
  if (!(info.K[0] > 0.0) || !std::isfinite(info.K[0]) || !std::isfinite(info.K[2]) ||
      !std::isfinite(info.K[5])) {
    throw hyselam::InputError("camera_info", "K", "has no focal length");
  }
  camera.focal_length = info.K[0];
  camera.cx = info.K[2];
  camera.cy = info.K[5];
  return camera;
}

OrganizedCloud cloudFromImages(const sensor_msgs::Image& depth, const sensor_msgs::Image* image,
                               const PinholeCamera& camera) {
  namespace encodings = sensor_msgs::image_encodings;
  const bool millimeters =
      depth.encoding == encodings::TYPE_16UC1 || depth.encoding == encodings::MONO16;
  if (!millimeters && depth.encoding != encodings::TYPE_32FC1) {
    throw hyselam::InputError("depth", "encoding",
                              "'" + depth.encoding + "' is not 16UC1 or 32FC1");
  }
  checkImage(depth, millimeters ? 2 : 4, "depth");
  const bool bgr = image != nullptr && image->encoding == encodings::BGR8;
  if (image != nullptr) {
    if (!bgr && image->encoding != encodings::RGB8) {
      throw hyselam::InputError("colour", "encoding",
                                "'" + image->encoding + "' is not bgr8 or rgb8");
    }
    if (image->width != depth.width || image->height != depth.height) {
      throw hyselam::InputError("colour", "", "has another size than the depth image");
    }
    checkImage(*image, 3, "colour");
  }
  OrganizedCloud cloud;
  cloud.width = static_cast<int>(depth.width);
  cloud.height = static_cast<int>(depth.height);
  const auto f = static_cast<float>(camera.focal_length);
  for (std::uint32_t v = 0; v < depth.height; ++v) {
    for (std::uint32_t u = 0; u < depth.width; ++u) {
      float z = 0.0f;
      if (millimeters) {
        std::uint16_t value = 0;
        std::memcpy(&value, &depth.data[static_cast<std::size_t>(v) * depth.step + 2 * u], 2);
        z = 0.001f * static_cast<float>(value);
      } else {
        std::memcpy(&z, &depth.data[static_cast<std::size_t>(v) * depth.step + 4 * u], 4);
      }
      const bool valid = std::isfinite(z) && z > 0.0f;
      cloud.points.emplace_back(
          valid ? (static_cast<float>(u) - static_cast<float>(camera.cx)) * z / f : kNone,
          valid ? (static_cast<float>(v) - static_cast<float>(camera.cy)) * z / f : kNone,
          valid ? z : kNone);
      if (image != nullptr) {
        cloud.colors.push_back(
            colorOf(&image->data[static_cast<std::size_t>(v) * image->step + 3 * u], bgr));
      }
    }
  }
  return cloud;
}

OrganizedCloud cloudFromMsg(const sensor_msgs::PointCloud2& msg) {
  if (msg.height < 2) {
    throw hyselam::InputError("points", "", "the cloud has no rows: an organized one is needed");
  }
  std::array<std::size_t, 3> offset{};
  const std::array<const char*, 3> names{"x", "y", "z"};
  const auto inside = [&](std::uint32_t at) { return at + std::size_t{4} <= msg.point_step; };
  for (std::size_t k = 0; k < 3; ++k) {
    const sensor_msgs::PointField* field = findField(msg, names[k]);
    if (field == nullptr || field->datatype != sensor_msgs::PointField::FLOAT32 ||
        !inside(field->offset)) {
      throw hyselam::InputError("points", names[k], "is missing or no 32-bit float");
    }
    offset[k] = field->offset;
  }
  const std::size_t row = static_cast<std::size_t>(msg.point_step) * msg.width;
  if (msg.is_bigendian != 0 || msg.row_step < row ||
      msg.data.size() < static_cast<std::size_t>(msg.row_step) * msg.height) {
    throw hyselam::InputError("points", "",
                              "the data are big-endian or shorter than the size says");
  }
  const sensor_msgs::PointField* rgb = findField(msg, "rgb");
  if (rgb == nullptr) rgb = findField(msg, "rgba");
  if (rgb != nullptr && !inside(rgb->offset)) rgb = nullptr;
  OrganizedCloud cloud;
  cloud.width = static_cast<int>(msg.width);
  cloud.height = static_cast<int>(msg.height);
  for (std::uint32_t v = 0; v < msg.height; ++v) {
    for (std::uint32_t u = 0; u < msg.width; ++u) {
      const std::uint8_t* at = &msg.data[static_cast<std::size_t>(v) * msg.row_step +
                                         static_cast<std::size_t>(u) * msg.point_step];
      Point p;
      for (std::size_t k = 0; k < 3; ++k) std::memcpy(&p[static_cast<int>(k)], at + offset[k], 4);
      if (!p.allFinite() || p.z() <= 0.0f) p = Point(kNone, kNone, kNone);
      cloud.points.push_back(p);
      if (rgb == nullptr) continue;
      std::uint32_t value = 0;
      std::memcpy(&value, at + rgb->offset, 4);
      cloud.colors.push_back(value & 0xffffffu);
    }
  }
  return cloud;
}

}  // namespace hyselam_objects
