#include "clause_borders.hpp"

#include <algorithm>
#include <map>

#include "matching_costs.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// The cost of a phrase without meaning at a token; -1 if it is not there. What is misspelt is no
/// mere filler.
int fillerCost(const Phrase& phrase, std::size_t at, const SentenceWords& words) {
  const int cost = phraseCost(phrase, at, words.matches);
  return cost < kSlipCost ? cost : -1;
}

/// Follows phrases, each of them at a cost, as far as they go from a token.
class PhraseWalk {
 public:
  PhraseWalk(const SentenceWords& words, const std::vector<Phrase>& phrases,
             const PhraseStarts& starts, int each)
      : words_(words), phrases_(phrases), starts_(starts), each_(each) {}

  /// Calls f(position, cost) for each place on the way.
  template <typename F>
  void follow(std::size_t at, int cost, F&& f, int depth = 0) const {
    constexpr int kMaxFillers = 4;
    f(at, cost);
    if (depth == kMaxFillers || at >= words_.tokens.size()) return;
    if (words_.isComma(at)) {
      follow(at + 1, cost + kCommaCost, f, depth + 1);
      return;
    }
    for (const std::size_t number : starts_.beginningWith(words_.matches[at])) {
      const Phrase& phrase = phrases_[number];
      const int more = fillerCost(phrase, at, words_);
      if (more >= 0) follow(at + phrase.size(), cost + each_ + more, f, depth + 1);
    }
  }

 private:
  const SentenceWords& words_;
  const std::vector<Phrase>& phrases_;
  const PhraseStarts& starts_;
  int each_;
};

/// "Não, há uma cozinha ..." corrects what was told, "não há cozinha ..." denies: a word that
/// does both corrects only before a comma or a definite article.
bool deniesWhatFollows(const SentenceWords& words, std::size_t begin, std::size_t end) {
  if (end != begin + 1 || end >= words.tokens.size() || words.isComma(end)) return false;
  const CompiledGrammar& grammar = words.grammar;
  const auto code = grammar.refusing_words.find(words.tokens[begin].folded);
  if (code == grammar.refusing_words.end() || code->second != "denial") return false;
  return std::none_of(
      grammar.name_types.begin(), grammar.name_types.end(),
      [&](const NameType& type) { return type.definite.count(words.tokens[end].folded) != 0; });
}

}  // namespace

std::vector<Entry> entriesAt(const SentenceWords& words, std::size_t at) {
  std::map<std::pair<std::size_t, bool>, int> cheapest;
  const auto note = [&](std::size_t to, int cost, bool correction) {
    if (to >= words.tokens.size() || words.isComma(to)) return;
    const auto [entry, is_new] = cheapest.emplace(std::make_pair(to, correction), cost);
    if (!is_new) entry->second = std::min(entry->second, cost);
  };
  const PhraseWalk fillers(words, words.grammar.fillers_before, words.grammar.before_starts,
                           kFillerCost);
  // "no, wait, sorry, ..."
  constexpr int kMaxCorrections = 3;
  const auto correct = [&](auto&& self, std::size_t to, int cost, int depth) -> void {
    if (depth == kMaxCorrections) return;
    if (to >= words.tokens.size()) return;
    for (const std::size_t number :
         words.grammar.correction_starts.beginningWith(words.matches[to])) {
      const Phrase& phrase = words.grammar.corrections[number];
      const int more = fillerCost(phrase, to, words);
      const std::size_t behind = to + phrase.size();
      if (more < 0 || deniesWhatFollows(words, to, behind)) continue;
      fillers.follow(behind, cost + kFillerCost + more, [&](std::size_t last, int total) {
        note(last, total, true);
        self(self, last, total, depth + 1);
      });
    }
  };
  fillers.follow(at, 0, [&](std::size_t to, int cost) {
    note(to, cost, false);
    correct(correct, to, cost, 0);
  });
  std::vector<Entry> entries;
  entries.reserve(cheapest.size());
  for (const auto& [key, cost] : cheapest) entries.push_back({key.first, cost, key.second});
  return entries;
}

Exits exitsAt(const SentenceWords& words, std::size_t at) {
  Exits exits;
  const PhraseWalk fillers(words, words.grammar.fillers_after, words.grammar.after_starts,
                           kFillerCost);
  fillers.follow(at, 0, [&](std::size_t to, int cost) {
    if (to == at || to == words.tokens.size() || !words.isComma(to - 1)) {
      exits.emplace_back(to, cost);
    }
  });
  return exits;
}

Exits separatorsAt(const SentenceWords& words, std::size_t at) {
  Exits found;
  const PhraseWalk separators(words, words.grammar.clause_separators,
                              words.grammar.separator_starts, kSeparatorCost);
  separators.follow(at, 0, [&](std::size_t to, int cost) {
    if (to > at && to < words.tokens.size()) found.emplace_back(to, cost);
  });
  return found;
}

}  // namespace language
}  // namespace hyselam_topo
