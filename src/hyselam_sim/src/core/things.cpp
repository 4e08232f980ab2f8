#include "hyselam_sim/things.hpp"

#include <set>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/yaml_text.hpp"
#include "yaml_map.hpp"

namespace hyselam_sim {
namespace {

/// Three numbers within the range.
template <typename Number>
void readThree(const YamlMap& map, const std::string& key, double low, double high,
               std::array<Number, 3>* three) {
  if (!map.has(key)) return;
  const YAML::Node node = map.child(key);
  if (!node.IsSequence() || node.size() != 3) map.fail(key, "must be three numbers");
  for (std::size_t i = 0; i < 3; ++i) {
    (*three)[i] =
        static_cast<Number>(YamlMap::numberIn(map.source(), map.pathOf(key), node[i], low, high));
  }
}

Thing readThing(const YamlMap& map) {
  constexpr double kSmallest = 0.005, kLargest = 5.0;  // [m]
  Thing thing;
  thing.name = map.text("name");
  thing.kind = map.textOr("kind", thing.name);
  if (map.choice("shape", {"box", "cylinder"}, "box") == "cylinder") {
    thing.shape = Thing::Shape::kCylinder;
  }
  const Point2 at = map.point("at");
  thing.pose = {at.x, at.y, hyselam::radians(map.numberOr("turn", 0.0, -360.0, 360.0))};
  thing.z = map.numberOr("above_floor", thing.z, 0.0, 100.0);
  readThree(map, "size", kSmallest, kLargest, &thing.size);
  readThree(map, "colour", 0.0, 1.0, &thing.color);
  return thing;
}

}  // namespace

std::vector<Thing> parseThings(const std::string& text, const std::string& source) {
  const YamlMap map(source, "", hyselam::parseYaml(text, source), {"things"});
  std::vector<Thing> things;
  std::set<std::string> names;
  const std::vector<YAML::Node> entries = map.list("things");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const YamlMap entry(source, "things[" + std::to_string(i) + "]", entries[i],
                        {"name", "kind", "shape", "at", "above_floor", "size", "turn", "colour"});
    things.push_back(readThing(entry));
    if (!names.insert(things.back().name).second) {
      entry.fail("name", "'" + things.back().name + "' was given before");
    }
  }
  return things;
}

std::vector<Thing> loadThings(const std::string& path) {
  constexpr std::size_t kMaxFileBytes = 1 << 20;
  return parseThings(hyselam::readTextFile(path, kMaxFileBytes), path);
}

}  // namespace hyselam_sim
