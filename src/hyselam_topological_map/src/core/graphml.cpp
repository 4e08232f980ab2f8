#include <tinyxml2.h>

#include <algorithm>

#include "hyselam_common/numbers.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace hyselam_topo {
namespace {

struct Key {
  const char* id;
  const char* owner;
  const char* type;
};
constexpr Key kKeys[] = {{"label", "all", "string"},  {"words", "node", "string"},
                         {"kind", "node", "string"},  {"area", "node", "double"},
                         {"x", "node", "double"},     {"y", "node", "double"},
                         {"doors", "edge", "int"},    {"width", "edge", "double"},
                         {"real", "edge", "boolean"}, {"closed", "edge", "boolean"}};

std::string joined(const std::vector<PlaceTerm>& words) {
  std::string text;
  for (const PlaceTerm& word : words) text += (text.empty() ? "" : ", ") + word.text;
  return text;
}

void data(tinyxml2::XMLPrinter* out, const char* key, const std::string& value) {
  out->OpenElement("data", true);
  out->PushAttribute("key", key);
  out->PushText(value.c_str());
  out->CloseElement(true);
}

void write(const Place& place, tinyxml2::XMLPrinter* out) {
  const std::string number = std::to_string(place.id);
  out->OpenElement("node");
  out->PushAttribute("id", ("p" + number).c_str());
  data(out, "label",
       place.words.empty() ? toString(place.kind) + (" " + number) : place.words.front().text);
  data(out, "words", joined(place.words));
  data(out, "kind", toString(place.kind));
  data(out, "area", hyselam::formatNumber(place.area));
  if (place.centre) {
    data(out, "x", hyselam::formatNumber(place.centre->x));
    data(out, "y", hyselam::formatNumber(place.centre->y));
  }
  out->CloseElement();
}

void write(const Edge& edge, tinyxml2::XMLPrinter* out) {
  out->OpenElement("edge");
  out->PushAttribute("source", ("p" + std::to_string(edge.a)).c_str());
  out->PushAttribute("target", ("p" + std::to_string(edge.b)).c_str());
  data(out, "label", joined(edge.words));
  data(out, "doors", std::to_string(edge.doors.size()));
  if (!edge.doors.empty()) {
    double width = 0.0;
    bool real = false, closed = true;
    for (const Door& door : edge.doors) {
      width = std::max(width, door.width);
      real = real || door.real;
      closed = closed && door.state == DoorState::kClosed;
    }
    data(out, "width", hyselam::formatNumber(width));
    data(out, "real", real ? "true" : "false");
    data(out, "closed", closed ? "true" : "false");
  }
  out->CloseElement();
}

}  // namespace

std::string toGraphMl(const AugmentedTopologicalMap& map) {
  checkMap(map, "map");
  tinyxml2::XMLPrinter out;
  out.PushHeader(false, true);
  out.OpenElement("graphml");
  out.PushAttribute("xmlns", "http://graphml.graphdrawing.org/xmlns");
  for (const Key& key : kKeys) {
    out.OpenElement("key");
    out.PushAttribute("id", key.id);
    out.PushAttribute("for", key.owner);
    out.PushAttribute("attr.name", key.id);
    out.PushAttribute("attr.type", key.type);
    out.CloseElement();
  }
  out.OpenElement("graph");
  out.PushAttribute("id", "places");
  out.PushAttribute("edgedefault", "undirected");
  for (const Place& place : map.places) write(place, &out);
  for (const Edge& edge : map.edges) write(edge, &out);
  out.CloseElement();
  out.CloseElement();
  return out.CStr();
}

}  // namespace hyselam_topo
