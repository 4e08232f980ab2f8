#include <yaml-cpp/yaml.h>

#include "hyselam_sim/generate_plan.hpp"

namespace hyselam_sim {
namespace {

void put(YAML::Emitter& out, Point2 p) {
  out << YAML::Flow << YAML::BeginSeq << p.x << p.y << YAML::EndSeq;
}

void put(YAML::Emitter& out, const std::vector<Point2>& points) {
  out << YAML::Flow << YAML::BeginSeq;
  for (const Point2& p : points) put(out, p);
  out << YAML::EndSeq;
}

template <typename Items, typename PutOne>
void list(YAML::Emitter& out, const char* key, const Items& items, PutOne put_one) {
  if (items.empty()) return;
  out << YAML::Key << key << YAML::Value << YAML::Block << YAML::BeginSeq;
  for (const auto& item : items) {
    out << YAML::Flow << YAML::BeginMap;
    if (!item.name.empty()) out << YAML::Key << "name" << YAML::Value << item.name;
    put_one(item);
    out << YAML::EndMap;
  }
  out << YAML::Block << YAML::EndSeq;
}

}  // namespace

std::string toYaml(const FloorPlan& plan) {
  YAML::Emitter out;
  out.SetDoublePrecision(17);
  const auto key = [&](const char* name) -> YAML::Emitter& {
    return out << YAML::Key << name << YAML::Value;
  };
  out << YAML::BeginMap;
  key("plan") << plan.name;
  if (!plan.description.empty()) key("description") << plan.description;
  put(key("origin"), plan.origin);
  put(key("size"), plan.size);
  list(out, "walls", plan.walls, [&](const PlanWall& wall) {
    key("closed") << wall.closed;
    key("thickness") << wall.thickness;
    key("height") << wall.height;
    put(key("points"), wall.points);
  });
  list(out, "doors", plan.doors, [&](const PlanDoor& door) {
    put(key("at"), door.at);
    key("width") << door.width;
    if (door.swing != PlanDoor::Swing::kNone) {
      key("swing") << (door.swing == PlanDoor::Swing::kLeft ? "left" : "right");
      key("hinge") << (door.hinge == PlanDoor::Hinge::kEnd ? "end" : "start");
    }
    if (!door.initially_open) key("open") << false;
    if (!door.schedule.empty()) {
      key("schedule") << YAML::BeginSeq;
      for (const PlanDoor::Change& change : door.schedule) {
        out << YAML::BeginMap;
        key("from") << change.time;
        key("open") << change.open;
        out << YAML::EndMap;
      }
      out << YAML::EndSeq;
    }
  });
  list(out, "furniture", plan.furniture, [&](const Furniture& item) {
    put(key("polygon"), item.outline);
    key("height") << item.height;
  });
  list(out, "places", plan.places, [&](const PlanPlace& place) {
    put(key("at"), place.at);
    if (!place.outline.empty()) put(key("polygon"), place.outline);
  });
  if (!plan.inside.empty()) put(key("inside"), plan.inside);
  if (!plan.floor_kind.empty()) key("floor_kind") << plan.floor_kind;
  if (!plan.areas.empty()) {
    key("areas") << YAML::BeginSeq;
    for (const Area& area : plan.areas) {
      out << YAML::Flow << YAML::BeginMap;
      key("kind") << area.kind;
      put(key("polygon"), area.outline);
      out << YAML::EndMap;
    }
    out << YAML::EndSeq;
  }
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

}  // namespace hyselam_sim
