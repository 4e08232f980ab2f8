#include "fact_writer.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "grammar/compiled_grammar.hpp"
#include "hyselam_common/utf8.hpp"

namespace hyselam_topo {
namespace {

/// The relation asked for belongs to the key: "fact_ask_what_next_1".
std::string keyOf(const ReadFact& fact) {
  std::size_t names = 0;
  std::string asked;
  for (const FactArgument& each : fact.arguments) {
    names += each.isReference() ? 0 : 1;
    if (each.isReference()) asked += "_" + each.text;
  }
  return std::string(fact.asked ? "ask_" : "") + (fact.denied ? "not_" : "") + "fact_" +
         fact.relation + asked + "_" + std::to_string(names);
}

/// "the scrap bins", "as chaves": by the article where it tells, else by the head's last letter.
bool isPlural(const Grammar& grammar, const std::string& name, const std::string& article) {
  const language::NameType* type = grammar.compiled().nameType("place");
  if (type != nullptr && type->head_first) return !article.empty() && article.back() == 's';
  const std::size_t size = name.size();
  return size > 3 && name[size - 1] == 's' && name[size - 2] != 's' && name[size - 2] != '\'' &&
         name[size - 2] != 'u';
}

bool isThing(const language::NameType* type, const std::string& word) {
  if (type == nullptr) return false;
  const auto found = type->forbidden.find(word);
  return found != type->forbidden.end() && found->second == "object";
}

/// "the little one", "the second": which place that is was said elsewhere.
bool endsWithKeyword(const Grammar& grammar, const std::string& name) {
  const language::CompiledGrammar& compiled = grammar.compiled();
  const std::string last = hyselam::utf8Fold(name.substr(name.rfind(' ') + 1));
  const language::NameType* type = compiled.nameType("place");
  const bool generic = type != nullptr && type->generic.count(last) != 0;
  const bool keyword = compiled.known_words.count(last) != 0 &&
                       compiled.number_words.count(last) == 0 &&
                       !isThing(type, last);  // "the linen cupboard" tells which
  return name.find(' ') != std::string::npos && (keyword || generic) &&
         !compiled.isNounOrTitle(last) && !compiled.isNounOrTitle(hyselam::utf8Fold(name));
}

}  // namespace

FactWriter::FactWriter(const Grammar& grammar) : grammar_(grammar), writer_(grammar) {}

SaidValue FactWriter::valueOf(const std::string& key, const FactArgument& argument) const {
  const auto& types = grammar_.compiled().name_types;
  const auto anyType = [&](const auto& has) {
    return std::any_of(types.begin(), types.end(), has);
  };
  const std::string& name = argument.text;
  const bool plain =
      anyType([&](const auto& type) { return grammar_.isPlainName(name, type.name); });
  if (!plain || endsWithKeyword(grammar_, name)) return {key, "", false, false};
  SaidValue value{key, name, false, true};
  if (grammar_.isPlainName(name)) value = writer_.named(key, name);
  if (value.text != name) return value;
  // A noun that the grammar does not know keeps the article that it had; "uma copa" is "a copa".
  const std::string& article = argument.article;
  value.plural = value.plural || isPlural(grammar_, name, article);
  const bool definite =
      anyType([&](const auto& type) { return type.definite.count(article) != 0; });
  if (article.empty() || !grammar_.has("article")) return value;
  value.is_name = false;
  if (definite) {
    value.text.insert(0, article + " ");
    return value;
  }
  const bool plural = article.back() == 's';
  const char gender = article[article.size() - (plural ? 2 : 1)];
  value.text.insert(0, grammar_.say(std::string(gender == 'a' ? "feminine_" : "") +
                                    (plural ? "plural_" : "") + "article"));
  return value;
}

std::string FactWriter::sentence(const ReadFact& fact) const {
  const std::string key = keyOf(fact);
  if (!grammar_.has(key)) return "";
  std::vector<SaidValue> values;
  for (const FactArgument& each : fact.arguments) {
    if (each.isReference()) continue;
    values.push_back(valueOf(std::to_string(values.size() + 1), each));
    if (values.back().text.empty()) return "";
  }
  return writer_.sentence(key, values);
}

}  // namespace hyselam_topo
