#include "hyselam_topo/dialogue/phrases.hpp"

#include <algorithm>
#include <cstdio>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/yaml_text.hpp"
#include "shipped_phrases.hpp"

namespace hyselam_topo {
namespace {

using hyselam::InputError;

/// All phrases and the words that may be filled into them.
constexpr std::pair<const char*, const char*> kPhrases[] = {
    {"at_unknown", ""},
    {"at_code", "code"},
    {"at_named", "code names"},
    {"in_doorway", ""},
    {"perhaps", "name"},
    {"perhaps_is", "name"},
    {"ask_confirm", "names"},
    {"ask_confirm_there", "code names"},
    {"ask_also", "known names name"},
    {"ask_name", ""},
    {"ask_name_there", "code"},
    {"named", "code names"},
    {"moved_name", "code"},
    {"rejected", "names"},
    {"forgot_names", "places"},
    {"no_longer_sure", "code names"},
    {"undo_of_things", ""},
    {"undo_behind_things", "text"},
    {"no_names", "places"},
    {"forgot_name", "name"},
    {"names_again", "code names"},
    {"taken_back", ""},
    {"cannot_take_back", ""},
    {"cannot_take_back_gone", ""},
    {"statement_taken_back", "text"},
    {"ask_also_there", "code known names name"},
    {"forgot_all", ""},
    {"no_place_here", ""},
    {"ask_new_name", "name"},
    {"ask_new_name_there", "name"},
    {"say_otherwise", ""},
    {"ask_forget_all", ""},
    {"ask_proposal", "suggestion"},
    {"ask_go", "names places"},
    {"ask_moved", "moves"},
    {"told_moved", "moves"},
    {"moved_item", "name from to"},
    {"lost_names", "names"},
    {"hello_name", "name"},
    {"noted", "text"},
    {"known", ""},
    {"not_taken", "text"},
    {"left_out", "text"},
    {"not_taken_down_say", "suggestion"},
    {"not_understood_part", "text"},
    {"not_understood_say", "text reason suggestion"},
    {"found", "found told confirmed"},
    {"not_found", "names"},
    {"several", "number names"},
    {"many_fit", "names"},
    {"likely", "items"},
    {"likely_item", "name code"},
    {"unsure", "names"},
    {"no_map", ""},
    {"cannot_match", "reason"},
    {"issue", "text reason"},
    {"notice", "text reason"},
    {"taken_down", ""},
    {"ask_wall", "wall distance side length"},
    {"ask_wall_length", "wall"},
    {"no_corners", "side wall"},
    {"wall_added", "wall"},
    {"door_shut", ""},
    {"door_open", ""},
    {"shut_in_the_way", "places"},
    {"wall_in_the_way", "wall places"},
    {"wall_forgotten", "wall"},
    {"no_wall", ""},
    {"no_grid", ""},
    {"ask_radius", ""},
    {"virtual_added", "code"},
    {"virtual_gone", "code"},
    {"not_possible", "reason"},
    {"going", "places"},
    {"no_way", "place"},
    {"door_closed", ""},
    {"unknown_place", "name"},
    {"not_on_this_map", "name"},
    {"out_of_sight", "count"},
    {"out_of_sight_one", ""},
    {"seen_again", "count"},
    {"seen_again_one", ""},
    {"which_place", "places"},
    {"no_previous", ""},
    {"following", ""},
    {"stopped", ""},
    {"turning", "side"},
    {"cancelled", ""},
    {"yes", ""},
    {"no", ""},
    {"where_is", "name code length"},
    {"where_is_here", "name code"},
    {"where_is_no_way", "name code"},
    {"way", "place length places"},
    {"next_to", "place places"},
    {"next_behind", "place places"},
    {"next_to_behind", "place places"},
    {"next_to_nothing", "place"},
    {"opposite_unknown", "place"},
    {"opposite", "place places"},
    {"on_side", "side places"},
    {"nothing_on_side", "side"},
    {"size", "place area"},
    {"size_unknown", "place"},
    {"places", "count places"},
    {"places_named", "count named places"},
    {"told", "text"},
    {"told_nothing", ""},
    {"told_only", "name"},
    {"known_place", "places"},
    {"owners", "names"},
    {"owner_unknown", "place"},
    {"person_unknown", "name"},
    {"not_known", ""},
    {"no_since", "reason"},
    {"found_there", "places"},
    {"how_many", "count names"},
    {"speaker", "name"},
    {"speaker_unknown", ""},
    {"cannot_follow", ""},
    {"cannot_come", ""},
    {"cannot_carry", ""},
    {"cannot_carry_there", "place"},
    {"help", ""},
    {"hello", ""},
    {"welcome", ""},
    {"not_understood", "text reason"},
    {"only_languages", ""},
    {"nothing_asked", ""},
    {"nobody_answers", ""},
    {"ask_where", "code"},
    {"ask_pose", "names code here"},
    {"starts_from", "code names"},
    {"far_apart", "a code_a b code_b distance"},
    {"is_elsewhere", "a code_a b code_b"},
    {"ask_open", ""},
    {"no_shut_door", ""},
    {"no_door", "place"},
    {"which_door", "places"},
    {"not_so", "code names"},
    {"confirmed_all", "places"},
    {"nothing_to_confirm", ""},
    {"not_so_any_more", "names"},
    {"not_taken_down", ""},
    {"nowhere_to_go_on", ""},
    {"cannot_do", ""}};

const std::map<std::string, std::set<std::string>>& knownPhrases() {
  static const auto known = [] {
    std::map<std::string, std::set<std::string>> all;
    for (const auto& [key, words] : kPhrases) {
      std::istringstream list(words);
      std::set<std::string>& slots = all[key];
      for (std::string word; list >> word;) slots.insert(word);
    }
    return all;
  }();
  return known;
}

/// The words in braces. Throws with the reason if a brace is left open.
std::set<std::string> slotsOf(const std::string& text) {
  std::set<std::string> slots;
  for (std::size_t i = text.find('{'); i != std::string::npos; i = text.find('{', i + 1)) {
    const std::size_t end = text.find('}', i);
    if (end == std::string::npos) throw std::runtime_error("a brace is not closed");
    slots.insert(text.substr(i + 1, end - i - 1));
  }
  return slots;
}

class Reader {
 public:
  Reader(const std::string& source, const std::string& yaml)
      : source_(source), root_(hyselam::parseYaml(yaml, source)) {
    if (!root_.IsMap()) throw InputError(source, "", "it is no YAML map");
  }

