#include "heard_names.hpp"

#include <algorithm>
#include <cstddef>

namespace hyselam_topo {
namespace {

using language::CompiledGrammar;
using language::NameType;
using language::Token;
using language::TokenKind;

constexpr std::size_t kLongestName = 4;  // words

bool isOfArticles(const CompiledGrammar& grammar, const std::string& word) {
  return std::any_of(grammar.name_types.begin(), grammar.name_types.end(),
                     [&](const NameType& type) { return type.isArticle(word); });
}

bool isJoiner(const CompiledGrammar& grammar, const std::string& word) {
  const NameType* places = grammar.nameType("place");
  return places != nullptr && places->joiners.count(word) != 0;
}

/// A kind of place or of thing, or the title of a row of them.
bool isKind(const CompiledGrammar& grammar, const std::string& folded) {
  const std::size_t size = folded.size();
  const bool cut = size > 2 && folded.compare(size - 2, 2, "'s") == 0;
  const std::string word = cut ? folded.substr(0, size - 2) : folded;
  const bool tells_nothing =
      grammar.number_words.count(word) != 0 ||
      std::any_of(grammar.name_types.begin(), grammar.name_types.end(), [&](const NameType& type) {
        return type.generic.count(word) != 0 || type.elliptic_nouns.count(word) != 0;
      });
  if (tells_nothing) return false;
  return std::any_of(grammar.name_types.begin(), grammar.name_types.end(),
                     [&](const NameType& type) {
                       if (type.name == "property") return false;
                       const auto found = type.forbidden.find(word);
                       return (found != type.forbidden.end() && found->second == "object") ||
                              type.nouns.count(word) != 0 || type.titles.count(word) != 0 ||
                              type.plurals.count(word) != 0;
                     });
}

class NamesOf {
 public:
  NamesOf(const Utterance& part, const Reading& reading, const CompiledGrammar& grammar)
      : grammar_(grammar),
        part_(part),
        tokens_(language::tokenize(part.text, {0, part.text.size()}, grammar.tokenRules())) {
    for (const Token& token : tokens_) {
      const bool named = std::any_of(
          reading.mentions.begin(), reading.mentions.end(), [&](const TextRange& mention) {
            const std::size_t begin = part.range.begin + token.range.begin;
            return mention.begin < part.range.begin + token.range.end && begin < mention.end;
          });
      named_.push_back(named && token.kind != TokenKind::kComma && token.kind != TokenKind::kMark);
    }
  }

  std::vector<FactArgument> all() const {
    std::vector<FactArgument> names;
    for (std::size_t at = 0; at < tokens_.size();) {
      if (!named_[at] || isOfArticles(grammar_, tokens_[at].folded) ||
          isJoiner(grammar_, tokens_[at].folded)) {
        ++at;
        continue;
      }
      const std::size_t end = endOf(at);
      if (end - at <= kLongestName && isTelling(at, end)) names.push_back(nameOf(at, end));
      at = end;
    }
    return names;
  }

 private:
  /// Behind the words that are named, and what joins them: "sala de pintura".
  std::size_t endOf(std::size_t at) const {
    std::size_t end = at + 1;
    for (;;) {
      const bool ends = isCut(end - 1);
      if (ends || end >= tokens_.size()) return end;
      if (named_[end] && !isOfArticles(grammar_, tokens_[end].folded)) {
        ++end;
      } else if (end + 1 < tokens_.size() && named_[end + 1] &&
                 isJoiner(grammar_, tokens_[end].folded)) {
        end += 2;
      } else {
        return end;
      }
    }
  }

  /// "tool crib's", where no name follows: the verb.
  bool isCut(std::size_t at) const {
    const std::string& word = tokens_[at].folded;
    const bool clitic = word.size() > 2 && word.compare(word.size() - 2, 2, "'s") == 0;
    return clitic && (at + 1 >= tokens_.size() || !named_[at + 1]);
  }

  bool isTelling(std::size_t begin, std::size_t end) const {
    for (std::size_t at = begin; at < end; ++at) {
      const Token& token = tokens_[at];
      if (token.kind == TokenKind::kQuoted) return true;
      if (token.kind != TokenKind::kWord) continue;
      if (isKind(grammar_, token.folded)) return true;
      // A word of a person's or a place's own, and no first one of a sentence.
      const bool upper = token.starts_upper && token.text.size() > 2 && at > 0;
      const bool means = grammar_.known_words.count(token.folded) != 0;
      if (upper && !means) return true;
    }
    return false;
  }

  FactArgument nameOf(std::size_t begin, std::size_t end) const {
    FactArgument name;
    std::size_t to = tokens_[end - 1].range.end;
    if (isCut(end - 1)) {
      const std::size_t mark =
          part_.text.find_last_of("'\x99", to - 1);  // the last byte of a curved one
      if (mark != std::string::npos && mark >= 2) {
        to = part_.text[mark] == '\'' ? mark : mark - 2;
      }
    }
    const std::size_t from = tokens_[begin].range.begin;
    name.text = part_.text.substr(from, to - from);
    const bool common = begin == 0 && grammar_.isNounOrTitle(tokens_[0].folded);
    if (common && name.text[0] >= 'A' && name.text[0] <= 'Z') {
      name.text[0] = static_cast<char>(name.text[0] - 'A' + 'a');
    }
    if (begin > 0 && isOfArticles(grammar_, tokens_[begin - 1].folded)) {
      name.article = tokens_[begin - 1].folded;
    }
    name.range = {part_.range.begin + from, part_.range.begin + to};
    return name;
  }

  const CompiledGrammar& grammar_;
  const Utterance& part_;
  std::vector<Token> tokens_;
  std::vector<bool> named_;
};

}  // namespace

bool isHeardName(const std::string& name, const language::CompiledGrammar& grammar) {
  const auto tokens = language::tokenize(name, {0, name.size()}, grammar.tokenRules());
  return std::any_of(tokens.begin(), tokens.end(), [&](const Token& token) {
    return token.kind == TokenKind::kQuoted || isKind(grammar, token.folded) ||
           (token.starts_upper && grammar.known_words.count(token.folded) == 0);
  });
}

std::vector<FactArgument> heardNames(const Utterance& part, const Reading& reading,
                                     const CompiledGrammar& grammar) {
  return NamesOf(part, reading, grammar).all();
}

std::string wordsBeside(const std::vector<FactArgument>& names, const Utterance& part,
                        const CompiledGrammar& grammar) {
  const auto tokens = language::tokenize(part.text, {0, part.text.size()}, grammar.tokenRules());
  const auto isNamed = [&](const Token& token) {
    return std::any_of(names.begin(), names.end(), [&](const FactArgument& name) {
      return name.range.begin < part.range.begin + token.range.end &&
             part.range.begin + token.range.begin < name.range.end;
    });
  };
  const auto ends = [&](const Token& token) {
    return token.kind == TokenKind::kComma || token.kind == TokenKind::kMark || isNamed(token);
  };
  std::string longest;
  for (std::size_t at = 0; at < tokens.size(); ++at) {
    if (ends(tokens[at])) continue;
    std::size_t end = at;
    while (end < tokens.size() && !ends(tokens[end])) ++end;
    std::size_t last = end;  // not with the article of the name behind it
    while (last > at && isOfArticles(grammar, tokens[last - 1].folded)) --last;
    if (last > at) {
      const std::size_t from = tokens[at].range.begin;
      const std::string run = part.text.substr(from, tokens[last - 1].range.end - from);
      if (run.size() > longest.size()) longest = run;
    }
    at = end;
  }
  return longest;
}

}  // namespace hyselam_topo
