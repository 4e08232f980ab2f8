#include "hyselam_topological_map/ros/conversions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"

namespace hyselam_topo {
namespace {

constexpr double kNotKnown = -1.0;

/// geometry_msgs/Point or Vector3.
template <typename Msg>
Msg xyzMsg(const Point3& p) {
  Msg msg;
  msg.x = p.x;
  msg.y = p.y;
  msg.z = p.z;
  return msg;
}

template <typename Msg>
Point3 point(const Msg& msg) {
  return {msg.x, msg.y, msg.z};
}

template <std::size_t N, typename Array>
void covarianceMsg(const std::optional<std::array<double, N>>& matrix, Array* msg) {
  for (std::size_t i = 0; i < N; ++i) (*msg)[i] = matrix ? (*matrix)[i] : 0.0;
  if (!matrix) (*msg)[0] = kNotKnown;
}

template <std::size_t N, typename Array>
std::optional<std::array<double, N>> covariance(const Array& msg) {
  if (msg[0] == kNotKnown) return std::nullopt;
  std::array<double, N> matrix;
  for (std::size_t i = 0; i < N; ++i) matrix[i] = msg[i];
  return matrix;
}

hyselam_msgs::XmlExtras toMsg(const Extras& extras) {
  hyselam_msgs::XmlExtras msg;
  for (const auto& [name, value] : extras.attributes) {
    msg.attribute_names.push_back(name);
    msg.attribute_values.push_back(value);
  }
  msg.elements = extras.elements;
  return msg;
}

std::vector<hyselam_msgs::PlaceWord> toMsg(const std::vector<PlaceTerm>& words) {
  std::vector<hyselam_msgs::PlaceWord> list(words.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    list[i].text = words[i].text;
    list[i].confirmed = words[i].confirmed;
  }
  return list;
}

hyselam_msgs::Appearance toMsg(const Appearance& appearance) {
  hyselam_msgs::Appearance msg;
  msg.type = appearance.type;
  msg.rows = static_cast<std::uint32_t>(appearance.rows);
  msg.cols = static_cast<std::uint32_t>(appearance.cols);
  msg.values = appearance.values;
  return msg;
}

}  // namespace

hyselam_msgs::Wall toMsg(const Wall& wall) {
  hyselam_msgs::Wall msg;
  msg.id = wall.id;
  msg.kind = static_cast<std::uint8_t>(wall.kind);
  msg.position = xyzMsg<geometry_msgs::Point>(wall.position);
  covarianceMsg(wall.position_covariance, &msg.position_covariance);
  msg.normal = xyzMsg<geometry_msgs::Vector3>(wall.normal);
  covarianceMsg(wall.normal_covariance, &msg.normal_covariance);
  msg.length = wall.length;
  msg.height = wall.height;
  covarianceMsg(wall.size_covariance, &msg.size_covariance);
  msg.curvature = wall.curvature;
  msg.vertical_curvature = wall.vertical_curvature;
  msg.extras = toMsg(wall.extras);
  return msg;
}

namespace {

hyselam_msgs::VisualSignature toMsg(const VisualSignature& signature) {
  hyselam_msgs::VisualSignature msg;
  msg.appearance = toMsg(signature.appearance);
  msg.position = xyzMsg<geometry_msgs::Point>(signature.position);
  covarianceMsg(signature.position_covariance, &msg.position_covariance);
  msg.heading = signature.heading.value_or(std::numeric_limits<double>::quiet_NaN());
  msg.aperture_x = signature.aperture_x;
  msg.aperture_y = signature.aperture_y;
  msg.stamp = signature.stamp;
  msg.extras = toMsg(signature.extras);
  return msg;
}

hyselam_msgs::Place toMsg(const Place& place) {
  hyselam_msgs::Place msg;
  msg.id = place.id;
  msg.kind = static_cast<std::uint8_t>(place.kind);
  msg.words = toMsg(place.words);
  for (const Wall& wall : place.walls) msg.walls.push_back(toMsg(wall));
  for (const VisualSignature& s : place.signatures) msg.signatures.push_back(toMsg(s));
  msg.area = place.area;
  msg.has_centre = place.centre.has_value();
  if (place.centre) msg.centre = xyzMsg<geometry_msgs::Point>(*place.centre);
  for (const hyselam::Point2& p : place.outline) {
    msg.outline_x.push_back(p.x);
    msg.outline_y.push_back(p.y);
  }
  msg.extras = toMsg(place.extras);
  return msg;
}

hyselam_msgs::Door toMsg(const Door& door) {
  hyselam_msgs::Door msg;
  msg.id = door.id;
  msg.real = door.real;
  msg.state = static_cast<std::uint8_t>(door.state);
  msg.position = xyzMsg<geometry_msgs::Point>(door.position);
  covarianceMsg(door.position_covariance, &msg.position_covariance);
  msg.normal = xyzMsg<geometry_msgs::Vector3>(door.normal);
  msg.width = door.width;
  msg.height = door.height;
  if (door.appearance) msg.appearance = {toMsg(*door.appearance)};
  msg.extras = toMsg(door.extras);
  return msg;
}

/// Messages to values; knows the source for its messages.
class Reader {
 public:
  explicit Reader(const std::string& source) : source_(source) {}

