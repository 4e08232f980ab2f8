// Statements written as outlines, for tests of what they mean whatever the grammars know.
#pragma once

#include <algorithm>
#include <set>
#include <sstream>
#include <string>

#include "hyselam_common/numbers.hpp"
#include "hyselam_language/grammar/utterance.hpp"

namespace hyselam_topo {
namespace testing {

/// "no located places=meeting_room,<it> side=left nth=2 distance=10": "no" first is a correction;
/// names with _ for spaces, "quoted" or my:office, references in < >.
inline Utterance said(const std::string& outline) {
  static const std::set<std::string> kWords{
      "side",     "nth",     "size_word", "floor",   "denied",    "kind", "named",
      "from_end", "instead", "was_side",  "was_nth", "room_kind", "moved"};
  static const std::set<std::string> kNumbers{"count", "doors",  "distance", "steps",
                                              "area",  "length", "width"};
  Utterance u;
  u.kind = UtteranceKind::kStatement;
  u.text = outline;
  u.range = {0, outline.size()};
  std::istringstream in(outline);
  std::string part;
  while (in >> part) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos) {
      if (part == "no") {
        u.correction = true;
      } else {
        u.intent = part;
      }
      continue;
    }
    Slot slot;
    slot.name = part.substr(0, equals);
    std::string value = part.substr(equals + 1);
    // "instead" is a name in "replace name=B instead=A".
    const bool replaces = u.intent == "replace" || u.intent == "replace_number";
    if (kWords.count(slot.name) != 0 && !replaces) {
      slot.word = value;
    } else if (kNumbers.count(slot.name) != 0 || u.intent == "replace_number") {
      slot.number = hyselam::parseNumber(value);
    } else {
      slot.type = "place";
      std::istringstream names(value);
      std::string text;
      while (std::getline(names, text, ',')) {
        SaidName name;
        std::replace(text.begin(), text.end(), '_', ' ');
        if (text.front() == '<') {
          name.reference = text.substr(1, text.size() - 2);
        } else if (text.front() == '"') {
          name.quoted = true;
          text = text.substr(1, text.size() - 2);
        } else if (text.compare(0, 3, "my:") == 0) {
          name.speaker = true;
          text.erase(0, 3);
        }
        name.text = text;
        slot.names.push_back(name);
      }
    }
    u.slots.push_back(slot);
  }
  return u;
}

}  // namespace testing
}  // namespace hyselam_topo
