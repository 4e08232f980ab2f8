// FillMap: the words of the replies.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "hyselam_objects/language/fill_map.hpp"
#include "object_words.hpp"

namespace hyselam_objects {
namespace {

void replaceAll(const std::string& from, const std::string& to, std::string* text) {
  for (std::size_t at = text->find(from); at != std::string::npos;
       at = text->find(from, at + to.size())) {
    text->replace(at, from.size(), to);
  }
}

}  // namespace

std::string FillMap::phraseText(const std::string& key, const Values& values) const {
  std::string text = parser_.grammar(language_).say(key);
  for (const auto& [name, value] : values) {
    const std::size_t at = text.find("{" + name + "}");
    if (at != std::string::npos) text.replace(at, name.size() + 2, value);
  }
  return text;
}

std::string FillMap::formed(const std::string& key, const std::string& kind,
                            const Values& values) const {
  const std::string with_form = key + "_" + parser_.formOf(language_, kind);
  return phraseText(parser_.grammar(language_).has(with_form) ? with_form : key, values);
}

/// "em a cozinha" is "na cozinha".
std::string FillMap::contracted(const std::string& text) const {
  const hyselam_topo::Grammar& grammar = parser_.grammar(language_);
  if (!grammar.has("contractions")) return text;
  std::string out = " " + text;
  // "de o: do, em a: na"
  const std::string all = grammar.say("contractions");
  for (std::size_t at = 0; at < all.size();) {
    const std::size_t end = std::min(all.find(", ", at), all.size());
    const std::string pair = all.substr(at, end - at);
    const std::size_t colon = pair.find(": ");
    if (colon != std::string::npos) {
      replaceAll(" " + pair.substr(0, colon) + " ", " " + pair.substr(colon + 2) + " ", &out);
    }
    at = end + 2;
  }
  return out.substr(1);
}

ObjectReply FillMap::reply(ReplyKind kind, const std::string& key, const Values& values) const {
  ObjectReply out;
  out.kind = kind;
  out.code = key;
  out.text = contracted(phraseText(key, values));
  return out;
}

std::string FillMap::enumeration(const std::vector<std::string>& items, bool choice) const {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += phraseText(i + 1 < items.size() ? "comma" : choice ? "or" : "and");
    text += items[i];
  }
  return text;
}

/// With its article, unless it is a code or somebody's: "the kitchen", "room 3", "John's office".
std::string FillMap::placeName(const std::string& name) const {
  const bool has_code =
      std::any_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
  const bool upper = !name.empty() && name[0] >= 'A' && name[0] <= 'Z';
  const bool head_first = parser_.grammar(language_).has("the_f");
  const std::string first = name.substr(0, name.find(' '));
  const bool code_first =
      std::any_of(first.begin(), first.end(), [](char c) { return c >= '0' && c <= '9'; });
  const bool bare =
      head_first ? code_first : has_code || upper || name.find("'s ") != std::string::npos;
  return bare ? name : formed("the", name, {{"what", name}});
}

std::string FillMap::placeNames(const std::vector<Id>& places) const {
  std::vector<std::string> names;
  for (const Id id : places) names.push_back(placeName(map_.findPlace(id)->name));
  return enumeration(names);
}

std::string FillMap::bareName(Id object, bool plural) const {
  // The farthest from the noun last.
  constexpr std::array<const char*, 5> kOrder{"material", "colour", "age", "size", "position"};
  const ObjectInstance* found = map_.find(object);
  if (found == nullptr) return "";
  const std::string kind = parser_.kindIn(language_, found->kind);
  std::string text = plural ? parser_.pluralOf(language_, kind) : kind;
  for (const char* const key : kOrder) {
    const auto property = found->properties.find(key);
    if (property == found->properties.end()) continue;
    const std::string word = parser_.propertyWord(language_, property->second, kind, plural);
    // "segunda gaveta da secretária", but "gaveta de baixo"
    const bool before = std::string(key) == "position" &&
                        parser_.grammar(language_).has("ordinal") &&
                        word.find(' ') == std::string::npos;
    text = phraseText(before ? "ordinal" : "described", {{"property", word}, {"what", text}});
  }
  return text;
}

