#include <algorithm>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/xml_document.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "packed_bytes.hpp"
#include "xml_format.hpp"

namespace hyselam_topo {
namespace {

class Reader {
 public:
  explicit Reader(const MapXmlLimits& limits) : limits_(limits) {}

  AugmentedTopologicalMap map(hyselam::XmlElement& e) {
    AugmentedTopologicalMap map;
    if (e.name() != "topological_map" || !e.has("xmlns") ||
        e.text("xmlns") != xml_format::kNamespace) {
      e.fail("this is no topological map: the first element must be <topological_map xmlns=\"" +
             std::string(xml_format::kNamespace) + "\">");
    }
    if (e.text("version") != std::to_string(xml_format::kVersion)) {
      e.fail(
          hyselam::versionRefusal(e.text("version"), {xml_format::kVersion, xml_format::kVersion}));
    }
    map.frame_id = e.text("frame_id");
    map.stamp = e.number("stamp");
    map.next_place_id = e.id("next_place_id");
    map.next_wall_id = e.id("next_wall_id");
    map.next_door_id = e.id("next_door_id");
    hyselam::Once<PlaceGrid> the_grid;
    e.children(
        [&](hyselam::XmlElement& child) {
          const std::string name = child.name();
          if (name == "place") {
            map.places.push_back(place(child));
          } else if (name == "edge") {
            map.edges.push_back(edge(child));
          } else if (name == "grid") {
            the_grid.set(child, grid(child));
          } else {
            return false;
          }
          return true;
        },
        &map.extras);
    map.grid = the_grid.takeIfThere();
    return map;
  }

 private:
  struct UncertainPoint {
    Point3 point;
    std::optional<Covariance3> covariance;
  };

  template <std::size_t N>
  static std::array<double, N> matrix(hyselam::XmlElement& e) {
    const std::vector<double> values = e.numbers();
    if (values.size() != N) {
      e.fail("here must be " + std::to_string(N) + " numbers, not " +
             std::to_string(values.size()));
    }
    std::array<double, N> result;
    std::copy(values.begin(), values.end(), result.begin());
    return result;
  }

  static UncertainPoint point(hyselam::XmlElement& e) {
    UncertainPoint p;
    p.point = {e.number("x"), e.number("y"), e.number("z")};
    hyselam::Once<Covariance3> covariance;
    e.children([&](hyselam::XmlElement& child) {
      if (child.name() != "covariance") return false;
      covariance.set(child, matrix<9>(child));
      return true;
    });
    p.covariance = covariance.takeIfThere();
    return p;
  }

  static Point3 plainPoint(hyselam::XmlElement& e) {
    const Point3 p{e.number("x"), e.number("y"), e.number("z")};
    e.finish();
    return p;
  }

  static PlaceTerm word(hyselam::XmlElement& e) {
    PlaceTerm word{e.text("text"), e.truth("confirmed")};
    e.finish();
    return word;
  }

  template <typename T>
  static std::vector<T> unpacked(hyselam::XmlElement& e, std::size_t count,
                                 std::vector<T> (*unpack)(const char*, std::size_t)) {
    if (e.text("encoding") != xml_format::kPacking) {
      e.fail("the encoding '" + e.text("encoding") + "' is not known, only " +
             xml_format::kPacking);
    }
    try {
      return unpack(e.content(), count);
    } catch (const hyselam::Error& error) {
      e.fail(error.what());
    }
  }

  /// rows * cols, or failure beyond `limit`.
  static std::size_t count(const hyselam::XmlElement& e, int rows, int cols, std::size_t limit) {
    if (rows < 1 || cols < 1) e.fail("there are no rows or columns");
    const std::uint64_t product = static_cast<std::uint64_t>(rows) * static_cast<unsigned>(cols);
    if (product > limit) {
      e.fail("it has " + std::to_string(product) + " values, more than " + std::to_string(limit));
    }
    return static_cast<std::size_t>(product);
  }

