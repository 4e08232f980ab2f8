// What one text that was heard leads to, while it is worked on.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {

struct Dialogue::Turn {
  std::string text;
  HearOptions options;
  std::size_t end = 0;    ///< of the utterance before, in the text
  std::size_t until = 0;  ///< where the next one begins
  Reply reply;
  std::string again;        ///< a sentence of before that is heard now
  bool broken_off = false;  ///< what follows waits for the answer to a question

  // Statements that are not recorded yet (recordStatements())
  bool described = false;         ///< there are some
  bool beyond_here = false;       ///< ... about more than where the robot is
  bool sides = false;             ///< ... with sides
  std::vector<std::string> here;  ///< ... where the robot is; empty: not described
  std::vector<DescriptionIssue> issues;
  std::optional<DescriptionIssue> to_ask;  ///< what the person can answer
  bool asks_speaker = false;               ///< ... by telling who speaks
  /// The description before them.
  std::optional<DescribedBuilding> before;
  KnownBefore known_before;  ///< with `before`

  std::vector<NamedGoal> goals;  ///< where to go, in order

  // Answers, and what the text was about
  std::size_t used = 0;         ///< utterances that the open question has taken as its answer
  bool answered = false;        ///< an answer was given, or met
  bool about_else = false;      ///< something was said that is no answer
  bool says_more = false;       ///< something was said that is understood and no answer
  bool told = false;            ///< of other places than the one where the robot is
  bool lost = false;            ///< something was said that was not understood
  bool forwarded_last = false;  ///< others hear the utterance before
  std::string took_back;        ///< the utterance before, where it was an "undo that"

  // What was not understood
  std::vector<std::string> not_understood;  ///< answers to it
  std::vector<std::string> left_out;        ///< words without matter beside statements
  std::vector<std::string> proposals;       ///< what may have been meant, best first, ...
  std::string to_confirm;                   ///< ... statements understood but for some words, ...
  std::string refusal_of_proposal;          ///< ... and what is said where it cannot be asked
};

/// What people say of names is one change, which "undo that" takes back as a whole.
class Dialogue::Change {
 public:
  explicit Change(Dialogue* dialogue);
  /// Of statements, from before the first of them on.
  Change(Dialogue* dialogue, KnownBefore before);
  ~Change();
  Change(const Change&) = delete;
  Change& operator=(const Change&) = delete;

 private:
  Dialogue* dialogue_ = nullptr;  ///< nullptr: part of another
  KnownBefore before_;
};

template <typename Act>
void Dialogue::attempt(Reply& out, Act&& act) {
  try {
    act();
  } catch (const hyselam::InputError& e) {
    out.sentences.push_back(phrases().say("not_possible", {{"reason", e.what()}}));
  }
}

/// As a sentence begins.
inline std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 32);
  return text;
}

/// The texts of names that are no references.
inline std::vector<std::string> textsOf(const std::vector<SaidName>& names) {
  std::vector<std::string> texts;
  for (const SaidName& name : names) {
    if (name.reference.empty() && !name.text.empty()) texts.push_back(name.text);
  }
  return texts;
}

}  // namespace hyselam_topo
