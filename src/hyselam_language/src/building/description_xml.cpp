#include "hyselam_language/building/description_xml.hpp"

#include <tinyxml2.h>

#include <algorithm>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/xml_document.hpp"

namespace hyselam_topo {
namespace {

constexpr char kNamespace[] = "urn:hyselam:description:1";
constexpr int kVersion = 2;  // 1 has no certainties

/// The oldest version that holds it, so that older programs read what they can.
int versionOf(const DescribedBuilding& building) {
  const auto& all = building.connections;
  return std::all_of(all.begin(), all.end(),
                     [](const DescribedConnection& each) {
                       return each.side_certainty == 1.0 && each.order_certainty == 1.0;
                     })
             ? 1
             : kVersion;
}

class Writer {
 public:
  std::string write(const DescribedBuilding& building) {
    out_.PushHeader(false, true);
    out_.OpenElement("description");
    attribute("xmlns", kNamespace);
    attribute("version", std::to_string(versionOf(building)));
    if (building.robot_place) attribute("robot_place", *building.robot_place);
    if (building.place_count) attribute("place_count", std::to_string(*building.place_count));
    for (const DescribedPlace& place : building.places) write(place);
    for (const DescribedConnection& connection : building.connections) write(connection);
    for (const DescribedRelation& relation : building.relations) write(relation);
    out_.CloseElement();
    return out_.CStr();
  }

 private:
  void attribute(const char* name, const std::string& value) {
    out_.PushAttribute(name, value.c_str());
  }
  void attribute(const char* name, Id value) { attribute(name, std::to_string(value)); }
  void attribute(const char* name, const std::optional<double>& value) {
    if (value) attribute(name, hyselam::formatNumber(*value));
  }

  void attribute(const char* name, const std::optional<int>& value) {
    if (value) attribute(name, std::to_string(*value));
  }

  void attribute(const std::optional<hyselam::Pose2>& seen_from) {
    if (!seen_from) return;
    attribute("seen_x", hyselam::formatNumber(seen_from->x));
    attribute("seen_y", hyselam::formatNumber(seen_from->y));
    attribute("seen_heading", hyselam::formatNumber(seen_from->theta));
  }

  void write(const DescribedPlace& place) {
    out_.OpenElement("place");
    attribute("id", place.id);
    attribute("name", place.name);
    if (place.kind) attribute("kind", toString(*place.kind));
    attribute("length", place.length);
    attribute("width", place.width);
    attribute("area", place.area);
    attribute("parts", place.parts);
    if (place.size_word) attribute("size_word", toString(*place.size_word));
    attribute("doors", place.doors);
    attribute("floor", place.floor);
    for (const std::string& alias : place.aliases) {
      out_.OpenElement("alias");
      attribute("name", alias);
      out_.CloseElement();
    }
    out_.CloseElement();
  }

  void write(const DescribedConnection& connection) {
    out_.OpenElement("connection");
    attribute("from", connection.from);
    attribute("to", connection.to);
    attribute("side", toString(connection.side));
    attribute("order", std::to_string(connection.order));
    attribute("rank", connection.rank);
    attribute("distance", connection.distance);
    if (connection.side_certainty != 1.0)
      attribute("side_certainty", std::optional(connection.side_certainty));
    if (connection.order_certainty != 1.0)
      attribute("order_certainty", std::optional(connection.order_certainty));
    attribute(connection.seen_from);
    out_.CloseElement();
  }

  void write(const DescribedRelation& relation) {
    out_.OpenElement("relation");
    attribute("kind", toString(relation.kind));
    attribute("a", relation.a);
    attribute("b", relation.b);
    if (relation.c != 0) attribute("c", relation.c);
    if (relation.side != Side::kUnknown) attribute("side", toString(relation.side));
    if (relation.denied) attribute("denied", "true");
    attribute(relation.seen_from);
    out_.CloseElement();
  }