  Appearance appearance(hyselam::XmlElement& e) const {
    Appearance a;
    a.type = e.text("type");
    a.rows = e.integer("rows");
    a.cols = e.integer("cols");
    a.values = unpacked(e, count(e, a.rows, a.cols, limits_.max_appearance_values), unpackFloats);
    return a;
  }

  static Wall wall(hyselam::XmlElement& e) {
    Wall wall;
    wall.id = e.id("id");
    const auto kind = wallKindFromExistence(e.number("existence"));
    if (!kind) e.fail("the attribute 'existence' must be 0, 0.5 or 1");
    wall.kind = *kind;
    wall.length = e.number("length");
    wall.height = e.number("height");
    wall.curvature = e.number("curvature");
    wall.vertical_curvature = e.number("vertical_curvature");
    hyselam::Once<UncertainPoint> position, normal;
    hyselam::Once<Covariance2> size;
    e.children(
        [&](hyselam::XmlElement& child) {
          if (child.name() == "position") {
            position.set(child, point(child));
          } else if (child.name() == "normal") {
            normal.set(child, point(child));
          } else if (child.name() == "size_covariance") {
            size.set(child, matrix<4>(child));
          } else {
            return false;
          }
          return true;
        },
        &wall.extras);
    UncertainPoint p = position.take(e, "position");
    wall.position = p.point;
    wall.position_covariance = p.covariance;
    p = normal.take(e, "normal");
    wall.normal = p.point;
    wall.normal_covariance = p.covariance;
    wall.size_covariance = size.takeIfThere();
    return wall;
  }

  VisualSignature signature(hyselam::XmlElement& e) const {
    VisualSignature s;
    s.stamp = e.number("stamp");
    if (e.has("heading")) s.heading = e.number("heading");
    s.aperture_x = e.number("aperture_x");
    s.aperture_y = e.number("aperture_y");
    hyselam::Once<UncertainPoint> position;
    hyselam::Once<Appearance> the_appearance;
    e.children(
        [&](hyselam::XmlElement& child) {
          if (child.name() == "position") {
            position.set(child, point(child));
          } else if (child.name() == "appearance") {
            the_appearance.set(child, appearance(child));
          } else {
            return false;
          }
          return true;
        },
        &s.extras);
    const UncertainPoint p = position.take(e, "position");
    s.position = p.point;
    s.position_covariance = p.covariance;
    s.appearance = the_appearance.take(e, "appearance");
    return s;
  }

  static std::vector<hyselam::Point2> outline(hyselam::XmlElement& e) {
    const std::vector<double> values = e.numbers();
    if (values.size() % 2 != 0) e.fail("the number of coordinates is odd");
    std::vector<hyselam::Point2> points;
    for (std::size_t i = 0; i < values.size(); i += 2) points.push_back({values[i], values[i + 1]});
    return points;
  }

  Place place(hyselam::XmlElement& e) const {
    Place place;
    place.id = e.id("id");
    const auto kind = placeKindFromString(e.text("kind"));
    if (!kind) e.fail("the attribute 'kind' must be room, corridor or virtual");
    place.kind = *kind;
    place.area = e.number("area");
    hyselam::Once<Point3> centre;
    hyselam::Once<std::vector<hyselam::Point2>> the_outline;
    e.children(
        [&](hyselam::XmlElement& child) {
          const std::string name = child.name();
          if (name == "word") {
            place.words.push_back(word(child));
          } else if (name == "centre") {
            centre.set(child, plainPoint(child));
          } else if (name == "outline") {
            the_outline.set(child, outline(child));
          } else if (name == "wall") {
            place.walls.push_back(wall(child));
          } else if (name == "signature") {
            place.signatures.push_back(signature(child));
          } else {
            return false;
          }
          return true;
        },
        &place.extras);
    place.centre = centre.takeIfThere();
    place.outline = the_outline.takeIfThere().value_or(std::vector<hyselam::Point2>{});
    return place;
  }