  void require(bool good, const std::string& where, const std::string& reason) const {
    if (!good) throw hyselam::InputError(source_, where, reason);
  }

  template <typename E>
  E constant(std::uint8_t value, E last, const std::string& where, const char* name) const {
    require(value <= static_cast<std::uint8_t>(last), where,
            std::string(name) + " is " + std::to_string(value) + ", but must be 0 .. " +
                std::to_string(static_cast<int>(last)));
    return static_cast<E>(value);
  }

  Extras extras(const hyselam_msgs::XmlExtras& msg, const std::string& where) const {
    require(msg.attribute_names.size() == msg.attribute_values.size(), where,
            "extra attributes have not as many values as names");
    Extras extras;
    for (std::size_t i = 0; i < msg.attribute_names.size(); ++i) {
      extras.attributes.emplace_back(msg.attribute_names[i], msg.attribute_values[i]);
    }
    extras.elements = msg.elements;
    return extras;
  }

  static std::vector<PlaceTerm> words(const std::vector<hyselam_msgs::PlaceWord>& list) {
    std::vector<PlaceTerm> words;
    words.reserve(list.size());
    for (const auto& word : list) words.push_back({word.text, word.confirmed != 0});
    return words;
  }

  Appearance appearance(const hyselam_msgs::Appearance& msg, const std::string& where) const {
    constexpr std::uint32_t kMost = std::numeric_limits<int>::max();
    require(msg.rows <= kMost && msg.cols <= kMost, where, "an appearance is too large");
    Appearance a;
    a.type = msg.type;
    a.rows = static_cast<int>(msg.rows);
    a.cols = static_cast<int>(msg.cols);
    a.values = msg.values;
    return a;
  }

  Wall wall(const hyselam_msgs::Wall& msg, const std::string& place) const {
    const std::string where = place + ", wall " + std::to_string(msg.id);
    Wall wall;
    wall.id = msg.id;
    wall.kind = constant(msg.kind, WallKind::kSolid, where, "kind");
    wall.position = point(msg.position);
    wall.position_covariance = covariance<9>(msg.position_covariance);
    wall.normal = point(msg.normal);
    wall.normal_covariance = covariance<9>(msg.normal_covariance);
    wall.length = msg.length;
    wall.height = msg.height;
    wall.size_covariance = covariance<4>(msg.size_covariance);
    wall.curvature = msg.curvature;
    wall.vertical_curvature = msg.vertical_curvature;
    wall.extras = extras(msg.extras, where);
    return wall;
  }

  VisualSignature signature(const hyselam_msgs::VisualSignature& msg,
                            const std::string& where) const {
    VisualSignature s;
    s.appearance = appearance(msg.appearance, where);
    s.position = point(msg.position);
    s.position_covariance = covariance<9>(msg.position_covariance);
    if (!std::isnan(msg.heading)) s.heading = msg.heading;
    s.aperture_x = msg.aperture_x;
    s.aperture_y = msg.aperture_y;
    s.stamp = msg.stamp;
    s.extras = extras(msg.extras, where);
    return s;
  }

  Place place(const hyselam_msgs::Place& msg) const {
    const std::string where = "place " + std::to_string(msg.id);
    Place place;
    place.id = msg.id;
    place.kind = constant(msg.kind, PlaceKind::kVirtual, where, "kind");
    place.words = words(msg.words);
    for (const auto& w : msg.walls) place.walls.push_back(wall(w, where));
    for (const auto& s : msg.signatures) place.signatures.push_back(signature(s, where));
    place.area = msg.area;
    if (msg.has_centre) place.centre = point(msg.centre);
    require(msg.outline_x.size() == msg.outline_y.size(), where,
            "the outline has not as many x as y");
    for (std::size_t i = 0; i < msg.outline_x.size(); ++i) {
      place.outline.push_back({msg.outline_x[i], msg.outline_y[i]});
    }
    place.extras = extras(msg.extras, where);
    return place;
  }

