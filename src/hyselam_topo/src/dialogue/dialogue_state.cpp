#include "hyselam_topo/dialogue/dialogue_state.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/json_integer.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace hyselam_topo {
namespace {

using hyselam::InputError;
using nlohmann::json;

constexpr char kFormat[] = "hyselam_dialogue";
constexpr int kOldest = 1;
constexpr int kNewest = 2;  // with a shelf
constexpr std::size_t kMaxBytes = std::size_t{1} << 30;

double numberAt(const json& j, const char* key) {
  if (!j.is_object() || !j.contains(key) || !j.at(key).is_number()) {
    throw std::runtime_error(std::string("'") + key + "' must be a number");
  }
  return j.at(key).get<double>();
}

}  // namespace

std::string toText(const DialogueState& state) {
  json j;
  j["language"] = state.language;
  j["map"] = state.places.map.places.empty() ? "" : toXml(state.places.map, "map");
  j["description"] =
      state.description.places.empty() ? "" : toXml(state.description, "description");
  if (state.heading) j["heading"] = *state.heading;
  if (state.position) j["position"] = {{"x", state.position->x}, {"y", state.position->y}};
  if (state.told_at != 0) j["told_at"] = state.told_at;
  j["walls"] = json::array();
  for (const DescribedWall& wall : state.places.walls) {
    j["walls"].push_back({{"ax", wall.line.a.x},
                          {"ay", wall.line.a.y},
                          {"bx", wall.line.b.x},
                          {"by", wall.line.b.y},
                          {"existence", existence(wall.kind)}});
  }
  j["rejected"] = json::array();
  for (const auto& [place, name] : state.places.rejected) {
    j["rejected"].push_back({{"place", place}, {"name", name}});
  }
  for (const ShelvedMap& map : state.places.shelf) j["shelf"].push_back(toXml(map, "shelf"));
  const int version = state.places.shelf.empty() ? kOldest : kNewest;
  const std::string body = j.dump(1) + "\n";
  char head[80];
  std::snprintf(head, sizeof head, "%s %d %s %zu\n", kFormat, version,
                hyselam::crc32Text(body).c_str(), body.size());
  return head + body;
}

DialogueState dialogueStateFromText(const std::string& text, const std::string& source) {
  std::istringstream head(text.substr(0, text.find('\n')));
  std::string format, version;
  unsigned long crc = 0;
  std::size_t size = 0;
  head >> format >> version >> std::hex >> crc >> std::dec >> size;
  if (format != kFormat) throw InputError(source, "line 1", "this is no state of a dialogue");
  if (version != std::to_string(kOldest) && version != std::to_string(kNewest)) {
    throw InputError(source, "line 1", hyselam::versionRefusal(version, {kOldest, kNewest}));
  }
  const std::size_t begin = text.find('\n') + 1;
  if (head.fail() || text.find('\n') == std::string::npos || text.size() - begin != size) {
    throw InputError(source, "", "it is not complete");
  }
  const std::string body = text.substr(begin);
  if (hyselam::crc32Of(body) != crc)
    throw InputError(source, "", "it is damaged: the checksum is wrong");
  DialogueState state;
  try {
    const json j = json::parse(body);
    state.language = j.at("language").get<std::string>();
    const auto map = j.at("map").get<std::string>();
    if (!map.empty()) state.places.map = fromXml(map, source + ": map");
    const auto description = j.at("description").get<std::string>();
    if (!description.empty()) {
      state.description = descriptionFromXml(description, source + ": description");
    }
    if (j.contains("heading")) state.heading = numberAt(j, "heading");
    if (j.contains("position"))
      state.position =
          hyselam::Point2{numberAt(j.at("position"), "x"), numberAt(j.at("position"), "y")};
    if (j.contains("told_at")) state.told_at = hyselam::integerOf<Id>(j.at("told_at"));
    for (const json& w : j.at("walls")) {
      DescribedWall wall;
      wall.line = {{numberAt(w, "ax"), numberAt(w, "ay")}, {numberAt(w, "bx"), numberAt(w, "by")}};
      const auto kind = wallKindFromExistence(numberAt(w, "existence"));
      if (!kind) throw std::runtime_error("the existence of a wall is 0 or 0.5");
      wall.kind = *kind;
      state.places.walls.push_back(wall);
    }
    for (const json& r : j.at("rejected")) {
      state.places.rejected.emplace_back(hyselam::integerOf<Id>(r.at("place")),
                                         r.at("name").get<std::string>());
    }
    if (version == std::to_string(kOldest)) return state;
    for (const json& shelved : j.at("shelf")) {
      state.places.shelf.push_back(fromXml(shelved.get<std::string>(), source + ": shelf"));
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    throw InputError(source, "", e.what());
  }
  return state;
}

void saveDialogueState(const std::string& path, const DialogueState& state) {
  const std::string text = toText(state);
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << text; });
}

DialogueState loadDialogueState(const std::string& path) {
  return dialogueStateFromText(hyselam::readTextFile(path, kMaxBytes), path);
}

}  // namespace hyselam_topo
