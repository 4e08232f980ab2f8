// The words of a text for the search of urgent words, which must find them in any text.
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/grammar/utterance.hpp"
#include "urgent_phrases.hpp"

namespace hyselam_topo {
namespace language {

struct UrgentToken {
  UrgentWord word;
  TextRange range;
  bool after_mark = false;  ///< a comma, full stop or the like stands before it
  bool quoted = false;      ///< between quotation marks
  bool sign = false;        ///< an emoji or another sign that is no punctuation
};

/// Letters and digits, apostrophes within left out ("don't" is "dont"); single letters in a row are
/// one word ("S.T.O.P."), signs such as emoji a word each.
std::vector<UrgentToken> urgentTokens(const std::string& text);

}  // namespace language
}  // namespace hyselam_topo
