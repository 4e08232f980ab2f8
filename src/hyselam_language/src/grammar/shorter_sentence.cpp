#include "shorter_sentence.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "matching_costs.hpp"
#include "pattern_run.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::size_t kLongest = 40;  // tokens: nobody says "yes" to more

/// What it costs to leave out each token; kNever: it must stay.
std::vector<int> leaveOutCosts(const SentenceWords& words) {
  const CompiledGrammar& grammar = words.grammar;
  std::vector<int> costs;
  for (std::size_t at = 0; at < words.tokens.size(); ++at) {
    const Token& token = words.tokens[at];
    const bool tells = grammar.isNounOrTitle(token.folded) ||
                       (token.starts_upper && at > 0 && token.text.size() > 1);
    if (token.kind == TokenKind::kComma) {
      costs.push_back(0);
    } else if (token.kind != TokenKind::kWord || grammar.refusing_words.count(token.folded) != 0 ||
               grammar.telling_words.count(token.folded) != 0 ||
               grammar.number_words.count(token.folded) != 0) {
      costs.push_back(kNever);
    } else if (tells) {
      costs.push_back(kLeaveOutTelling);
    } else {
      const auto& matches = words.matches[at];
      const bool filler = std::any_of(matches.begin(), matches.end(), [&](const auto& match) {
        return grammar.fillers_inner.count(match.word) != 0;
      });
      costs.push_back(filler ? kLeaveOutFiller : kLeaveOutWord);
    }
  }
  return costs;
}

/// The sum of the costs from each token to the end; kNever where one of them must stay.
std::vector<int> costsToEnd(const std::vector<int>& costs) {
  std::vector<int> sums(costs.size() + 1, 0);
  for (std::size_t at = costs.size(); at-- > 0;) {
    sums[at] = costs[at] >= kNever ? kNever : std::min(kNever, sums[at + 1] + costs[at]);
  }
  return sums;
}

class Shortening {
 public:
  explicit Shortening(const SentenceWords& from)
      : words_(from.grammar, from.text, from.sentence, from.tokens),
        costs_(leaveOutCosts(words_)),
        to_end_(costsToEnd(costs_)),
        run_(&words_, costs_) {}

  std::optional<ShorterSentence> find() {
    int before = 0;
    for (std::size_t begin = 0; begin < words_.tokens.size() && before < best_; ++begin) {
      if (!words_.isComma(begin)) tryFrom(begin, before);
      before = costs_[begin] >= kNever ? kNever : before + costs_[begin];
    }
    // Half of what was said, or a good part of what tells: somebody else's sentence.
    const std::size_t left = static_cast<std::size_t>(std::count(kept_.begin(), kept_.end(), true));
    if (best_ >= kNever || 5 * left < 2 * words_.tokens.size() ||
        best_ - patterns_ > 2 * kLeaveOutTelling + kLeaveOutWord) {
      return std::nullopt;
    }
    return ShorterSentence{keptText(), names_, longestRunLeftOut()};
  }

 private:
  void tryFrom(std::size_t begin, int before) {
    for (const IntentInfo& intent : words_.grammar.intents) {
      const bool asks =
          intent.kind == UtteranceKind::kQuestion || intent.kind == UtteranceKind::kCommand;
      if (!intent.refuse.empty() || intent.only_expected || intent.only_correction ||
          intent.kind == UtteranceKind::kAnswer || (words_.sentence.is_question && !asks)) {
        continue;
      }
      // "You can go to the kitchen" tells nobody to go there.
      if (intent.kind == UtteranceKind::kCommand && begin > 0) continue;
      for (const Automaton& pattern : intent.patterns) {
        if (!run_.mayBegin(pattern, begin)) continue;
        for (const PatternRun::End& end : run_.run(pattern, begin)) {
          if (to_end_[end.at] >= kNever || end.tied) continue;
          const int cost = before + end.cost + intent.cost + to_end_[end.at];
          if (cost >= best_) continue;
          const auto path = run_.path(end.at);
          if (path && !cutsName(*path)) take(cost, *path);
        }
      }
    }
  }

  /// Whether an article before a name was left out, or a word behind it that may well belong to
  /// it: "the loading [bay]".
  bool cutsName(const std::vector<PatternRun::Step>& path) const {
    std::vector<bool> kept(words_.tokens.size(), false);
    for (const PatternRun::Step& step : path) {
      for (std::size_t at = step.from; step.edge && at < step.to; ++at) kept[at] = true;
    }
    return std::any_of(path.begin(), path.end(), [&](const PatternRun::Step& step) {
      if (!step.edge || step.edge->kind != EdgeKind::kName) return false;
      const NameType& type = words_.grammar.name_types[static_cast<std::size_t>(step.edge->b)];
      const bool without_article = step.from > 0 && !kept[step.from - 1] &&
                                   type.isArticle(words_.tokens[step.from - 1].folded);
      const bool behind = step.to < kept.size() && !kept[step.to];
      return without_article || (behind && mayGoOn(words_.tokens[step.to], type));
    });
  }

  static bool mayGoOn(const Token& token, const NameType& type) {
    return token.kind != TokenKind::kComma && type.stop.count(token.lower) == 0;
  }

  void take(int cost, const std::vector<PatternRun::Step>& path) {
    best_ = cost;
    kept_.assign(words_.tokens.size(), false);
    names_.clear();
    for (const PatternRun::Step& step : path) {
      if (!step.edge) continue;
      for (std::size_t at = step.from; at < step.to; ++at) kept_[at] = true;
      if (step.edge->kind != EdgeKind::kName) continue;
      for (const FoundName& name : words_.namesAt(step.from, step.edge->b)) {
        if (name.end == step.to) names_.push_back(name.name.text);
      }
    }
    patterns_ = cost;
    // What must stay and is not kept was skipped by the pattern at a price of its own.
    for (std::size_t at = 0; at < kept_.size(); ++at) {
      patterns_ -= kept_[at] || costs_[at] >= kNever ? 0 : costs_[at];
    }
  }

  TextRange longestRunLeftOut() const {
    TextRange longest;
    std::size_t most = 0;
    for (std::size_t at = 0; at < kept_.size();) {
      std::size_t end = at;
      while (end < kept_.size() && !kept_[end] && !words_.isComma(end)) ++end;
      if (end - at > most) {
        most = end - at;
        longest = {words_.tokens[at].range.begin, words_.tokens[end - 1].range.end};
      }
      at = end + 1;
    }
    return longest;
  }

  std::string keptText() const {
    std::string text;
    std::size_t end = 0;
    for (std::size_t at = 0; at < kept_.size(); ++at) {
      const TextRange range = words_.tokens[at].range;
      if (!kept_[at] || (range.begin < end && end > 0)) continue;
      const bool apart = !text.empty() && range.begin != end;
      text += (apart ? " " : "") + words_.textOf(range);
      end = range.end;
    }
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') {
      text[0] = static_cast<char>(text[0] - 'a' + 'A');
    }
    return text + (words_.sentence.is_question ? "?" : ".");
  }

  SentenceWords words_;
  const std::vector<int> costs_;
  const std::vector<int> to_end_;
  PatternRun run_;
  int best_ = kNever;
  int patterns_ = 0;  ///< of the best cost, what no word left out has
  std::vector<bool> kept_;
  std::vector<std::string> names_;
};

}  // namespace

std::optional<ShorterSentence> shorterSentence(const SentenceWords& words) {
  if (words.tokens.empty() || words.tokens.size() > kLongest) return std::nullopt;
  return Shortening(words).find();
}

}  // namespace language
}  // namespace hyselam_topo
