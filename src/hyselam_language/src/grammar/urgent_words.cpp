#include "hyselam_language/grammar/urgent_words.hpp"

#include <algorithm>
#include <set>

#include "compiled_grammar.hpp"
#include "hyselam_common/edit_distance.hpp"
#include "urgent_tokens.hpp"

namespace hyselam_topo {
namespace {

using language::UrgentKind;
using language::UrgentPhrase;
using language::UrgentToken;
using language::UrgentWord;

constexpr std::size_t kMinSlip = 4;  // shorter words may not be misspelt [letters]

bool same(const UrgentWord& said, const UrgentWord& known) {
  // "pára" is only itself; "não" may be written "nao".
  const bool accented = known.lower != known.folded;
  const std::string& a = accented ? said.lower : said.folded;
  const std::string& b = accented ? known.lower : known.folded;
  if (a == b) return true;
  if (!said.stretched) return false;
  return accented ? said.squeezed_lower == known.squeezed_lower : said.squeezed == known.squeezed;
}

/// "stopstop".
bool isRepeated(const std::string& said, const std::string& word) {
  if (word.size() < kMinSlip || said.size() < 2 * word.size() || said.size() % word.size() != 0) {
    return false;
  }
  for (std::size_t i = 0; i < said.size(); i += word.size()) {
    if (said.compare(i, word.size(), word) != 0) return false;
  }
  return true;
}

/// One letter too many, missing, wrong, or two swapped; the first one right or swapped.
bool isSlip(const std::string& said, const std::string& word) {
  if (word.size() < kMinSlip || said.size() + 1 < word.size() || said.size() > word.size() + 1) {
    return false;
  }
  if (said[0] != word[0] && said[0] != word[1]) return false;
  return hyselam::isOneEditApart(said, word);
}

/// Phrases of `urgent` that were found in a text.
struct Found {
  UrgentKind kind = UrgentKind::kStop;
  std::size_t begin = 0, end = 0;  // tokens
  bool slip = false;
  std::set<std::string> languages;
};

bool isUrgent(UrgentKind kind) {
  return kind != UrgentKind::kAround && kind != UrgentKind::kNot;
}

bool isCancel(UrgentKind kind) {
  return kind == UrgentKind::kCancel || kind == UrgentKind::kCancelAlone;
}

class Search {
 public:
  Search(const std::string& text, const std::vector<Grammar>& grammars)
      : text_(text),
        grammars_(grammars),
        tokens_(language::urgentTokens(text)),
        by_begin_(tokens_.size() + 1),
        by_end_(tokens_.size() + 1) {
    dropQuoted();
    for (const Grammar& grammar : grammars_) findPhrases(grammar);
    findSlips();
    mark();
  }

  UrgentWords result() {
    UrgentWords words;
    std::vector<const Found*> counted;
    for (const Found& each : found_) {
      if (isUrgent(each.kind) && counts(each)) counted.push_back(&each);
    }
    if (counted.empty()) return words;
    words.urgency = Urgency::kCancel;
    std::set<std::string> languages;
    std::vector<bool> taken(tokens_.size(), false);
    std::size_t last = 0;
    for (const Found* each : counted) {
      if (!isCancel(each->kind)) words.urgency = Urgency::kStop;
      std::fill(taken.begin() + static_cast<std::ptrdiff_t>(each->begin),
                taken.begin() + static_cast<std::ptrdiff_t>(each->end), true);
      last = std::max(last, each->end);
      if (languages.empty()) {
        languages = each->languages;
      } else {
        std::set<std::string> both;
        std::set_intersection(languages.begin(), languages.end(), each->languages.begin(),
                              each->languages.end(), std::inserter(both, both.begin()));
        if (!both.empty()) languages = both;
      }
    }
    words.languages.assign(languages.begin(), languages.end());
    addRest(taken, last, &words.rest);
    return words;
  }

