#include "hyselam_objects/language/object_parser.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <sstream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_language/building/place_names.hpp"
#include "object_words.hpp"
#include "shipped_object_texts.hpp"

namespace hyselam_objects {
namespace {

using hyselam_topo::SaidName;
using hyselam_topo::Utterance;

std::vector<std::string> split(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// The word of the text that ends before a byte, in lower case.
std::string wordBefore(const std::string& text, std::size_t at) {
  while (at > 0 && text[at - 1] == ' ') --at;
  std::size_t begin = at;
  while (begin > 0 && text[begin - 1] != ' ' && text[begin - 1] != ',') --begin;
  return lowerCase(text.substr(begin, at - begin));
}

constexpr std::array<const char*, 2> kShippedLanguages{"en", "pt"};

hyselam_topo::GrammarSource shippedText(const std::string& prefix, const std::string& language) {
  const std::string key = prefix + language;
  const auto found =
      std::find_if(std::begin(kShippedObjectTexts), std::end(kShippedObjectTexts),
                   [&](const hyselam::EmbeddedText& each) { return each.key == key; });
  return {key, found->text};
}

bool isCapitals(const std::string& word) {
  return std::count_if(word.begin(), word.end(), [](char c) { return c >= 'A' && c <= 'Z'; }) > 1;
}

}  // namespace

struct ObjectParser::Words : ObjectWords {
  explicit Words(ObjectWords words) : ObjectWords(std::move(words)) {}

  ObjectPhrase phrase(const SaidName& name, const std::string& text) const {
    ObjectPhrase out;
    out.text = name.text;
    out.reference = name.reference;
    if (!name.reference.empty()) {
      out.definite = true;
      return out;
    }
    out.definite = definite.count(wordBefore(text, name.range.begin)) != 0;
    std::vector<std::string> rest = split(name.text);
    if (properties_after) {  // "copo vermelho pequeno"
      for (; rest.size() > 1; rest.pop_back()) {
        const auto property = properties.find(lowerCase(rest.back()));
        if (property == properties.end()) break;
        out.properties[property->second.first] = property->second.second;
      }
    }
    bool leading = true;
    std::vector<std::string> noun;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const std::string word = lowerCase(rest[i]);
      const bool last = i + 1 == rest.size();
      const auto number = numbers.find(word);
      const auto property = properties.find(word);
      const std::size_t owner = word.find("'s");
      const auto digits = hyselam::parseNumber(word);
      if (leading && !last && number != numbers.end()) {
        out.count = number->second;
        out.has_count = true;
      } else if (leading && !last && digits && *digits >= 1.0 && *digits <= 1000.0) {
        out.count = static_cast<int>(*digits);
        out.has_count = true;
      } else if (leading && !last && another.count(word) != 0) {
        out.another = true;
      } else if (leading && !last && property != properties.end()) {
        out.properties[property->second.first] = property->second.second;
      } else if (leading && !last && owner != std::string::npos && owner > 0 &&
                 owner + 2 == word.size()) {
        out.properties["owner"] = rest[i].substr(0, owner);
        out.definite = true;
      } else {
        leading = false;
        noun.push_back(rest[i]);
      }
    }
    std::string kind;
    for (const std::string& word : noun) kind += (kind.empty() ? "" : " ") + word;
    const NounKind found = kindOf(kind);
    out.kind = found.kind;
    out.plural = found.plural;
    return out;
  }

  NounKind kindOf(const std::string& noun) const {
    const auto kept = synonyms.find(lowerCase(noun));
    if (kept != synonyms.end()) return {kept->second, false};
    NounKind out;
    const std::vector<std::string> words = split(noun);
    // The word that takes the plural: the last one, or that before "of".
    std::size_t head = head_first || words.empty() ? 0 : words.size() - 1;
    for (std::size_t i = 1; i < words.size() && !head_first; ++i) {
      if (of.count(lowerCase(words[i])) != 0) {
        head = i - 1;
        break;
      }
    }
    for (std::size_t i = 0; i < words.size(); ++i) {
      std::string word = isCapitals(words[i]) ? words[i] : lowerCase(words[i]);
      if (i == head) {
        const NounKind one = singular(word);
        word = one.kind;
        out.plural = one.plural;
      }
      out.kind += (out.kind.empty() ? "" : " ") + word;
    }
    const auto again = synonyms.find(lowerCase(out.kind));
    if (again != synonyms.end()) out.kind = again->second;
    return out;
  }

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

  ObjectStatement statement(const Utterance& u, const std::string& text) const {
    ObjectStatement out;
    out.kind = u.kind;
    out.intent = u.intent;
    out.correction = u.correction || u.word("moved") == "yes";
    if (const auto count = u.number("count")) out.count = static_cast<int>(std::min(*count, 1e3));
    if (const auto word = hyselam::parseNumber(u.word("some"))) out.count = static_cast<int>(*word);
    out.text = u.text;
    out.reason = u.reason;
    for (const SaidName& name : u.names("objects")) out.objects.push_back(phrase(name, text));
    for (const SaidName& name : u.names("landmark")) out.landmark = phrase(name, text);
    for (const SaidName& name : u.names("place")) out.place = name;
    if (u.word("where") == "here") {
      SaidName here;
      here.text = here.reference = "here";
      out.place = here;
    }
    if (!u.word("relation").empty()) out.relation = relationWordFromString(u.word("relation"));
    // Where one word means both: what is "na mesa" lies on the table.
    const bool on_top = out.landmark && tops.count(out.landmark->kind) != 0;
    if (on_top && out.relation == RelationWord::kIn) out.relation = RelationWord::kOn;
    for (const SaidName& name : u.names("properties")) {
      const auto found = properties.find(lowerCase(name.text));
      if (found != properties.end()) out.properties.insert(found->second);
    }
    return out;
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
  return ObjectParser(all);
}

ObjectParser::ObjectParser(const std::vector<ObjectLanguage>& languages) {
  if (languages.empty()) throw hyselam::InputError("languages", "", "there is none");
  std::vector<hyselam_topo::Grammar> grammars;
  for (const ObjectLanguage& each : languages) {
    auto words = std::make_unique<const Words>(ObjectWords::fromYaml(each.words));
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
  const Words& words = *words_[indexOf(parsed.language)];
  std::vector<ObjectStatement> out;
  for (const Utterance& utterance : parsed.utterances) {
    out.push_back(words.statement(utterance, text));
    out.back().language = words.language;
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

std::string ObjectParser::propertyWord(const std::string& language,
                                       const std::string& value) const {
  const auto& words = words_[indexOf(language)]->property_words;
  const auto found = words.find(value);
  return found == words.end() ? value : found->second;
}

bool ObjectParser::isAboutThings(const std::string& text) const {
  std::string spaced = lowerCase(text);
  std::replace_if(
      spaced.begin(), spaced.end(), [](char c) { return std::strchr(",.;:!?\"()", c) != nullptr; },
      ' ');
  const std::vector<std::string> said = split(spaced);
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
