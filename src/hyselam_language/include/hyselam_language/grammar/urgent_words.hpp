// Words that must be obeyed whatever else was said: stop and cancel. They are searched in a text
// before it is parsed, by the section `urgent` of the grammars, of all languages at once.
//
// Found as speech recognizers and hasty people write them: without punctuation and capitals, with
// letters repeated ("STOOOP"), one slip of a letter, within a sentence ("hey robot wait no stop
// please"). In doubt it is a stop.
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"

namespace hyselam_topo {

enum class Urgency {
  kNone,
  kStop,   ///< "stop": no more motion
  kCancel  ///< "cancel": what was begun or asked is given up, and so is motion
};

/// "none", "stop", "cancel".
const char* toString(Urgency urgency);

/// What was said besides the urgent words.
struct UrgentRest {
  std::string text;
  bool after = false;  ///< behind the last urgent word
};

struct UrgentWords {
  Urgency urgency = Urgency::kNone;
  /// The languages that have such a word; more than one for "stop".
  std::vector<std::string> languages;
  /// Without parts that only stand around such words ("please", "hey robot"); in their order.
  std::vector<UrgentRest> rest;
};

/// Searches a text of any content and length; bytes that are no UTF-8 separate words. Time is
/// linear in its length. Words between quotation marks are data, unless nothing else was said.
UrgentWords findUrgentWords(const std::string& text, const std::vector<Grammar>& grammars);

}  // namespace hyselam_topo