 private:
  void dropQuoted() {
    const auto outside = std::count_if(tokens_.begin(), tokens_.end(),
                                       [](const UrgentToken& token) { return !token.quoted; });
    if (outside == 0) return;  // all of it stands between quotation marks
    for (UrgentToken& token : tokens_) {
      if (token.quoted) token.word = {};
    }
  }

  void findPhrases(const Grammar& grammar) {
    const auto& urgent = grammar.compiled().urgent;
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      const auto [begin, end] = urgent.by_first.equal_range(tokens_[i].word.squeezed);
      for (auto at = begin; at != end; ++at) {
        const UrgentPhrase& phrase = urgent.phrases[at->second];
        if (fits(phrase, i)) {
          add({phrase.kind, i, i + phrase.words.size(), false, {grammar.language()}});
        }
      }
    }
  }

  bool fits(const UrgentPhrase& phrase, std::size_t at) const {
    if (at + phrase.words.size() > tokens_.size()) return false;
    for (std::size_t k = 0; k < phrase.words.size(); ++k) {
      if (!same(tokens_[at + k].word, phrase.words[k])) return false;
      // "Don't, stop!" is no "don't stop".
      if (k > 0 && phrase.kind == UrgentKind::kNot && tokens_[at + k].after_mark) return false;
    }
    return true;
  }

  void add(const Found& found) {
    for (const std::size_t index : by_begin_[found.begin]) {
      Found& known = found_[index];
      if (known.kind != found.kind || known.end != found.end) continue;
      known.languages.insert(found.languages.begin(), found.languages.end());
      return;
    }
    by_begin_[found.begin].push_back(found_.size());
    by_end_[found.end].push_back(found_.size());
    found_.push_back(found);
  }

  bool isKnown(const std::string& folded) const {
    return std::any_of(grammars_.begin(), grammars_.end(), [&](const Grammar& grammar) {
      return grammar.compiled().known_words.count(folded) != 0;
    });
  }

  /// Whether a name or another part of a sentence goes on behind this word: "the", "room", "in".
  bool leadsOn(const std::string& folded) const {
    return std::any_of(grammars_.begin(), grammars_.end(), [&](const Grammar& grammar) {
      const language::NameType* type = grammar.compiled().nameType("place");
      return type != nullptr &&
             (type->isArticle(folded) || type->joiners.count(folded) != 0 ||
              type->stop.count(folded) != 0 || type->generic.count(folded) != 0 ||
              type->titles.count(folded) != 0);
    });
  }

  void findSlips() {
    std::vector<bool> covered(tokens_.size(), false);
    for (const Found& each : found_) {
      std::fill(covered.begin() + static_cast<std::ptrdiff_t>(each.begin),
                covered.begin() + static_cast<std::ptrdiff_t>(each.end), true);
    }
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      const std::string& said = tokens_[i].word.folded;
      if (said.size() + 1 < kMinSlip || covered[i]) continue;
      for (const Grammar& grammar : grammars_) {
        for (const UrgentPhrase& phrase : grammar.compiled().urgent.phrases) {
          const bool anywhere =
              phrase.kind == UrgentKind::kStop || phrase.kind == UrgentKind::kCancel;
          if (!anywhere || phrase.words.size() != 1) continue;
          const UrgentWord& word = phrase.words.front();
          if (word.lower != word.folded) continue;
          const bool repeated = isRepeated(said, word.folded);
          if (!repeated && (!isSlip(said, word.folded) || isKnown(said))) continue;
          add({phrase.kind, i, i + 1, !repeated, {grammar.language()}});
        }
      }
    }
  }

