#include "hyselam_language/grammar/numbered_names.hpp"

#include <algorithm>
#include <utility>

#include "compiled_grammar.hpp"
#include "hyselam_common/utf8.hpp"
#include "numbered_places.hpp"
#include "sentence_words.hpp"
#include "token_meanings.hpp"

namespace hyselam_topo {

using language::NameType;
using language::Token;

std::vector<SaidName> numberedNamesIn(const std::string& text, const Grammar& grammar) {
  const language::CompiledGrammar& g = grammar.compiled();
  const NameType* type = g.nameType("place");
  std::vector<SaidName> names;
  if (type == nullptr || type->numbered.empty()) return names;
  const language::TokenRules rules = g.tokenRules();
  for (const language::Sentence& sentence : language::splitSentences(text, rules)) {
    language::SentenceWords words(
        g, text, sentence,
        language::withMeanings(language::tokenize(text, sentence.range, rules), g));
    if (words.isTooLong()) continue;
    language::NumberedPlaces numbered(&words);
    const auto& tokens = words.tokens;
    const auto isKind = [&](const Token& token) {
      return g.isNounOrTitle(token.folded) || type->parts.count(token.folded) != 0;
    };
    for (std::size_t at = 1; at < tokens.size(); ++at) {
      if (type->numbered_after.count(tokens[at - 1].folded) == 0) continue;
      std::vector<language::FoundName> found = numbered.find(at, *type);
      if (found.empty()) continue;
      const auto from = tokens.begin() + static_cast<std::ptrdiff_t>(at);
      const auto to = tokens.begin() + static_cast<std::ptrdiff_t>(found.back().end);
      if (std::none_of(from, to, isKind)) continue;
      names.push_back(std::move(found.back().name));
      at = found.back().end;
    }
  }
  return names;
}

std::string withNameFor(const std::string& text, TextRange range, const std::string& name,
                        bool with_article, const Grammar& grammar) {
  const NameType* type = grammar.compiled().nameType("place");
  std::size_t begin = range.begin;
  const std::size_t space = begin < 2 ? std::string::npos : text.rfind(' ', begin - 2);
  const std::size_t word = space == std::string::npos ? 0 : space + 1;
  const bool article = type != nullptr && !type->head_first && begin > 0 &&
                       text[begin - 1] == ' ' &&
                       type->isArticle(hyselam::utf8Lower(text.substr(word, begin - 1 - word)));
  if (article && !with_article) begin = word;
  return text.substr(0, begin) + name + text.substr(range.end);
}

}  // namespace hyselam_topo
