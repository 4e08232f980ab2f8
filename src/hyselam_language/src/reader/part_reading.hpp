// What the second reader makes of one part of a text that the grammar has refused: what to ask for,
// as sentences of the grammar's own.
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"
#include "hyselam_language/reader/fact_reader.hpp"

namespace hyselam_topo {

/// Of a proposal: before it, other proposals and reasons to be careful count.
inline constexpr double kLikelierThanNot = 0.5;

/// What was read in a part that the grammar refused.
struct PartReading {
  std::vector<std::string> asked;  ///< readings, each one or several sentences, best first
  double probability = 0.0;        ///< of the best reading to ask for
  std::string example;             ///< of the names in it: the likeliest, or how it is said
};

/// Where a part stands.
struct PartOf {
  const Reading& reading;  ///< of the whole text
  bool is_whole = false;   ///< the part is all of the text
  /// Something is denied or past, or the refusal has a reason: only what is likelier than not is
  /// asked.
  bool is_turned = false;
  bool is_question = false;  ///< it ends with a question mark: it states nothing
  bool is_doubted = false;   ///< something in the text is doubted or left open: nothing is asked
  bool is_denied = false;    ///< it has a word of denial: "don't go", "nowhere near"
};

PartReading readPart(const Utterance& part, const PartOf& of, const Grammar& grammar);

}  // namespace hyselam_topo