  /// Which tokens say nothing of their own beside urgent words, and which are no urgent words.
  void mark() {
    light_.assign(tokens_.size(), false);
    exempt_.assign(tokens_.size(), false);
    for (const Found& each : found_) {
      auto& marks = each.kind == UrgentKind::kNot ? exempt_ : light_;
      std::fill(marks.begin() + static_cast<std::ptrdiff_t>(each.begin),
                marks.begin() + static_cast<std::ptrdiff_t>(each.end), true);
    }
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      if (tokens_[i].sign) light_[i] = true;
      if (exempt_[i]) light_[i] = false;
    }
  }

  bool allLight(std::size_t begin, std::size_t end) const {
    return std::all_of(light_.begin() + static_cast<std::ptrdiff_t>(begin),
                       light_.begin() + static_cast<std::ptrdiff_t>(end),
                       [](bool light) { return light; });
  }

  bool counts(const Found& found) const {
    for (std::size_t i = found.begin; i < found.end; ++i) {
      if (exempt_[i]) return false;
    }
    if (found.slip) {
      // "the stoop is on the left" is none, "go to the kitchen no stpo" is one.
      const bool free = found.begin == 0 || tokens_[found.begin].after_mark ||
                        light_[found.begin - 1] || !leadsOn(tokens_[found.begin - 1].word.folded);
      return free && (allLight(0, found.begin) || allLight(found.end, tokens_.size()));
    }
    switch (found.kind) {
      case UrgentKind::kStopLast:
        return isLast(found) || isRepeatedPhrase(found);
      case UrgentKind::kStopAlone:
      case UrgentKind::kCancelAlone:
        return (allLight(0, found.begin) && allLight(found.end, tokens_.size())) ||
               isRepeatedPhrase(found);
      default:
        return true;
    }
  }

  /// Nothing follows in its clause but words that say nothing.
  bool isLast(const Found& found) const {
    for (std::size_t i = found.end; i < tokens_.size(); ++i) {
      if (tokens_[i].after_mark) return true;
      if (!light_[i]) return false;
    }
    return true;
  }

  /// The same again right behind or before it, with at most one word between that says
  /// nothing.
  bool isRepeatedPhrase(const Found& found) const {
    const auto isSame = [&](std::size_t index) {
      const Found& each = found_[index];
      return each.kind == found.kind && !each.slip &&
             tokens_[each.begin].word.squeezed == tokens_[found.begin].word.squeezed;
    };
    for (std::size_t gap = 0; gap < 2; ++gap) {
      const std::size_t next = found.end + gap;
      if (next < tokens_.size() && allLight(found.end, next) &&
          std::any_of(by_begin_[next].begin(), by_begin_[next].end(), isSame)) {
        return true;
      }
      if (found.begin < gap) continue;
      const std::size_t previous = found.begin - gap;
      if (previous > 0 && allLight(previous, found.begin) &&
          std::any_of(by_end_[previous].begin(), by_end_[previous].end(), isSame)) {
        return true;
      }
    }
    return false;
  }

  /// What stands between urgent words, unless it says nothing.
  void addRest(const std::vector<bool>& taken, std::size_t last,
               std::vector<UrgentRest>* rest) const {
    for (std::size_t i = 0; i < tokens_.size();) {
      std::size_t end = i;
      while (end < tokens_.size() && !taken[end]) ++end;
      if (end > i && !allLight(i, end)) {
        std::size_t until = end < tokens_.size() ? tokens_[end].range.begin : text_.size();
        std::size_t from = i == 0 ? 0 : tokens_[i].range.begin;
        while (until > from && isSpace(text_[until - 1])) --until;
        while (from < until && isSpace(text_[from])) ++from;
        rest->push_back({text_.substr(from, until - from), i >= last});
      }
      i = std::max(end, i + 1);
    }
  }

  static bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

  const std::string& text_;
  const std::vector<Grammar>& grammars_;
  std::vector<UrgentToken> tokens_;
  std::vector<Found> found_;
  std::vector<std::vector<std::size_t>> by_begin_, by_end_;  // of found_
  std::vector<bool> light_, exempt_;
};

}  // namespace

const char* toString(Urgency urgency) {
  switch (urgency) {
    case Urgency::kStop:
      return "stop";
    case Urgency::kCancel:
      return "cancel";
    case Urgency::kNone:
      break;
  }
  return "none";
}

UrgentWords findUrgentWords(const std::string& text, const std::vector<Grammar>& grammars) {
  return Search(text, grammars).result();
}

}  // namespace hyselam_topo
