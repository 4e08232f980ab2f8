#include "hyselam_objects/object_parser.hpp"

#include <algorithm>
#include <sstream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "object_words.hpp"
#include "shipped_words.hpp"

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
    const std::string before = wordBefore(text, name.range.begin);
    out.definite = before == "the" || before == "this" || before == "that";
    std::vector<std::string> rest = split(name.text);
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
        out.count_said = true;
      } else if (leading && !last && digits && *digits >= 1.0 && *digits <= 1000.0) {
        out.count = static_cast<int>(*digits);
        out.count_said = true;
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
    out.kind = kindOf(kind, &out.plural);
    return out;
  }

  std::string kindOf(const std::string& noun, bool* plural) const {
    *plural = false;
    const auto kept = same.find(lowerCase(noun));
    if (kept != same.end()) return kept->second;
    std::string kind;
    const std::vector<std::string> words = split(noun);
    for (std::size_t i = 0; i < words.size(); ++i) {
      std::string word = isCapitals(words[i]) ? words[i] : lowerCase(words[i]);
      if (i + 1 == words.size()) word = singular(word, plural);
      kind += (kind.empty() ? "" : " ") + word;
    }
    const auto again = same.find(lowerCase(kind));
    return again == same.end() ? kind : again->second;
  }

  ObjectStatement statement(const Utterance& u, const std::string& text) const {
    ObjectStatement out;
    out.kind = u.kind;
    out.intent = u.intent;
    out.correction = u.correction;
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
    if (!u.word("relation").empty()) out.relation = relationWordOf(u.word("relation"));
    for (const SaidName& name : u.names("properties")) {
      const auto found = properties.find(lowerCase(name.text));
      if (found != properties.end()) out.properties.insert(found->second);
    }
    return out;
  }
};

ObjectParser ObjectParser::shipped(const std::string& language) {
  for (const ShippedWords& each : kShippedWords) {
    if (language == each.language) {
      return ObjectParser({"objects_" + language, each.grammar}, {"words_" + language, each.words});
    }
  }
  throw hyselam::InputError("language", language, "objects are not spoken of in this language: en");
}

ObjectParser::ObjectParser(const hyselam_topo::GrammarSource& grammar,
                           const hyselam_topo::GrammarSource& words)
    : words_(std::make_unique<Words>(ObjectWords::fromYaml(words))) {
  parser_ = std::make_unique<hyselam_topo::TopoParser>(std::vector<hyselam_topo::Grammar>{
      hyselam_topo::Grammar::fromYaml({grammar, words_->grammar()})});
}

ObjectParser::~ObjectParser() = default;
ObjectParser::ObjectParser(ObjectParser&&) noexcept = default;

std::vector<ObjectStatement> ObjectParser::parse(const std::string& text,
                                                 const std::set<std::string>& expected) const {
  hyselam_topo::ParseOptions options;
  options.expected = expected;
  std::vector<ObjectStatement> out;
  for (const Utterance& utterance : parser_->parse(text, options).utterances) {
    out.push_back(words_->statement(utterance, text));
  }
  return out;
}

std::string ObjectParser::kindOf(const std::string& noun, bool* plural) const {
  bool ignored = false;
  return words_->kindOf(noun, plural != nullptr ? plural : &ignored);
}

const hyselam_topo::Grammar& ObjectParser::grammar() const {
  return parser_->grammars().front();
}

}  // namespace hyselam_objects