std::string FillMap::countedName(const std::vector<Id>& objects, bool definite) const {
  const ObjectInstance* found = map_.find(objects.front());
  if (found == nullptr) return "";
  const std::string kind = parser_.kindIn(language_, found->kind);
  const bool plural = objects.size() > 1;
  const std::string name = bareName(found->id, plural);
  const auto owner = found->properties.find("owner");
  const std::string head = parser_.propertiesAfter(language_) ? kind : name;
  const auto number = [&] {
    return parser_.numberWord(language_, static_cast<int>(objects.size()),
                              parser_.formOf(language_, kind));
  };
  if (owner != found->properties.end()) {
    const std::string counted = plural ? number() + " " + name : name;
    const std::string& whose = owner->second;
    const bool named = whose != hyselam_objects::lowerCase(whose);
    if (whose == "speaker") {
      return formed(plural ? "yours_many" : "yours", head, {{"what", counted}});
    }
    return formed(plural ? "owned_many" : "owned", head,
                  {{"property", named ? whose : formed("owner", whose, {{"what", whose}})},
                   {"what", counted}});
  }
  const bool uncounted = parser_.isUncounted(language_, kind);
  if (uncounted && !plural) return definite ? formed("the", head, {{"what", name}}) : name;
  if (plural && !definite) return number() + " " + name;
  if (plural) return formed("the_many", head, {{"what", number() + " " + name}});
  return formed(definite ? "the" : "a", head, {{"what", name}});
}

std::string FillMap::objectName(Id object, bool definite) const {
  return countedName({object}, definite);
}

std::string FillMap::countedNames(const std::vector<Id>& objects, bool definite) const {
  std::vector<std::vector<Id>> groups;
  for (const Id id : objects) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      const ObjectInstance &a = *map_.find(group.front()), &b = *map_.find(id);
      return parser_.isSameKind(a.kind, b.kind) && a.properties == b.properties;
    });
    if (same == groups.end()) {
      groups.push_back({id});
    } else {
      same->push_back(id);
    }
  }
  std::vector<std::string> names;
  for (const auto& group : groups) names.push_back(countedName(group, definite));
  return enumeration(names);
}

std::string FillMap::objectLocation(Id object) const {
  std::vector<std::string> items;
  std::vector<std::string> between;
  for (const ObjectRelation* r : map_.relationsOf(object)) {
    if (r->word == RelationWord::kAt) continue;
    const std::string other =
        r->other != 0 ? objectName(r->other) : placeName(map_.findPlace(r->place)->name);
    if (r->word == RelationWord::kBetween) {
      between.push_back(other);
    } else {
      // "em cima da mesa", but "na parede"
      const ObjectInstance* at = map_.find(r->other);
      const bool on_part = r->word == RelationWord::kOn && at != nullptr &&
                           parser_.isStructure(at->kind) &&
                           parser_.grammar(language_).has("on_structure");
      items.push_back(phraseText(on_part ? "on_structure" : toString(r->word), {{"what", other}}));
    }
  }
  if (!between.empty()) {
    items.push_back(phraseText("between", {{"what", enumeration(between)}}));
  }
  std::string text = enumeration(items);
  const ObjectPlace* place = map_.findPlace(map_.placeOf(object));
  if (place != nullptr) {
    text += (text.empty() ? "" : " ") + phraseText("at", {{"place", placeName(place->name)}});
  }
  return contracted(text);
}

std::string FillMap::measuredLocation(Id object) const {
  const ObjectInstance* instance = map_.find(object);
  if (instance == nullptr || !instance->pose) return "";
  // Rounded first: no "-0.0".
  const auto rounded = [](double metres) { return std::round(10.0 * metres) / 10.0 + 0.0; };
  char position[80];
  std::snprintf(position, sizeof(position), "(%.1f, %.1f)", rounded(instance->pose->position.x),
                rounded(instance->pose->position.y));
  return phraseText("at_position", {{"position", position}});
}

std::vector<std::string> FillMap::factsOf(const std::vector<Id>& objects, bool definite,
                                          const std::string& key, bool with_positions) const {
  std::vector<std::pair<std::string, std::vector<Id>>> groups;  // by where they are
  for (const Id id : objects) {
    std::string where = objectLocation(id);
    if (where.empty() && with_positions) where = measuredLocation(id);
    const auto same = std::find_if(groups.begin(), groups.end(),
                                   [&](const auto& group) { return group.first == where; });
    if (same == groups.end()) {
      groups.push_back({where, {id}});
    } else {
      same->second.push_back(id);
    }
  }
  std::vector<std::string> facts;
  for (const auto& [where, ids] : groups) {
    const std::string names = countedNames(ids, definite);
    const bool many =
        ids.size() > 1 || parser_.isAlwaysPlural(language_, map_.find(ids.front())->kind);
    std::string with = key + (many ? "_many" : "");
    if (where.empty()) with += "_nowhere";
    facts.push_back(contracted(phraseText(with, {{"what", names}, {"where", where}})));
  }
  return facts;
}

}  // namespace hyselam_objects
