// The section `urgent` of a grammar as the search uses it.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "grammar_node.hpp"

namespace hyselam_topo {
namespace language {

/// What a phrase of urgent words is, and where it counts.
enum class UrgentKind {
  kStop,         ///< anywhere
  kStopLast,     ///< where nothing follows that it could lead to, or repeated: "para"
  kStopAlone,    ///< where nothing else was said, or repeated: "wait"
  kCancel,       ///< anywhere
  kCancelAlone,  ///< where nothing else was said, or repeated: "forget it"
  kAround,       ///< may stand around urgent words and says nothing then: "please"
  kNot           ///< has an urgent word in it and is none: "bus stop"
};

/// A word of such a phrase, or of a text, in the forms that are compared.
struct UrgentWord {
  std::string lower;
  std::string folded;    ///< without accents
  std::string squeezed;  ///< without accents, repeated letters made one: "STOOOP" is "stop"
  std::string squeezed_lower;
  bool stretched = false;  ///< three or more of a letter in a row
};

UrgentWord urgentWord(const std::string& word);

struct UrgentPhrase {
  UrgentKind kind = UrgentKind::kStop;
  std::vector<UrgentWord> words;
};

struct UrgentPhrases {
  std::vector<UrgentPhrase> phrases;
  /// By the first word, folded and squeezed.
  std::unordered_multimap<std::string, std::size_t> by_first;

  void add(UrgentKind kind, const std::string& text);
};

/// Reads the section; @throws hyselam::InputError for unknown keys and empty phrases.
void readUrgent(const GrammarNode& node, UrgentPhrases* phrases);

}  // namespace language
}  // namespace hyselam_topo
