#include "sentence_parts.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "asides.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::size_t kMostParts = 8;  // between commas and words such as "and": more are a story
constexpr std::size_t kMostClauses = 20;
constexpr int kReadCost = 1;
constexpr int kAsideCost = 4;
constexpr int kLostCost = 20;  ///< a part that tells something and is not understood

/// Whether one of the phrases stands at a token, word by word.
bool standsAt(const std::vector<Phrase>& phrases, const std::vector<Token>& tokens, std::size_t at,
              const Vocabulary& vocabulary) {
  return std::any_of(phrases.begin(), phrases.end(), [&](const Phrase& phrase) {
    if (at + phrase.size() > tokens.size()) return false;
    for (std::size_t i = 0; i < phrase.size(); ++i) {
      if (tokens[at + i].lower != vocabulary.text(phrase[i])) return false;
    }
    return true;
  });
}

/// Tokens [begin, end) between borders: commas, words such as "and", and the first words of
/// clauses.
struct Part {
  std::size_t begin = 0;
  std::size_t end = 0;
  bool run_on = false;  ///< nothing separates it from the part before
};

/// "The lab is on the left | dont ask me why": where nothing separates a clause from the one
/// before.
bool startsClause(const std::vector<Token>& tokens, std::size_t at,
                  const CompiledGrammar& grammar) {
  if (grammar.no_clause_after.count(tokens[at - 1].folded) != 0) return false;
  const std::size_t end = tokens.size();
  if (grammar.clause_starts.standAt(tokens, at, end)) return true;
  return grammar.only_behind_comma.count(tokens[at].folded) == 0 &&
         (grammar.idle_asides.standAt(tokens, at, end) ||
          grammar.past_asides.standAt(tokens, at, end));
}

std::vector<Part> partsOf(const std::vector<Token>& tokens, const CompiledGrammar& grammar) {
  std::vector<Part> parts;
  for (std::size_t at = 0; at < tokens.size(); ++at) {
    const bool border = at == 0 || isComma(tokens[at - 1]) ||
                        standsAt(grammar.clause_separators, tokens, at, grammar.vocabulary);
    if (isComma(tokens[at])) continue;
    const bool behind_separator =
        !parts.empty() && parts.back().end == at && parts.back().end == parts.back().begin + 1 &&
        standsAt(grammar.clause_separators, tokens, parts.back().begin, grammar.vocabulary);
    if (!behind_separator && (border || startsClause(tokens, at, grammar))) {
      parts.push_back({at, at, !border});
    }
    parts.back().end = at + 1;
  }
  return parts;
}

/// "Nobody says that the kitchen is on the left and the lab is next to it": how far the denial
/// reaches cannot be told.
bool deniesWhatIsSaid(const Part& part, const std::vector<Token>& tokens,
                      const CompiledGrammar& grammar) {
  if (!denies(tokens, part.begin, part.end, grammar)) return false;
  return std::any_of(
      tokens.begin() + static_cast<std::ptrdiff_t>(part.begin),
      tokens.begin() + static_cast<std::ptrdiff_t>(part.end),
      [&](const Token& token) { return grammar.saying_words.count(token.folded) != 0; });
}

std::size_t behindSeparator(const Part& part, const std::vector<Token>& tokens,
                            const CompiledGrammar& grammar) {
  const bool separated =
      standsAt(grammar.clause_separators, tokens, part.begin, grammar.vocabulary);
  return separated ? part.begin + 1 : part.begin;
}

/// Whether the part may change what the others say: doubt, a condition, a choice, a correction.
bool mayChangeOthers(const Part& part, const std::vector<Token>& tokens,
                     const CompiledGrammar& grammar) {
  if (doubts(tokens, part.begin, part.end, grammar)) return true;
  for (std::size_t at = part.begin; at < part.end; ++at) {
    at = fillerEnd(tokens, at, grammar);
    if (at >= part.end) break;
    if (isReflexive(tokens, at, grammar)) continue;
    const auto code = grammar.refusing_words.find(tokens[at].folded);
    const bool uncertain =
        code != grammar.refusing_words.end() &&
        (code->second == "uncertain" || code->second == "choice" || code->second == "condition");
    // "There's no window": "no" corrects only where a part begins.
    const bool inside_no = code != grammar.refusing_words.end() && code->second == "denial" &&
                           at > behindSeparator(part, tokens, grammar);
    const bool corrects = standsAt(grammar.corrections, tokens, at, grammar.vocabulary);
    if (uncertain || (corrects && !inside_no)) return true;
  }
  return false;
}