  tinyxml2::XMLPrinter out_;
};

template <typename Enum>
Enum oneOf(hyselam::XmlElement& e, const char* attribute,
           std::optional<Enum> (*parse)(const std::string&), const std::string& allowed) {
  const auto value = parse(e.text(attribute));
  if (!value) e.fail("the attribute '" + std::string(attribute) + "' must be " + allowed);
  return *value;
}

std::optional<int> count(hyselam::XmlElement& e, const char* attribute) {
  return e.has(attribute) ? std::optional<int>(e.integer(attribute)) : std::nullopt;
}

DescribedPlace readPlace(hyselam::XmlElement& e) {
  const auto size = [&e](const char* name) {
    return e.has(name) ? std::optional<double>(e.number(name)) : std::nullopt;
  };
  DescribedPlace place;
  place.id = e.id("id");
  place.name = e.text("name");
  if (e.has("kind"))
    place.kind = oneOf(e, "kind", placeKindFromString, "room, corridor or virtual");
  place.length = size("length");
  place.width = size("width");
  place.area = size("area");
  place.parts = count(e, "parts");
  if (e.has("size_word")) place.size_word = oneOf(e, "size_word", sizeWordOf, "small or large");
  place.doors = count(e, "doors");
  place.floor = count(e, "floor");
  e.children([&](hyselam::XmlElement& child) {
    if (child.name() != "alias") return false;
    place.aliases.push_back(child.text("name"));
    child.finish();
    return true;
  });
  return place;
}

std::optional<hyselam::Pose2> readView(hyselam::XmlElement& e) {
  if (!e.has("seen_x") && !e.has("seen_y") && !e.has("seen_heading")) return std::nullopt;
  return hyselam::Pose2{e.number("seen_x"), e.number("seen_y"), e.number("seen_heading")};
}

DescribedConnection readConnection(hyselam::XmlElement& e) {
  DescribedConnection connection;
  connection.from = e.id("from");
  connection.to = e.id("to");
  connection.side = oneOf(e, "side", sideOf, "unknown, front, left, back or right");
  const int order = e.integer("order");
  if (order < 0) e.fail("the attribute 'order' is negative");
  connection.order = static_cast<std::size_t>(order);
  connection.rank = count(e, "rank");
  if (e.has("distance")) connection.distance = e.number("distance");
  if (e.has("side_certainty")) connection.side_certainty = e.number("side_certainty");
  if (e.has("order_certainty")) connection.order_certainty = e.number("order_certainty");
  connection.seen_from = readView(e);
  e.finish();
  return connection;
}

DescribedRelation readRelation(hyselam::XmlElement& e) {
  DescribedRelation relation;
  relation.kind = oneOf(e, "kind", relationKindOf,
                        "next_to, opposite, between, at_end_of, inside, after, behind, larger, "
                        "joined, at_side");
  relation.a = e.id("a");
  relation.b = e.id("b");
  if (e.has("c")) relation.c = e.id("c");
  if (e.has("side")) {
    relation.side = oneOf(e, "side", sideOf, "unknown, front, left, back or right");
  }
  if (e.has("denied")) relation.denied = e.text("denied") == "true";
  relation.seen_from = readView(e);
  e.finish();
  return relation;
}

DescribedBuilding readDescription(hyselam::XmlElement& e) {
  if (e.name() != "description" || !e.has("xmlns") || e.text("xmlns") != kNamespace) {
    e.fail("this is no description: the first element must be <description xmlns=\"" +
           std::string(kNamespace) + "\">");
  }
  if (e.text("version") != "1" && e.text("version") != std::to_string(kVersion)) {
    e.fail(hyselam::versionRefusal(e.text("version"), {1, kVersion}));
  }
  DescribedBuilding building;
  if (e.has("robot_place")) building.robot_place = e.id("robot_place");
  if (e.has("place_count")) building.place_count = e.integer("place_count");
  e.children([&](hyselam::XmlElement& child) {
    if (child.name() == "place") {
      building.places.push_back(readPlace(child));
    } else if (child.name() == "connection") {
      building.connections.push_back(readConnection(child));
    } else if (child.name() == "relation") {
      building.relations.push_back(readRelation(child));
    } else {
      return false;
    }
    return true;
  });
  return building;
}

}  // namespace

std::string toXml(const DescribedBuilding& building, const std::string& source) {
  checkDescription(building, source);
  return Writer().write(building);
}

DescribedBuilding descriptionFromXml(const std::string& text, const std::string& source,
                                     const hyselam::XmlLimits& limits) {
  DescribedBuilding building;
  hyselam::readXmlDocument(text, source, limits,
                           [&](hyselam::XmlElement& root) { building = readDescription(root); });
  checkDescription(building, source);
  return building;
}

void saveXml(const std::string& path, const DescribedBuilding& building) {
  const std::string text = toXml(building, path);
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << text; });
}

DescribedBuilding loadDescription(const std::string& path, const hyselam::XmlLimits& limits) {
  return descriptionFromXml(hyselam::readTextFile(path, limits.max_bytes), path, limits);
}

}  // namespace hyselam_topo
