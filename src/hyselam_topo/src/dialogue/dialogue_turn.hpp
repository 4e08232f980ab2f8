// What one text that was heard leads to, while it is worked on.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {

struct Dialogue::Turn {
  std::string text;
  HearOptions options;
  std::size_t end = 0;  ///< of the utterance before, in the text
  Reply reply;
  std::vector<std::string> not_understood;  ///< answers to what was not understood
  bool described = false;                   ///< statements about the building were recorded
  bool beyond_here = false;                 ///< ... about more than where the robot is
  bool sides = false;                       ///< ... with sides
  std::vector<std::string> here;            ///< ... where the robot is; empty: not described
  std::vector<DescriptionIssue> issues;
  std::vector<std::pair<std::string, std::vector<Id>>> goals;  ///< where to go, in order
};

/// The texts of names that are no references.
inline std::vector<std::string> textsOf(const std::vector<SaidName>& names) {
  std::vector<std::string> texts;
  for (const SaidName& name : names) {
    if (name.reference.empty() && !name.text.empty()) texts.push_back(name.text);
  }
  return texts;
}

}  // namespace hyselam_topo
