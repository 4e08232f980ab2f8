// The list of words of a language as YAML, and the part of a grammar that follows from it.
#include <algorithm>
#include <array>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/yaml_text.hpp"
#include "object_words.hpp"

namespace hyselam_objects {
namespace {

constexpr char kFormat[] = "hyselam_object_words";

void addAll(const YAML::Node& node, std::set<std::string>* words) {
  for (const auto& each : node) words->insert(lowerCase(each.Scalar()));
}

/// {red: [red, crimson]} of the property "colour".
void addProperties(const YAML::Node& node, const std::string& property, ObjectWords* words) {
  for (const auto& value : node) {
    for (const auto& word : value.second) {
      words->properties[lowerCase(word.Scalar())] = {property, value.first.Scalar()};
      words->property_words[value.first.Scalar()].push_back(word.Scalar());
    }
  }
}

void addForms(const YAML::Node& root, ObjectWords* words) {
  for (const auto& form : root["form_endings"]) {
    for (const auto& end : form.second) {
      words->form_endings[end.Scalar()] = form.first.Scalar();
    }
  }
  for (const auto& form : root["forms"]) {
    for (const auto& word : form.second) {
      words->forms[lowerCase(word.Scalar())] = form.first.Scalar();
    }
  }
  for (const auto& each : root["number_forms"]) {
    words->number_forms[each.first.Scalar()] = each.second.Scalar();
  }
}

void addNumbers(const YAML::Node& root, ObjectWords* words) {
  for (const auto& each : root["numbers"]) {
    words->numbers[lowerCase(each.first.Scalar())] = each.second.as<int>();
  }
  for (const auto& number : root["quantities"]) {
    for (const auto& phrase : number.second) {
      words->quantities[lowerCase(phrase.Scalar())] = number.first.as<int>();
    }
  }
}

void addNouns(const YAML::Node& root, ObjectWords* words) {
  for (const auto& each : root["plural_endings"]) {
    words->plural_endings.emplace_back(each[0].as<std::string>(), each[1].as<std::string>());
  }
  for (const auto& each : root["plurals"]) {
    words->plurals[lowerCase(each.first.Scalar())] = each.second.Scalar();
  }
  for (const auto& each : root["same"]) {
    for (const auto& word : each.second) {
      words->synonyms[lowerCase(word.Scalar())] = each.first.Scalar();
    }
    words->synonyms[lowerCase(each.first.Scalar())] = each.first.Scalar();
  }
  for (const auto& each : root["english"]) {
    words->english[each.first.Scalar()] = each.second.Scalar();
    words->of_english.emplace(each.second.Scalar(), each.first.Scalar());
  }
  for (const auto& each : root["nouns"]) words->nouns.push_back(each.Scalar());
  for (const auto& each : root["mass"]) words->nouns.push_back(each.Scalar());
  for (const auto& reason : root["no_things"]) {
    for (const auto& word : reason.second) {
      words->no_things[lowerCase(word.Scalar())] = reason.first.Scalar();
    }
  }
}

template <typename Words>
void addTo(YAML::Node list, const Words& words) {
  for (const std::string& word : words) list.push_back(word);
}

}  // namespace

ObjectWords ObjectWords::fromYaml(const hyselam_topo::GrammarSource& source) {
  ObjectWords words;
  try {
    const YAML::Node root = hyselam::parseYaml(source.yaml, source.name);
    if (!root.IsMap() || root["format"].as<std::string>("") != kFormat) {
      throw hyselam::InputError(source.name, "key 'format'", "must be " + std::string(kFormat));
    }
    const auto version = root["version"].as<std::string>("");
    if (version != "1") {
      throw hyselam::InputError(source.name, "key 'version'",
                                hyselam::versionRefusal(version, {1, 1}));
    }
    words.language = root["language"].as<std::string>("");
    addNumbers(root, &words);
    addNouns(root, &words);
    addForms(root, &words);
    constexpr std::array<std::pair<const char*, const char*>, 5> kProperties{
        {{"colours", "colour"},
         {"sizes", "size"},
         {"materials", "material"},
         {"positions", "position"},
         {"ages", "age"}}};
    for (const auto& [key, property] : kProperties) addProperties(root[key], property, &words);
    addAll(root["another"], &words.another);
    addAll(root["one"], &words.one_words);
    addAll(root["definite"], &words.definite);
    words.articles = words.definite;
    addAll(root["indefinite"], &words.articles);
    addAll(root["of"], &words.of);
    addAll(root["mass"], &words.mass);
    addAll(root["where"], &words.where);
    addAll(root["always_plural"], &words.always_plural);
    addAll(root["structure"], &words.structure);
    addAll(root["nowhere"], &words.nowhere);
    addAll(root["places_too"], &words.places_too);
    for (const auto& each : root["tops"]) words.tops.insert(each.Scalar());
    for (const auto& each : root["hollows"]) words.hollows.insert(each.Scalar());
    words.head_first = root["head"].as<std::string>("last") == "first";
    words.properties_after = root["properties"].as<std::string>("before") == "after";
    words.index();
  } catch (const YAML::Exception& e) {
    throw hyselam::InputError(source.name, "line " + std::to_string(e.mark.line + 1), e.msg);
  }
  return words;
}

void ObjectWords::addPlaces(const hyselam_topo::GrammarSource& grammar) {
  try {
    const YAML::Node kinds =
        hyselam::parseYaml(grammar.yaml, grammar.name)["names"]["place"]["nouns"];
    for (const auto& kind : kinds) {
      for (const auto& each : kind.second) {
        const std::string word = lowerCase(each.Scalar());
        const bool is_thing = things.count(word) != 0 || structure.count(word) != 0 ||
                              properties.count(word) != 0 || no_things.count(word) != 0;
        if (is_thing || places_too.count(word) != 0) continue;
        place_kinds.insert(word);
        if (word.find(' ') == std::string::npos) no_things[word] = "place";
      }
    }
  } catch (const YAML::Exception& e) {
    throw hyselam::InputError(grammar.name, "line " + std::to_string(e.mark.line + 1), e.msg);
  }
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
  YAML::Node names = root["names"];
  for (const std::string& noun : things) generic.erase(noun);
  for (const std::string& noun : one_words) generic.erase(noun);
  std::set<std::string> own;  // "the desk's got a lamp"
  for (const std::string& noun : nouns) own.insert(lowerCase(noun) + "'s");
  if (head_first) own.clear();
  for (const char* const type : {"object", "known_object", "landmark", "container"}) {
    addTo(names[type]["nouns"]["object"], things);
    addTo(names[type]["nouns"]["object"], one_words);
    addTo(names[type]["generic"], generic);
    addTo(names[type]["nouns"]["object"], own);
  }
  for (const auto& [word, reason] : no_things) {
    names["object"]["forbidden"][reason].push_back(word);
    names["known_object"]["forbidden"][reason].push_back(word);
    const bool stands = structure.count(word) != 0;
    for (const char* const type : {"landmark", "container"}) {
      if (!stands) names[type]["forbidden"][reason].push_back(word);
    }
  }
  for (const std::string& word : place_kinds) {
    names["place"]["nouns"]["room"].push_back(word);
    names["room"]["nouns"]["room"].push_back(word);
  }
  // "In a mess", "in the way" is no place.
  for (const std::string& word : nowhere) {
    names["place"]["forbidden"]["abstract"].push_back(word);
    names["room"]["forbidden"]["abstract"].push_back(word);
  }
  for (const std::string& word : structure) {
    names["landmark"]["nouns"]["object"].push_back(word);
    names["container"]["nouns"]["object"].push_back(word);
  }
  for (const char* const type : {"place", "room"}) {
    addTo(names[type]["forbidden"]["object"], things);
    addTo(names[type]["forbidden"]["object"], structure);
    addTo(names[type]["forbidden"]["object"], own);
  }
  for (const auto& [word, value] : properties) root["telling_words"].push_back(word);
  // "The ties are in the box": no misspelt "lies".
  for (const std::string& noun : things) {
    for (const std::string& word : splitWords(noun)) root["known_words"].push_back(word);
  }
  names["property"]["max_words"] = 1;
  names["property"]["needs_noun"] = true;
  for (const auto& [word, value] : properties) {
    names["property"]["nouns"]["property"].push_back(word);
  }
  YAML::Emitter out;
  out << root;
  return {"words of objects", out.c_str()};
}

}  // namespace hyselam_objects
