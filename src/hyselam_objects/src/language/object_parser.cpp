#include "hyselam_objects/language/object_parser.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>

#include "hyselam_common/errors.hpp"
#include "hyselam_language/building/place_names.hpp"
#include "object_statements.hpp"
#include "shipped_object_texts.hpp"

namespace hyselam_objects {
namespace {

using hyselam_topo::Utterance;

constexpr std::array<const char*, 2> kShippedLanguages{"en", "pt"};

hyselam_topo::GrammarSource shippedText(const std::string& prefix, const std::string& language) {
  const std::string key = prefix + language;
  const auto found =
      std::find_if(std::begin(kShippedObjectTexts), std::end(kShippedObjectTexts),
                   [&](const hyselam::EmbeddedText& each) { return each.key == key; });
  return {key, found->text};
}

}  // namespace

struct ObjectParser::Words : ObjectWords {
  explicit Words(ObjectWords words) : ObjectWords(std::move(words)) {}

  bool isAboutThings(const std::vector<std::string>& said,
                     const hyselam_topo::PlaceNames& places) const {
    const auto is_place = [&](std::size_t i) {
      return i < said.size() && things.count(said[i]) == 0 && places.kindOf(said[i]).has_value();
    };
    bool where_it_is = false;  // what comes next is the place of a thing
    for (std::size_t i = 0; i < said.size(); ++i) {
      if (where.count(said[i]) != 0) where_it_is = true;
      const bool two = i + 1 < said.size() && things.count(said[i] + " " + said[i + 1]) != 0;
      const bool thing = two || things.count(said[i]) != 0;
      // "the printer room", "a sala da impressora"
      const bool part_of_place =
          thing && (is_place(i + (two ? 2 : 1)) ||
                    (i >= 2 && of.count(said[i - 1]) != 0 && is_place(i - 2)));
      if (thing && !part_of_place) return true;
      if (!thing && !is_place(i) && !part_of_place) continue;
      if (!where_it_is) return false;
      where_it_is = false;
    }
    return false;
  }
};

ObjectParser ObjectParser::shipped(const std::string& language) {
  std::vector<ObjectLanguage> all;
  std::string known;
  for (const char* const name : kShippedLanguages) {
    known += std::string(known.empty() ? "" : ", ") + name;
    if (language.empty() || language == name) {
      all.push_back({shippedText("objects_", name), shippedText("words_", name)});
    }
  }
  if (all.empty()) {
    throw hyselam::InputError(
        "language", language,
        "there is no grammar of objects for this language, only for " + known);
  }
  return ObjectParser(all, true);
}

ObjectParser::ObjectParser(const std::vector<ObjectLanguage>& languages)
    : ObjectParser(languages, false) {}

ObjectParser::ObjectParser(const std::vector<ObjectLanguage>& languages, bool shipped) {
  if (languages.empty()) throw hyselam::InputError("languages", "", "there is none");
  std::vector<hyselam_topo::Grammar> grammars;
  for (const ObjectLanguage& each : languages) {
    ObjectWords list = ObjectWords::fromYaml(each.words);
    if (shipped) list.addPlaces(hyselam_topo::Grammar::shippedSource(list.language));
    auto words = std::make_unique<const Words>(std::move(list));
    grammars.push_back(hyselam_topo::Grammar::fromYaml({each.grammar, words->grammar()}));
    words_.push_back(std::move(words));
  }
  parser_ = std::make_unique<hyselam_topo::TopoParser>(std::move(grammars));
}

ObjectParser::~ObjectParser() = default;
ObjectParser::ObjectParser(ObjectParser&&) noexcept = default;

std::vector<ObjectStatement> ObjectParser::parse(const std::string& text,
                                                 const std::set<std::string>& expected,
                                                 const std::string& preferred) const {
  hyselam_topo::ParseOptions options;
  options.preferred = preferred;
  options.expected = expected;
  const hyselam_topo::ParsedText parsed = parser_->parse(text, options);
  const std::size_t index = indexOf(parsed.language);
  std::vector<ObjectStatement> out;
  for (const Utterance& utterance : parsed.utterances) {
    for (ObjectStatement& each :
         statementsOf(*words_[index], parser_->grammars()[index], utterance, text)) {
      out.push_back(std::move(each));
    }
  }
  return out;
}

std::size_t ObjectParser::indexOf(const std::string& language) const {
  for (std::size_t i = 0; i < words_.size(); ++i) {
    if (words_[i]->language == language) return i;
  }
  return 0;
}

NounKind ObjectParser::kindOf(const std::string& noun) const {
  return words_.front()->kindOf(noun);
}

std::string ObjectParser::propertyWord(const std::string& language, const std::string& value,
                                       const std::string& kind, bool plural) const {
  const ObjectWords& words = *words_[indexOf(language)];
  const auto found = words.property_words.find(value);
  if (found == words.property_words.end()) return value;
  const std::vector<std::string>& forms = found->second;
  if (!words.properties_after) return forms.front();
  // Masculine, feminine, and both in the plural; or one form and its plural.
  const bool feminine = words.formOf(kind) == "f";
  if (forms.size() == 4) return forms[(plural ? 2u : 0u) + (feminine ? 1u : 0u)];
  return forms[plural && forms.size() == 2 ? 1u : 0u];
}

std::string ObjectParser::formOf(const std::string& language, const std::string& kind) const {
  return words_[indexOf(language)]->formOf(kind);
}

bool ObjectParser::mayHaveForm(const std::string& language, const std::string& kind,
                               const std::string& form) const {
  const ObjectWords& words = *words_[indexOf(language)];
  return words.formOf(kind) == form ||
         std::any_of(words.synonyms.begin(), words.synonyms.end(), [&](const auto& each) {
           return each.second == kind && words.formOf(each.first) == form;
         });
}

std::string ObjectParser::pluralOf(const std::string& language, const std::string& kind) const {
  return words_[indexOf(language)]->pluralOf(kind);
}

std::string ObjectParser::numberWord(const std::string& language, int number,
                                     const std::string& form) const {
  const ObjectWords& words = *words_[indexOf(language)];
  for (const std::string& key : {std::to_string(number) + " " + form, std::to_string(number)}) {
    const auto found = words.number_forms.find(key);
    if (found != words.number_forms.end()) return found->second;
  }
  return std::to_string(number);
}

std::string ObjectParser::englishOf(const std::string& kind) const {
  for (const auto& words : words_) {
    const auto found = words->english.find(kind);
    if (found != words->english.end()) return found->second;
  }
  return kind;
}

bool ObjectParser::isSameKind(const std::string& a, const std::string& b) const {
  return a == b || englishOf(a) == englishOf(b);
}

std::string ObjectParser::kindIn(const std::string& language, const std::string& kind) const {
  const ObjectWords& words = *words_[indexOf(language)];
  if (words.english.count(kind) != 0) return kind;
  const std::string english = englishOf(kind);
  const auto found = words.of_english.find(english);
  if (found != words.of_english.end()) return found->second;
  return words.isNoun(english) ? english : kind;
}

bool ObjectParser::isUncounted(const std::string& language, const std::string& kind) const {
  return words_[indexOf(language)]->mass.count(lowerCase(kind)) != 0 ||
         isAlwaysPlural(language, kind);
}

bool ObjectParser::isAlwaysPlural(const std::string& language, const std::string& kind) const {
  return words_[indexOf(language)]->always_plural.count(lowerCase(kind)) != 0;
}

bool ObjectParser::propertiesAfter(const std::string& language) const {
  return words_[indexOf(language)]->properties_after;
}

bool ObjectParser::isStructure(const std::string& kind) const {
  return std::any_of(words_.begin(), words_.end(), [&](const auto& words) {
    return words->structure.count(lowerCase(words->headOf(kind))) != 0;
  });
}

bool ObjectParser::isTop(const std::string& kind) const {
  return std::any_of(words_.begin(), words_.end(),
                     [&](const auto& words) { return words->tops.count(kind) != 0; });
}

bool ObjectParser::isAboutThings(const std::string& text) const {
  std::string spaced = lowerCase(text);
  std::replace_if(
      spaced.begin(), spaced.end(), [](char c) { return std::strchr(",.;:!?\"()", c) != nullptr; },
      ' ');
  const std::vector<std::string> said = splitWords(spaced);
  for (std::size_t i = 0; i < words_.size(); ++i) {
    const hyselam_topo::PlaceNames places({parser_->grammars()[i]});
    if (words_[i]->isAboutThings(said, places)) return true;
  }
  return false;
}

const hyselam_topo::Grammar& ObjectParser::grammar(const std::string& language) const {
  return parser_->grammars()[indexOf(language)];
}

}  // namespace hyselam_objects
