// What was not understood: why, and what may have been meant.
#include <algorithm>
#include <set>

#include "dialogue_turn.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_language/grammar/near_example.hpp"
#include "hyselam_language/grammar/words_left_out.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "other_languages.hpp"

namespace hyselam_topo {
namespace {

std::vector<std::string> proposalsOf(const std::string& first,
                                     const std::vector<std::string>& others) {
  std::vector<std::string> all{first};
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

}  // namespace

bool Dialogue::refuseOtherLanguage(const ParsedText& parsed, const std::string& language_before,
                                   Turn& turn) {
  if (parsed.utterances.empty() || parsed.misunderstood() < parsed.utterances.size()) return false;
  std::set<std::string> spoken;
  for (const Grammar& each : parser_.grammars()) spoken.insert(each.language());
  if (OtherLanguages::shipped().find(turn.text, spoken).empty()) return false;
  builder_.sentenceRefused();
  // The parser's guess among its own is none.
  language_ = turn.reply.language = language_before;
  const std::string refusal = phrases().say("only_languages");
  turn.reply.refusals.push_back({turn.text, refusal, false, ""});
  turn.not_understood.push_back(refusal);
  turn.reply.sentences.push_back(refusal);
  settleQuestion(turn);
  return true;
}

void Dialogue::tellLeftOut(Turn& turn) {
  const std::string all = quotedInARow(turn.left_out);
  if (!all.empty()) turn.not_understood.push_back(phrases().say("left_out", {{"text", all}}));
}

void Dialogue::refuse(const Utterance& u, Turn& turn) {
  const Phrases& p = phrases();
  std::vector<std::string> meant;
  if (u.suggests_meaning && !u.suggestion.empty()) {
    meant = acceptableOf(proposalsOf(u.suggestion, u.alternatives));
  }
  const bool proposes = !meant.empty();
  // What may have been meant, but cannot be taken, is no advice, nor what has nothing to do with
  // it.
  const bool asks =
      !u.text.empty() && u.text.back() == '?';  // another question tells nothing wrong
  const bool is_near = !u.suggests_meaning && (asks || u.suggests_own_words ||
                                               isNearExample(u.text, u.suggestion, grammar()));
  const std::string advice = proposes               ? meant.front()
                             : !is_near             ? ""
                             : u.suggests_own_words ? u.suggestion
                                                    : withKnownNames(u.suggestion, u.text);
  const std::string refusal = sayNotUnderstood(u.text, u.reason, advice);
  std::string rest;  // what the proposal does without
  if (proposes) {
    rest = quotedInARow(wordsLeftOut(u.text, meant.front(), grammar()));
    if (!rest.empty()) rest = p.say("not_understood_part", {{"text", rest}});
  }
  if (turn.options.forward_unknown) {
    forward(u, refusal, turn);
    ForwardedSentence& forwarded = turn.reply.forwarded.back();
    forwarded.reason = u.reason;
    forwarded.suggestion = advice;
    forwarded.suggests_meaning = proposes;
    if (proposes) forwarded.alternatives.assign(meant.begin() + 1, meant.end());
    forwarded.rest = rest;
    return;
  }
  turn.reply.refusals.push_back({u.text, u.reason, false, advice});
  if (proposes && turn.proposals.empty()) {
    turn.proposals = meant;
    turn.refusal_of_proposal = refusal;
    if (!rest.empty()) turn.not_understood.push_back(rest);
  } else {
    turn.not_understood.push_back(refusal);
  }
}

void Dialogue::propose(Turn& turn) {
  if (!turn.to_confirm.empty()) {
    // What was understood first; what else may have been meant belongs to it.
    const bool both = !turn.proposals.empty();
    turn.proposals = {turn.to_confirm + (both ? " " + turn.proposals.front() : "")};
    if (both) turn.proposals.push_back(turn.to_confirm);
    turn.refusal_of_proposal =
        phrases().say("not_taken_down_say", {{"suggestion", turn.proposals.front()}});
  }
  if (!turn.to_confirm.empty()) {
    turn.proposals = acceptableOf(turn.proposals);
    if (turn.proposals.empty()) {
      turn.reply.sentences.push_back(phrases().say("not_taken_down"));
      turn.reply.refusals.push_back({turn.to_confirm, phrases().say("not_taken_down"), false, ""});
    }
  }
  if (turn.proposals.empty()) return;
  auto& sentences = turn.reply.sentences;
  if (talk_.questions.isOpen() && talk_.questions.isNew()) {  // one question at a time
    sentences.insert(sentences.end() - 1, turn.refusal_of_proposal);
    return;
  }
  askProposal(turn.proposals, turn.reply);
}

Reply Dialogue::refuse(const ForwardedSentence& sentence) {
  Reply out = reply();
  std::vector<std::string> meant;
  if (sentence.suggests_meaning && !(talk_.questions.isOpen() && talk_.questions.isNew())) {
    meant = acceptableOf(proposalsOf(sentence.suggestion, sentence.alternatives));
  }
  if (!meant.empty()) {
    if (!sentence.rest.empty()) out.sentences.push_back(sentence.rest);
    askProposal(meant, out);
  } else {
    out.sentences.push_back(sentence.refusal);
  }
  out.refusals.push_back({sentence.text, sentence.reason, false, sentence.suggestion});
  talk_.last_said = out.sentences;
  return out;
}

std::string Dialogue::withKnownNames(const std::string& advice,
                                     const std::string& said_text) const {
  // Those that the person has just said, first.
  std::vector<std::string> known;
  for (const Place& place : places_.map().places) {
    if (nameStateOf(place) == NameState::kConfirmed) known.push_back(namesOf(place).front());
  }
  const std::string text = hyselam::utf8Fold(said_text);
  std::stable_partition(known.begin(), known.end(), [&](const std::string& name) {
    return text.find(hyselam::utf8Fold(name)) != std::string::npos;
  });
  ParseOptions options;
  options.language = grammar().language();
  const ParsedText before = parser_.parse(advice, options);
  if (before.utterances.size() != 1 || !before.utterances.front().understood()) return advice;
  std::vector<SaidName> names;
  for (const Slot& slot : before.utterances.front().slots) {
    for (const SaidName& name : slot.names) {
      if (name.reference.empty() && confirmedPlaces(name.text).empty()) names.push_back(name);
    }
  }
  // Words that grow together with an article go with another one of the same gender.
  const auto articleOf = [&](const std::string& name) {
    const std::string with = said(name);
    return with.substr(0, with.size() - name.size());
  };
  std::string better = advice;
  for (const SaidName& name : names) {
    const auto fits = std::find_if(known.begin(), known.end(), [&](const std::string& each) {
      return articleOf(each) == articleOf(name.text) && advice.find(each) == std::string::npos;
    });
    if (fits == known.end() || articleOf(name.text).empty()) return advice;
    const std::size_t at = better.find(name.text);
    if (at == std::string::npos) return advice;
    better.replace(at, name.text.size(), *fits);
    known.erase(fits);
  }
  const ParsedText after = parser_.parse(better, options);
  const bool same = after.utterances.size() == 1 && after.utterances.front().understood() &&
                    after.utterances.front().intent == before.utterances.front().intent;
  return same ? better : advice;
}

std::string Dialogue::sayNotUnderstood(const std::string& text, const std::string& reason,
                                       const std::string& advice) const {
  const Phrases& p = phrases();
  if (advice.empty()) return p.say("not_understood", {{"text", text}, {"reason", reason}});
  // The reason's own advice, behind its cause, would be a second one.
  return p.say(
      "not_understood_say",
      {{"text", text}, {"reason", reason.substr(0, reason.find("; "))}, {"suggestion", advice}});
}

std::vector<std::string> Dialogue::acceptableOf(std::vector<std::string> proposals) const {
  if (talk_.is_trial) return proposals;
  proposals.erase(std::remove_if(proposals.begin(), proposals.end(),
                                 [&](const std::string& each) { return !isAcceptable(each); }),
                  proposals.end());
  return proposals;
}

bool Dialogue::isAcceptable(const std::string& sentence) const {
  Dialogue trial(*this);
  trial.talk_.is_trial = true;
  trial.talk_.questions.drop();
  const Reply reply = trial.hear(sentence);
  const bool whole =
      std::all_of(reply.utterances.begin(), reply.utterances.end(), [](const Utterance& u) {
        return u.understood() && u.left_out.empty() && u.to_confirm.empty();
      });
  // What only the person can tell is asked then: may a place be called so? Who is speaking?
  const Question::Kind asked = trial.question().kind;
  const bool asks = asked == Question::Kind::kNewName || asked == Question::Kind::kSpeaker;
  return whole && (reply.refusals.empty() || asks) && asked != Question::Kind::kProposal;
}

}  // namespace hyselam_topo