  Door door(hyselam::XmlElement& e) const {
    Door door;
    door.id = e.id("id");
    const double exists = e.number("existence");
    if (exists != 0.0 && exists != 1.0) e.fail("the attribute 'existence' must be 0 or 1");
    door.real = exists == 1.0;
    const auto state = doorStateFromString(e.text("state"));
    if (!state) e.fail("the attribute 'state' must be unknown, open or closed");
    door.state = *state;
    door.width = e.number("width");
    door.height = e.number("height");
    hyselam::Once<UncertainPoint> position;
    hyselam::Once<Point3> normal;
    hyselam::Once<Appearance> the_appearance;
    e.children(
        [&](hyselam::XmlElement& child) {
          if (child.name() == "position") {
            position.set(child, point(child));
          } else if (child.name() == "normal") {
            normal.set(child, plainPoint(child));
          } else if (child.name() == "appearance") {
            the_appearance.set(child, appearance(child));
          } else {
            return false;
          }
          return true;
        },
        &door.extras);
    const UncertainPoint p = position.take(e, "position");
    door.position = p.point;
    door.position_covariance = p.covariance;
    door.normal = normal.take(e, "normal");
    door.appearance = the_appearance.takeIfThere();
    return door;
  }

  Edge edge(hyselam::XmlElement& e) const {
    Edge edge;
    edge.a = e.id("a");
    edge.b = e.id("b");
    e.children(
        [&](hyselam::XmlElement& child) {
          if (child.name() == "word") {
            edge.words.push_back(word(child));
          } else if (child.name() == "door") {
            edge.doors.push_back(door(child));
          } else {
            return false;
          }
          return true;
        },
        &edge.extras);
    return edge;
  }

  static std::vector<Id> placesOf(hyselam::XmlElement& e) {
    std::vector<Id> ids;
    for (const double value : e.numbers()) {
      if (value < 0.0 || value > 4294967295.0 || value != static_cast<Id>(value)) {
        e.fail("here must be ids of places, or 0");
      }
      ids.push_back(static_cast<Id>(value));
    }
    return ids;
  }

  PlaceGrid grid(hyselam::XmlElement& e) const {
    PlaceGrid grid;
    grid.geometry.width = e.integer("width");
    grid.geometry.height = e.integer("height");
    grid.geometry.resolution = e.number("resolution");
    const std::size_t cells =
        count(e, grid.geometry.height, grid.geometry.width, limits_.max_grid_cells);
    hyselam::Once<hyselam::Pose2> origin;
    hyselam::Once<std::vector<Id>> places;
    hyselam::Once<std::vector<std::uint16_t>> labels;
    e.children([&](hyselam::XmlElement& child) {
      if (child.name() == "origin") {
        origin.set(child, {child.number("x"), child.number("y"), child.number("theta")});
        child.finish();
      } else if (child.name() == "places") {
        places.set(child, placesOf(child));
      } else if (child.name() == "labels") {
        labels.set(child, unpacked(child, cells, unpackShorts));
      } else {
        return false;
      }
      return true;
    });
    grid.geometry.origin = origin.take(e, "origin");
    grid.places = places.take(e, "places");
    grid.labels = labels.take(e, "labels");
    return grid;
  }

  const MapXmlLimits& limits_;
};

}  // namespace

AugmentedTopologicalMap fromXml(const std::string& text, const std::string& source,
                                const MapXmlLimits& limits) {
  AugmentedTopologicalMap map;
  hyselam::readXmlDocument(text, source, limits,
                           [&](hyselam::XmlElement& root) { map = Reader(limits).map(root); });
  checkMap(map, source);
  return map;
}

AugmentedTopologicalMap loadXml(const std::string& path, const MapXmlLimits& limits) {
  return fromXml(hyselam::readTextFile(path, limits.max_bytes), path, limits);
}

}  // namespace hyselam_topo
