#include "object_words.hpp"

#include <algorithm>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/yaml_text.hpp"

namespace hyselam_objects {
namespace {

constexpr char kFormat[] = "hyselam_object_words";

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

std::string lowerCase(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

ObjectWords ObjectWords::fromYaml(const hyselam_topo::GrammarSource& source) {
  ObjectWords words;
  try {
    const YAML::Node root = hyselam::parseYaml(source.yaml, source.name);
    if (!root.IsMap() || root["format"].as<std::string>("") != kFormat ||
        root["version"].as<std::string>("") != "1") {
      throw hyselam::InputError(source.name, "key 'format'",
                                "must be " + std::string(kFormat) + ", version 1");
    }
    words.language = root["language"].as<std::string>("");
    for (const auto& each : root["numbers"]) {
      words.numbers[lowerCase(each.first.Scalar())] = each.second.as<int>();
    }
    for (const auto& each : root["another"]) words.another.insert(lowerCase(each.Scalar()));
    for (const auto& [key, property] :
         {std::pair<const char*, const char*>{"colours", "colour"}, {"sizes", "size"}}) {
      for (const auto& value : root[key]) {
        for (const auto& word : value.second) {
          words.properties[lowerCase(word.Scalar())] = {property, value.first.Scalar()};
          words.property_words.emplace(value.first.Scalar(), word.Scalar());
        }
      }
    }
    for (const auto& each : root["definite"]) words.definite.insert(lowerCase(each.Scalar()));
    for (const auto& each : root["of"]) words.of.insert(lowerCase(each.Scalar()));
    for (const auto& each : root["tops"]) words.tops.insert(each.Scalar());
    words.head_first = root["head"].as<std::string>("last") == "first";
    words.properties_after = root["properties"].as<std::string>("before") == "after";
    for (const auto& each : root["plural_endings"]) {
      words.plural_endings.emplace_back(each[0].as<std::string>(), each[1].as<std::string>());
    }
    for (const auto& each : root["plurals"]) {
      words.plurals[lowerCase(each.first.Scalar())] = each.second.Scalar();
    }
    for (const auto& each : root["same"]) {
      for (const auto& word : each.second) {
        words.synonyms[lowerCase(word.Scalar())] = each.first.Scalar();
      }
      words.synonyms[lowerCase(each.first.Scalar())] = each.first.Scalar();
    }
    for (const auto& each : root["nouns"]) words.nouns.push_back(each.Scalar());
    for (const auto& each : root["where"]) words.where.insert(lowerCase(each.Scalar()));
    words.things = words.spelled();
  } catch (const YAML::Exception& e) {
    throw hyselam::InputError(source.name, "line " + std::to_string(e.mark.line + 1), e.msg);
  }
  return words;
}

NounKind ObjectWords::singular(const std::string& word) const {
  constexpr std::size_t kMinLength = 4;  // shorter words have no plural ending
  const auto given = plurals.find(lowerCase(word));
  if (given != plurals.end()) return {given->second, given->second != given->first};
  // "a PC", "two PCs"
  if (word.size() == 3 && endsWith(word, "s") && word[0] >= 'A' && word[0] <= 'Z') {
    return {word.substr(0, 2), true};
  }
  for (const auto& [end, one] : plural_endings) {
    if (word.size() < kMinLength || !endsWith(word, end)) continue;
    return {word.substr(0, word.size() - end.size()) + one, one != end};
  }
  return {word, false};
}

std::set<std::string> ObjectWords::spelled() const {
  std::set<std::string> names;
  for (const std::string& noun : nouns) {
    names.insert(lowerCase(noun));
    names.insert(lowerCase(noun) + "s");
  }
  for (const auto& [word, kept] : synonyms) names.insert(word);
  for (const auto& [word, kept] : plurals) names.insert(word);
  return names;
}

hyselam_topo::GrammarSource ObjectWords::grammar() const {
  YAML::Node root;
  root["format"] = "hyselam_grammar";
  root["version"] = "1";
  root["language"] = language;
  std::set<std::string> generic;
  for (const auto& [word, number] : numbers) generic.insert(word);
  for (const auto& [word, property] : properties) generic.insert(word);
  generic.insert(another.begin(), another.end());
  YAML::Node object = root["names"]["object"], known = root["names"]["known_object"],
             property = root["names"]["property"], place = root["names"]["place"];
  for (const std::string& noun : things) {
    object["nouns"]["object"].push_back(noun);
    known["nouns"]["object"].push_back(noun);
    place["forbidden"]["object"].push_back(noun);
    generic.erase(noun);
  }
  for (const std::string& word : generic) {
    object["generic"].push_back(word);
    known["generic"].push_back(word);
  }
  property["max_words"] = 1;
  property["needs_noun"] = true;
  for (const auto& [word, value] : properties) property["nouns"]["property"].push_back(word);
  YAML::Emitter out;
  out << root;
  return {"words of objects", out.c_str()};
}

}  // namespace hyselam_objects