  Door door(const hyselam_msgs::Door& msg, const std::string& edge) const {
    const std::string where = edge + ", door " + std::to_string(msg.id);
    Door door;
    door.id = msg.id;
    door.real = msg.real != 0;
    door.state = constant(msg.state, DoorState::kClosed, where, "state");
    door.position = point(msg.position);
    door.position_covariance = covariance<9>(msg.position_covariance);
    door.normal = point(msg.normal);
    door.width = msg.width;
    door.height = msg.height;
    require(msg.appearance.size() <= 1, where, "it has more than one appearance");
    if (!msg.appearance.empty()) door.appearance = appearance(msg.appearance[0], where);
    door.extras = extras(msg.extras, where);
    return door;
  }

  Edge edge(const hyselam_msgs::PlaceEdge& msg) const {
    const std::string where = "edge " + std::to_string(msg.a) + "-" + std::to_string(msg.b);
    Edge edge;
    edge.a = msg.a;
    edge.b = msg.b;
    edge.words = words(msg.words);
    for (const auto& d : msg.doors) edge.doors.push_back(door(d, where));
    edge.extras = extras(msg.extras, where);
    return edge;
  }

  PlaceGrid grid(const hyselam_msgs::PlaceGrid& msg) const {
    constexpr std::uint32_t kMost = std::numeric_limits<int>::max();
    require(msg.width <= kMost && msg.height <= kMost, "grid", "it is too large");
    PlaceGrid grid;
    grid.geometry.width = static_cast<int>(msg.width);
    grid.geometry.height = static_cast<int>(msg.height);
    grid.geometry.resolution = msg.resolution;
    grid.geometry.origin = {msg.origin.x, msg.origin.y, msg.origin.theta};
    grid.labels = msg.labels;
    grid.places = msg.places;
    return grid;
  }

 private:
  const std::string& source_;
};

}  // namespace

hyselam_msgs::AugmentedTopologicalMap toMsg(const AugmentedTopologicalMap& map) {
  hyselam_msgs::AugmentedTopologicalMap msg;
  msg.header.frame_id = map.frame_id;
  if (map.stamp != 0.0) msg.header.stamp = hyselam::toRosTime(map.stamp, "stamp of the map");
  for (const Place& place : map.places) msg.places.push_back(toMsg(place));
  for (const Edge& edge : map.edges) {
    msg.edges.emplace_back();
    msg.edges.back().a = edge.a;
    msg.edges.back().b = edge.b;
    msg.edges.back().words = toMsg(edge.words);
    for (const Door& door : edge.doors) msg.edges.back().doors.push_back(toMsg(door));
    msg.edges.back().extras = toMsg(edge.extras);
  }
  msg.has_grid = map.grid.has_value();
  if (map.grid) {
    const hyselam::GridGeometry& g = map.grid->geometry;
    msg.grid.width = static_cast<std::uint32_t>(g.width);
    msg.grid.height = static_cast<std::uint32_t>(g.height);
    msg.grid.resolution = g.resolution;
    msg.grid.origin = hyselam::toPose2dMsg(g.origin);
    msg.grid.labels = map.grid->labels;
    msg.grid.places = map.grid->places;
  }
  msg.next_place_id = map.next_place_id;
  msg.next_wall_id = map.next_wall_id;
  msg.next_door_id = map.next_door_id;
  msg.extras = toMsg(map.extras);
  return msg;
}

AugmentedTopologicalMap fromMsg(const hyselam_msgs::AugmentedTopologicalMap& msg,
                                const std::string& source) {
  const Reader reader(source);
  AugmentedTopologicalMap map;
  map.frame_id = msg.header.frame_id;
  map.stamp = hyselam::toSeconds(msg.header.stamp);
  for (const auto& place : msg.places) map.places.push_back(reader.place(place));
  for (const auto& edge : msg.edges) map.edges.push_back(reader.edge(edge));
  if (msg.has_grid) map.grid = reader.grid(msg.grid);
  map.next_place_id = msg.next_place_id;
  map.next_wall_id = msg.next_wall_id;
  map.next_door_id = msg.next_door_id;
  map.extras = reader.extras(msg.extras, "map");
  checkMap(map, source);
  return map;
}

std::string frameOf(const std::string& frame_id) {
  const std::string frame = !frame_id.empty() && frame_id[0] == '/' ? frame_id.substr(1) : frame_id;
  return frame.empty() ? "map" : frame;
}

}  // namespace hyselam_topo
