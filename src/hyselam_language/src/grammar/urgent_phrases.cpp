#include "urgent_phrases.hpp"

#include <algorithm>
#include <map>

#include "hyselam_common/utf8.hpp"
#include "urgent_tokens.hpp"
#include "word_lists.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Letters that stand several times in a row once. `stretched`: whether some stood three times.
std::string squeeze(const std::string& text, bool* stretched) {
  std::string out, last;
  int run = 0;
  std::size_t length = 0;
  for (std::size_t i = 0; i < text.size(); i += length) {
    hyselam::utf8CodeAt(text, i, text.size(), &length);
    if (length == 0) break;
    const std::string letter = text.substr(i, length);
    run = letter == last ? run + 1 : 1;
    if (run == 1) out += letter;
    if (run >= 3) *stretched = true;
    last = letter;
  }
  return out;
}

}  // namespace

UrgentWord urgentWord(const std::string& word) {
  UrgentWord made;
  made.lower = hyselam::utf8Lower(word);
  made.folded = hyselam::utf8Fold(word);
  made.squeezed_lower = squeeze(made.lower, &made.stretched);
  made.squeezed = squeeze(made.folded, &made.stretched);
  return made;
}

void UrgentPhrases::add(UrgentKind kind, const std::string& text) {
  UrgentPhrase phrase;
  phrase.kind = kind;
  for (const UrgentToken& token : urgentTokens(text)) phrase.words.push_back(token.word);
  if (phrase.words.empty()) return;
  by_first.emplace(phrase.words.front().squeezed, phrases.size());
  phrases.push_back(std::move(phrase));
}

void readUrgent(const GrammarNode& node, UrgentPhrases* phrases) {
  static const std::map<std::string, UrgentKind> kinds{{"stop", UrgentKind::kStop},
                                                       {"stop_last", UrgentKind::kStopLast},
                                                       {"stop_alone", UrgentKind::kStopAlone},
                                                       {"cancel", UrgentKind::kCancel},
                                                       {"cancel_alone", UrgentKind::kCancelAlone},
                                                       {"around", UrgentKind::kAround},
                                                       {"not", UrgentKind::kNot}};
  node.each([&](const std::string& key, const GrammarNode& list) {
    const auto kind = kinds.find(key);
    if (kind == kinds.end()) list.fail("this key is not known");
    for (const std::string& text : list.texts()) {
      for (const std::string& phrase : expanded(list, text)) {
        if (urgentTokens(phrase).empty()) list.fail("there is an empty entry");
        phrases->add(kind->second, phrase);
      }
    }
  });
}

}  // namespace language
}  // namespace hyselam_topo