  std::string text(const YAML::Node& node, const std::string& key) const {
    const YAML::Node value = node[key];
    if (!value || !value.IsScalar()) fail(key, "it must be there and be a text");
    return value.Scalar();
  }
  std::string text(const std::string& key) const { return text(root_, key); }

  /// All texts of a map, whose keys must be those known.
  std::map<std::string, std::string> texts(const std::string& key,
                                           const std::set<std::string>& known) const {
    const YAML::Node node = root_[key];
    if (!node || !node.IsMap()) fail(key, "it must be there and be a map");
    std::map<std::string, std::string> all;
    const std::string within = key + "/";
    for (const auto& entry : node) {
      const auto name = entry.first.as<std::string>("");
      if (known.count(name) == 0) fail(within + name, "I know no such key");
      all[name] = text(node, name);
    }
    for (const std::string& name : known) {
      if (all.count(name) == 0) fail(within + name, "it is missing");
    }
    return all;
  }

  /// All texts of a map, whatever their keys; none if it is missing.
  std::map<std::string, std::string> anyTexts(const std::string& key) const {
    std::map<std::string, std::string> all;
    const YAML::Node node = root_[key];
    if (!node) return all;
    if (!node.IsMap()) fail(key, "it must be a map");
    for (const auto& entry : node) {
      const auto name = entry.first.as<std::string>("");
      if (name.find(' ') == std::string::npos) fail(key + "/" + name, "it must be two words");
      all[name] = text(node, name);
    }
    return all;
  }

  void onlyKnows(const std::set<std::string>& keys) const {
    for (const auto& entry : root_) {
      const auto name = entry.first.as<std::string>("");
      if (keys.count(name) == 0) fail(name, "I know no such key");
    }
  }

  [[noreturn]] void fail(const std::string& key, const std::string& reason) const {
    throw InputError(source_, "key '" + key + "'", reason);
  }

