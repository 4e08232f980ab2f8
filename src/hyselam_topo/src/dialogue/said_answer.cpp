#include "said_answer.hpp"

#include <algorithm>

namespace hyselam_topo {
namespace {

/// The names that an utterance gives to the place that the question is about.
std::vector<SaidName> namesIn(const Utterance& u, const Question& question, Id here) {
  if (question.kind == Question::Kind::kSpeaker) {
    return u.intent == "speaker"       ? u.names("person")
           : u.intent == "name_answer" ? u.names("place")
                                       : std::vector<SaidName>{};
  }
  if (!question.isAboutName()) return {};
  const bool about_here = question.place == here || question.kind == Question::Kind::kName;
  const bool of_this = u.intent == "this_is" || u.intent == "robot_in";
  if (u.intent != "name_answer" && !(of_this && about_here)) return {};
  std::vector<SaidName> names;
  for (const char* slot : {"place", "aliases"}) {
    for (const SaidName& name : u.names(slot)) {
      if (name.reference.empty() && !name.text.empty()) names.push_back(name);
    }
  }
  return names;
}

/// "This is not the kitchen", of the names that are asked about.
bool deniesNames(const Utterance& u, const Question& question, const IsSameName& is_same_name) {
  if (u.intent != "denied_name" || !question.isAboutName()) return false;
  const std::vector<SaidName> denied = u.names("was");
  return !denied.empty() && std::all_of(denied.begin(), denied.end(), [&](const SaidName& name) {
    return std::any_of(question.names.begin(), question.names.end(),
                       [&](const std::string& asked) { return is_same_name(asked, name.text); });
  });
}

}  // namespace

bool isAnswer(const Utterance& u) {
  return (u.kind == UtteranceKind::kAnswer && u.intent != "this_is") || u.intent == "repeat";
}

SaidAnswer answerIn(const ParsedText& text, const Question& question, Id here,
                    const IsSameName& is_same_name) {
  SaidAnswer answer;
  const bool measured = question.kind == Question::Kind::kRadius || question.search != nullptr;
  for (const Utterance& u : text.utterances) {
    const auto names = u.understood() ? namesIn(u, question, here) : std::vector<SaidName>{};
    const auto length = u.number("length") ? u.number("length") : u.number("radius");
    if (u.intent == "yes") {
      answer.yes = true;
    } else if (u.intent == "no" || deniesNames(u, question, is_same_name)) {
      answer.no = true;
    } else if (u.intent == "unknown_answer") {
      answer.unknown = true;
    } else if (u.intent == "repeat") {
      answer.repeat = true;
    } else if (u.intent == "name_answer" && names.empty() && question.isAboutName()) {
      answer.yes = true;  // "That's it."
    } else if (!names.empty() && answer.names.empty()) {
      answer.names = names;
      answer.no = answer.no || (u.correction && !answer.yes);
    } else if (measured && isAnswer(u) && length) {
      answer.length = length;
    } else {
      break;
    }
    ++answer.used;
  }
  return answer;
}

}  // namespace hyselam_topo