/// "[The lab is next to the bar,] not next to the library", "not the kitchen": it denies nothing
/// that is told beside it.
bool isContrast(const Part& part, const std::vector<Token>& tokens,
                const CompiledGrammar& grammar) {
  const std::size_t at = behindSeparator(part, tokens, grammar);
  if (at + 1 >= part.end) return false;
  const auto code = grammar.refusing_words.find(tokens[at].folded);
  if (code == grammar.refusing_words.end() || code->second != "denial") return false;
  const Token& next = tokens[at + 1];
  const NameType* places = grammar.nameType("place");
  return grammar.placing_words.count(next.folded) != 0 || next.starts_upper ||
         (places != nullptr && places->isArticle(next.folded));
}

class Parts {
 public:
  Parts(const std::vector<Token>& tokens, const std::string& text, const CompiledGrammar& grammar,
        const ReadBeginnings& read)
      : tokens_(tokens), text_(text), grammar_(grammar), read_(read) {}

  std::vector<Utterance> run() {
    parts_ = partsOf(tokens_, grammar_);
    const auto separated =
        std::count_if(parts_.begin(), parts_.end(), [](const Part& part) { return !part.run_on; });
    if (parts_.size() < 2 || static_cast<std::size_t>(separated) > kMostParts ||
        parts_.size() > kMostClauses) {
      return {};
    }
    best_.assign(parts_.size() + 1, {});
    best_[0].cost = 0;
    for (std::size_t begin = 0; begin < parts_.size(); ++begin) extendFrom(begin);
    return assemble();
  }

 private:
  struct Best {
    int cost = std::numeric_limits<int>::max() / 2;
    std::size_t from = 0;
    std::vector<Utterance> said;  ///< nothing: not understood
  };

  std::vector<Token> tokensOf(std::size_t begin, std::size_t end) const {
    return {tokens_.begin() + static_cast<std::ptrdiff_t>(parts_[begin].begin),
            tokens_.begin() + static_cast<std::ptrdiff_t>(parts_[end - 1].end)};
  }

  void extendFrom(std::size_t begin) {
    const int lost = best_[begin].cost + (tells(begin) ? kLostCost : kAsideCost);
    if (lost < best_[begin + 1].cost) best_[begin + 1] = {lost, begin, {}};
    // "Doris reckons | there's a pool": who knows whether it is so.
    for (std::size_t at = begin; at > 0 && parts_[at].run_on && best_[at].said.empty(); --at) {
      if (!isAside(at - 1)) return;
    }
    std::vector<std::size_t> ends;
    for (std::size_t end = begin; end < parts_.size(); ++end) {
      ends.push_back(parts_[end].end - parts_[begin].begin);
    }
    const int read = best_[begin].cost + kReadCost;
    for (Beginning& beginning : read_(tokensOf(begin, parts_.size()), ends)) {
      if (!isUnderstood(beginning.said)) continue;
      const auto at = std::find(ends.begin(), ends.end(), beginning.end);
      const std::size_t end = begin + 1 + static_cast<std::size_t>(at - ends.begin());
      if (read < best_[end].cost) best_[end] = {read, begin, std::move(beginning.said)};
    }
  }

  /// "[The lab is on the left] dont ask me why".
  bool isAside(std::size_t part) const {
    return saysNothingOfNow(tokens_, parts_[part].begin, parts_[part].end, grammar_, true) &&
           !deniesWhatIsSaid(parts_[part], tokens_, grammar_);
  }

  bool tells(std::size_t part) const {
    return asidesOf(tokensOf(part, part + 1), grammar_, true).empty();
  }

  /// Whether "it" may be what the part speaks of, and not what was spoken of before.
  bool names(std::size_t part) const {
    const Part& of = parts_[part];
    for (std::size_t at = of.begin; at < of.end; ++at) {
      const bool name = tokens_[at].starts_upper && tokens_[at].text.size() > 1 && at > of.begin;
      if (name || grammar_.isNounOrTitle(tokens_[at].folded)) return true;
    }
    return false;
  }