 private:
  std::string source_;
  YAML::Node root_;
};

}  // namespace

Phrases Phrases::fromYaml(const std::string& source, const std::string& yaml) {
  const Reader reader(source, yaml);
  reader.onlyKnows({"format", "version", "language", "decimal_point", "comma", "and", "sides",
                    "walls", "contractions", "phrases"});
  if (reader.text("format") != "hyselam_phrases")
    reader.fail("format", "it is not hyselam_phrases");
  const std::string version = reader.text("version");
  if (version != "1") reader.fail("version", hyselam::versionRefusal(version, {1, 1}));
  Phrases result;
  result.language_ = reader.text("language");
  if (result.language_.empty()) reader.fail("language", "it is empty");
  result.decimal_point_ = reader.text("decimal_point");
  result.comma_ = reader.text("comma");
  result.and_ = reader.text("and");
  result.sides_ = reader.texts("sides", {"front", "left", "back", "right"});
  result.walls_ = reader.texts("walls", {"glass", "virtual"});
  result.contractions_ = reader.anyTexts("contractions");
  std::set<std::string> keys;
  for (const auto& [key, slots] : knownPhrases()) keys.insert(key);
  result.phrases_ = reader.texts("phrases", keys);
  for (const auto& [key, text] : result.phrases_) {
    try {
      for (const std::string& slot : slotsOf(text)) {
        if (knownPhrases().at(key).count(slot) == 0) {
          throw std::runtime_error("nothing is known for '{" + slot + "}'");
        }
      }
    } catch (const std::runtime_error& e) {
      reader.fail("phrases/" + key, e.what());
    }
  }
  return result;
}

Phrases Phrases::load(const std::string& path) {
  return fromYaml(path, hyselam::readTextFile(path, std::size_t{1} << 20));
}

Phrases Phrases::shipped(const std::string& language) {
  for (const hyselam::EmbeddedText& phrases : kShippedPhrases) {
    if (language == phrases.key) return fromYaml("phrases " + language, phrases.text);
  }
  throw InputError("phrases", "", "none are shipped for the language '" + language + "'");
}

std::vector<std::string> Phrases::shippedLanguages() {
  std::vector<std::string> all;
  for (const hyselam::EmbeddedText& phrases : kShippedPhrases) all.emplace_back(phrases.key);
  return all;
}

std::string Phrases::say(const std::string& key, const Values& values) const {
  const std::string& text = phrases_.at(key);
  std::string out;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = text.find('{', at);
    if (open == std::string::npos) break;
    const std::size_t close = text.find('}', open);
    out += text.substr(at, open - at);
    const std::string slot = text.substr(open + 1, close - open - 1);
    const auto value =
        std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == slot; });
    if (value != values.end()) append(value->second, &out);
    at = close + 1;
  }
  return out + text.substr(std::min(at, text.size()));
}

void Phrases::append(const std::string& value, std::string* out) const {
  const std::size_t space = value.find(' ');
  const bool behind_word = out->size() > 1 && out->back() == ' ';
  if (!contractions_.empty() && space != std::string::npos && behind_word) {
    const std::size_t before = out->rfind(' ', out->size() - 2);
    const std::size_t word = before == std::string::npos ? 0 : before + 1;
    const auto found = contractions_.find(out->substr(word) + value.substr(0, space));
    if (found != contractions_.end()) {
      *out = out->substr(0, word) + found->second + value.substr(space);
      return;
    }
  }
  *out += value;
}

std::string Phrases::list(const std::vector<std::string>& items) const {
  std::string out;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) out += i + 1 == items.size() ? and_ : comma_;
    out += items[i];
  }
  return out;
}

std::string Phrases::number(double value, int decimals) const {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  std::string out = text;
  const std::size_t point = out.find_first_of(".,");
  if (point != std::string::npos) out.replace(point, 1, decimal_point_);
  return out;
}

const std::string& Phrases::side(Side side) const {
  return sides_.at(toString(side));
}

const std::string& Phrases::wall(WallKind kind) const {
  return walls_.at(kind == WallKind::kGlass ? "glass" : "virtual");
}

}  // namespace hyselam_topo
