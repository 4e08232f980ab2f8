#include <tinyxml2.h>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "packed_bytes.hpp"
#include "xml_format.hpp"

namespace hyselam_topo {
namespace {

using hyselam::formatNumber;

class Writer {
 public:
  explicit Writer(std::string source) : source_(std::move(source)) {}

  std::string write(const AugmentedTopologicalMap& map) {
    out_.PushHeader(false, true);
    open("topological_map");
    attribute("xmlns", xml_format::kNamespace);
    attribute("version", std::to_string(xml_format::kVersion));
    attribute("frame_id", map.frame_id);
    attribute("stamp", map.stamp);
    attribute("next_place_id", map.next_place_id);
    attribute("next_wall_id", map.next_wall_id);
    attribute("next_door_id", map.next_door_id);
    attributes(map.extras);
    for (const Place& place : map.places) write(place);
    for (const Edge& edge : map.edges) write(edge);
    if (map.grid) write(*map.grid);
    elements(map.extras);
    close();
    return out_.CStr();
  }

 private:
  void open(const char* name) { out_.OpenElement(name); }
  void close() { out_.CloseElement(); }
  void attribute(const char* name, const char* value) { out_.PushAttribute(name, value); }
  void attribute(const char* name, const std::string& value) { attribute(name, value.c_str()); }
  void attribute(const char* name, double value) { attribute(name, formatNumber(value)); }
  void attribute(const char* name, Id value) { attribute(name, std::to_string(value)); }
  void attribute(const char* name, int value) { attribute(name, std::to_string(value)); }
  void attribute(const char* name, bool value) { attribute(name, value ? "true" : "false"); }

  void attributes(const Extras& extras) {
    for (const auto& [name, value] : extras.attributes) {
      const bool bad_name =
          name.empty() || name.find_first_of(" \t\r\n=<>&\"'/") != std::string::npos;
      if (bad_name || value.find('\0') != std::string::npos) {
        throw hyselam::InputError(source_, "attribute '" + name + "'", "it is no XML attribute");
      }
      attribute(name.c_str(), value);
    }
  }

  void elements(const Extras& extras) {
    for (const std::string& text : extras.elements) {
      tinyxml2::XMLDocument document;
      const bool good = document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS &&
                        document.RootElement() != nullptr &&
                        document.FirstChild() == document.LastChild();
      if (!good) {
        throw hyselam::InputError(source_, "extra element",
                                  "'" + text + "' is not one XML element");
      }
      document.RootElement()->Accept(&out_);
    }
  }

  template <typename Numbers>
  void numbers(const char* name, const Numbers& values) {
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : " ") + formatNumber(value);
    open(name);
    out_.PushText(text.c_str());
    close();
  }

  void coordinates(const Point3& p) {
    attribute("x", p.x);
    attribute("y", p.y);
    attribute("z", p.z);
  }

  void point(const char* name, const Point3& p, const std::optional<Covariance3>& covariance) {
    open(name);
    coordinates(p);
    if (covariance) numbers("covariance", *covariance);
    close();
  }

  void words(const std::vector<PlaceTerm>& list) {
    for (const PlaceTerm& word : list) {
      open("word");
      attribute("text", word.text);
      attribute("confirmed", word.confirmed);
      close();
    }
  }

  void write(const Appearance& appearance) {
    open("appearance");
    attribute("type", appearance.type);
    attribute("rows", appearance.rows);
    attribute("cols", appearance.cols);
    attribute("encoding", xml_format::kPacking);
    out_.PushText(pack(appearance.values).c_str());
    close();
  }

  void write(const Wall& wall) {
    open("wall");
    attribute("id", wall.id);
    attribute("existence", existence(wall.kind));
    attribute("length", wall.length);
    attribute("height", wall.height);
    attribute("curvature", wall.curvature);
    attribute("vertical_curvature", wall.vertical_curvature);
    attributes(wall.extras);
    point("position", wall.position, wall.position_covariance);
    point("normal", wall.normal, wall.normal_covariance);
    if (wall.size_covariance) numbers("size_covariance", *wall.size_covariance);
    elements(wall.extras);
    close();
  }

  void write(const VisualSignature& signature) {
    open("signature");
    attribute("stamp", signature.stamp);
    if (signature.heading) attribute("heading", *signature.heading);
    attribute("aperture_x", signature.aperture_x);
    attribute("aperture_y", signature.aperture_y);
    attributes(signature.extras);
    point("position", signature.position, signature.position_covariance);
    write(signature.appearance);
    elements(signature.extras);
    close();
  }

  void write(const Place& place) {
    open("place");
    attribute("id", place.id);
    attribute("kind", toString(place.kind));
    attribute("area", place.area);
    attributes(place.extras);
    words(place.words);
    if (place.centre) point("centre", *place.centre, std::nullopt);
    if (!place.outline.empty()) {
      std::vector<double> values;
      for (const hyselam::Point2& p : place.outline) values.insert(values.end(), {p.x, p.y});
      numbers("outline", values);
    }
    for (const Wall& wall : place.walls) write(wall);
    for (const VisualSignature& signature : place.signatures) write(signature);
    elements(place.extras);
    close();
  }

  void write(const Door& door) {
    open("door");
    attribute("id", door.id);
    attribute("existence", door.real ? 1.0 : 0.0);
    attribute("state", toString(door.state));
    attribute("width", door.width);
    attribute("height", door.height);
    attributes(door.extras);
    point("position", door.position, door.position_covariance);
    point("normal", door.normal, std::nullopt);
    if (door.appearance) write(*door.appearance);
    elements(door.extras);
    close();
  }

  void write(const Edge& edge) {
    open("edge");
    attribute("a", edge.a);
    attribute("b", edge.b);
    attributes(edge.extras);
    words(edge.words);
    for (const Door& door : edge.doors) write(door);
    elements(edge.extras);
    close();
  }

  void write(const PlaceGrid& grid) {
    open("grid");
    attribute("width", grid.geometry.width);
    attribute("height", grid.geometry.height);
    attribute("resolution", grid.geometry.resolution);
    open("origin");
    attribute("x", grid.geometry.origin.x);
    attribute("y", grid.geometry.origin.y);
    attribute("theta", grid.geometry.origin.theta);
    close();
    numbers("places", grid.places);
    open("labels");
    attribute("encoding", xml_format::kPacking);
    out_.PushText(pack(grid.labels).c_str());
    close();
    close();
  }

  std::string source_;
  tinyxml2::XMLPrinter out_;
};

}  // namespace

std::string toXml(const AugmentedTopologicalMap& map, const std::string& source) {
  checkMap(map, source);
  return Writer(source).write(map);
}

void saveXml(const std::string& path, const AugmentedTopologicalMap& map) {
  const std::string text = toXml(map, path);
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << text; });
}

}  // namespace hyselam_topo