  static bool refersBack(const std::vector<Utterance>& said) {
    return std::any_of(said.begin(), said.end(), [](const Utterance& u) {
      return std::any_of(u.slots.begin(), u.slots.end(), [](const Slot& slot) {
        return std::any_of(slot.names.begin(), slot.names.end(),
                           [](const SaidName& name) { return name.reference == "it"; });
      });
    });
  }

  TextRange rangeOf(std::size_t part) const {
    return {tokens_[parts_[part].begin].range.begin, tokens_[parts_[part].end - 1].range.end};
  }

  std::vector<Utterance> assemble() const {
    std::vector<std::size_t> ends;
    for (std::size_t end = parts_.size(); end > 0; end = best_[end].from) ends.push_back(end);
    std::reverse(ends.begin(), ends.end());
    std::vector<Utterance> all;
    std::vector<TextRange> left_out;
    bool understood = false, lost_before = false, denied = false, named = false;
    for (const std::size_t end : ends) {
      const Best& part = best_[end];
      if (!part.said.empty()) {
        // "Between A, which …, and B is C": what stands behind a lost part may be a piece of it.
        // "Yes, that's the one, the lab": a "yes" at the beginning is one whatever follows.
        const bool is_piece =
            std::any_of(part.said.begin(), part.said.end(), [&](const Utterance& u) {
              const bool yes = end == ends.front() && u.intent == "yes";
              return (u.kind == UtteranceKind::kAnswer && !yes) ||
                     (lost_before && u.intent == "alias");
            });
        if (is_piece || denied || (named && refersBack(part.said))) return {};
        named = false;
        all.insert(all.end(), part.said.begin(), part.said.end());
        // A greeting is no part that anything is clear of.
        understood =
            understood || std::any_of(part.said.begin(), part.said.end(), [](const Utterance& u) {
              return u.kind == UtteranceKind::kStatement || !u.slots.empty() ||
                     u.intent == "follow_me";
            });
        continue;
      }
      const Part& lost = parts_[end - 1];
      const bool contrast = understood && isContrast(lost, tokens_, grammar_);
      const bool aside = contrast || isAside(end - 1);
      if (!aside && mayChangeOthers(lost, tokens_, grammar_)) return {};
      const bool told = !aside && tells(end - 1);
      named = named || (!told && !contrast && names(end - 1));
      denied = denied || (!contrast && deniesWhatIsSaid(lost, tokens_, grammar_));
      lost_before = lost_before || told;
      note(end - 1, told, &all, &left_out);
    }
    if (!understood) return {};
    const auto first =
        std::find_if(all.begin(), all.end(), [](const Utterance& u) { return u.understood(); });
    for (const TextRange& range : left_out) {
      first->left_out.push_back(text_.substr(range.begin, range.end - range.begin));
    }
    return all;
  }

  /// A part that is not understood, one with what it goes on from where nothing separates them.
  void note(std::size_t part, bool told, std::vector<Utterance>* all,
            std::vector<TextRange>* left_out) const {
    const TextRange range = rangeOf(part);
    const std::size_t before = part > 0 ? rangeOf(part - 1).end : 0;
    const bool goes_on = parts_[part].run_on;
    if (goes_on && !all->empty() && !all->back().understood() && all->back().range.end == before) {
      all->back().range.end = range.end;
    } else if (told) {
      all->emplace_back();
      all->back().range = range;
    } else if (goes_on && !left_out->empty() && left_out->back().end == before) {
      left_out->back().end = range.end;
    } else {
      left_out->push_back(range);
    }
  }

  const std::vector<Token>& tokens_;
  const std::string& text_;
  const CompiledGrammar& grammar_;
  const ReadBeginnings& read_;
  std::vector<Part> parts_;
  std::vector<Best> best_;  ///< of the first parts, by their number
};

}  // namespace

std::vector<Utterance> readParts(const std::vector<Token>& tokens, const std::string& text,
                                 const CompiledGrammar& grammar, const ReadBeginnings& read) {
  return Parts(tokens, text, grammar, read).run();
}

}  // namespace language
}  // namespace hyselam_topo
