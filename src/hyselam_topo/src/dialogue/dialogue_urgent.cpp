// Stop and cancel: obeyed before anything is understood.
#include <algorithm>
#include <set>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "said_answer.hpp"

namespace hyselam_topo {
namespace {

bool isMotion(const Utterance& u) {
  static const std::set<std::string> kMotion{"go_to", "go_back", "follow_me", "turn"};
  return kMotion.count(u.intent) != 0;
}

}  // namespace

Reply Dialogue::obey(const UrgentWords& urgent) {
  const auto& languages = urgent.languages;
  const bool spoken = std::find(languages.begin(), languages.end(), language_) != languages.end();
  if (!spoken && !languages.empty() && phrases_.count(languages.front()) != 0) {
    language_ = languages.front();
  }
  talk_.questions.drop();
  Turn turn;
  turn.reply = reply();
  halt(turn.reply);
  turn.reply.stopped = true;
  turn.reply.ends_other_question = true;
  const bool stop = urgent.urgency == Urgency::kStop;
  if (!stop) talk_.halted = false;  // nothing to go on with
  turn.reply.sentences.push_back(phrases().say(stop ? "stopped" : "cancelled"));
  for (const UrgentRest& rest : urgent.rest) {
    // Behind what waits for an answer, in words that would not be heard again.
    turn.broken_off ? refuseRest(rest, turn) : heedRest(rest, turn);
  }
  finish(turn);
  return turn.reply;
}

std::optional<Reply> Dialogue::obeyUrgent(const std::string& text) {
  UrgentWords urgent = findUrgentWords(text, parser_.grammars());
  if (urgent.urgency == Urgency::kNone) return std::nullopt;
  urgent.rest.clear();
  return obey(urgent);
}

void Dialogue::heedRest(const UrgentRest& rest, Turn& turn) {
  const ParsedText parsed = parse(rest.text);
  const auto& said = parsed.utterances;
  turn.reply.utterances.insert(turn.reply.utterances.end(), said.begin(), said.end());
  const bool all = std::all_of(said.begin(), said.end(), [&](const Utterance& u) {
    return u.understood() && (rest.after || !isMotion(u));
  });
  if (!all) {
    refuseRest(rest, turn);
    return;
  }
  turn.text = rest.text;
  turn.end = 0;
  for (const Utterance& u : said) {
    if (turn.broken_off) return;
    // What was asked before is over, and so are its answers.
    if (!isAnswer(u)) handleUtterance(u, turn);
    turn.end = std::min(turn.text.size(), u.range.end);
  }
}

void Dialogue::refuseRest(const UrgentRest& rest, Turn& turn) {
  const std::string reason = phrases().say("not_taken", {{"text", rest.text}});
  turn.reply.refusals.push_back({rest.text, reason, false, ""});
  turn.not_understood.push_back(reason);
}

}  // namespace hyselam_topo
