// Descriptions and utterances as short lines that a corpus can state.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/numbers.hpp"
#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/grammar/utterance.hpp"

namespace hyselam_topo {
namespace testing {

inline std::string shown(double value) {
  return hyselam::formatNumber(std::round(value * 1000.0) / 1000.0);
}

/// Sorted lines, the same for descriptions that differ in ids and in the order of statements only:
///   at corridor | corridor left A > B | kitchen joins laundry | A size 6x8 | A area 48 | A length
///   6 | A aka B > C | A parts 3 | A kind corridor (with `kinds`) | count 6 | A next_to B | A
///   between B | C | A after B | C | place A (nothing else described) | A doors 2 | A floor -1 | A
///   small
/// A rank stands behind "#", a distance behind "@": corridor left A > B#2 > C#-1@10. Denials begin
/// with "not": not A next_to B | not A at_side left B. The second place of a name is "toilet~2".
inline std::vector<std::string> outline(const DescribedBuilding& building, bool kinds = false) {
  std::vector<std::string> lines;
  std::map<Id, bool> told;
  const auto nameOf = [&](Id id) {
    const std::string& name = building.findPlace(id)->name;
    const auto number = std::count_if(
        building.places.begin(), building.places.end(),
        [&](const DescribedPlace& other) { return other.name == name && other.id <= id; });
    return number > 1 ? name + "~" + std::to_string(number) : name;
  };
  const auto name = [&](Id id) {
    told[id] = true;
    return nameOf(id);
  };
  if (building.robot_place) lines.push_back("at " + name(*building.robot_place));
  if (building.place_count) lines.push_back("count " + std::to_string(*building.place_count));
  std::map<std::pair<Id, Side>, std::vector<std::pair<std::size_t, std::string>>> rows;
  for (const DescribedConnection& each : building.connections) {
    const std::string to = name(each.to) +
                           (each.rank ? "#" + std::to_string(*each.rank) : std::string()) +
                           (each.distance ? "@" + shown(*each.distance) : std::string());
    if (each.side == Side::kUnknown) {
      lines.push_back(name(each.from) + " joins " + to);
    } else {
      rows[{each.from, each.side}].emplace_back(each.order, to);
    }
  }
  for (auto& [from, row] : rows) {
    std::sort(row.begin(), row.end());
    std::string line = name(from.first) + " " + toString(from.second);
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += (i == 0 ? " " : " > ") + row[i].second;
      if (row[i].first != i) line += "(" + std::to_string(row[i].first) + ")";
    }
    lines.push_back(line);
  }
  for (const DescribedRelation& each : building.relations) {
    const std::string side =
        each.side == Side::kUnknown ? "" : std::string(" ") + toString(each.side);
    lines.push_back((each.denied ? "not " : "") + name(each.a) + " " + toString(each.kind) + side +
                    " " + name(each.b) + (each.c != 0 ? " | " + name(each.c) : ""));
  }
  for (const DescribedPlace& place : building.places) {
    const auto add = [&](const std::string& what) {
      lines.push_back(nameOf(place.id) + " " + what);
      told[place.id] = true;
    };
    if (place.length && place.width) {
      add("size " + shown(*place.length) + "x" + shown(*place.width));
    } else {
      if (place.length) add("length " + shown(*place.length));
      if (place.width) add("width " + shown(*place.width));
      if (place.area) add("area " + shown(*place.area));
    }
    if (place.size_word) add(toString(*place.size_word));
    if (place.doors) add("doors " + std::to_string(*place.doors));
    if (place.floor) add("floor " + std::to_string(*place.floor));
    if (place.parts) add("parts " + std::to_string(*place.parts));
    if (kinds && place.kind) add(std::string("kind ") + toString(*place.kind));
    for (std::size_t i = 0; i < place.aliases.size(); ++i) {
      if (i == 0) {
        add("aka " + place.aliases[0]);
      } else {
        lines.back() += " > " + place.aliases[i];
      }
    }
  }
  for (const DescribedPlace& place : building.places) {
    if (!told[place.id]) lines.push_back("place " + nameOf(place.id));
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

/// "go_to places=I-110,corridor": the intent and its slots in the order of their names.
inline std::string outline(const Utterance& utterance) {
  if (!utterance.understood()) return "? " + utterance.reason_code;
  std::map<std::string, std::string> slots;
  for (const Slot& slot : utterance.slots) {
    std::string& text = slots[slot.name];
    if (slot.number) text = shown(*slot.number);
    if (!slot.word.empty()) text = slot.word;
    for (const SaidName& name : slot.names) {
      text += (text.empty() ? "" : ",") +
              (name.reference.empty() ? name.text : "<" + name.reference + ">");
    }
  }
  std::string line = utterance.intent;
  for (const auto& [name, text] : slots) line += " " + name + "=" + text;
  return line;
}

}  // namespace testing
}  // namespace hyselam_topo
