// What an utterance says to the robot's question, taken together: "No, no, it is the kitchen."
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_topo/dialogue/question_keeper.hpp"

namespace hyselam_topo {

struct SaidAnswer {
  bool yes = false;
  bool no = false;
  bool unknown = false;  ///< "I do not know."
  bool repeat = false;   ///< "Pardon?"
  std::vector<SaidName> names;
  std::optional<double> length;  ///< [m]
  std::size_t used = 0;          ///< the number of utterances that it takes, from the first one

  bool any() const { return used > 0; }
};

/// Whether two names are one, however they are written.
using IsSameName = std::function<bool(const std::string&, const std::string&)>;

/// The answer at the begin of a text to this question. `here`: the robot's place; what "this" is
/// called answers questions about that place.
SaidAnswer answerIn(const ParsedText& text, const Question& question, Id here,
                    const IsSameName& is_same_name);

/// Yes, no, a name on its own, a length, "what?": utterances that say nothing without a question.
bool isAnswer(const Utterance& u);

}  // namespace hyselam_topo
