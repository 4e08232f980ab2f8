// From a text to what it leads to: its utterances one by one, each by the handler of its intent.
#include <algorithm>
#include <map>

#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {
namespace {

/// If no utterance of a text was understood, the text is forwarded as a whole, as it was said.
void joinForwarded(const std::string& text, std::size_t utterances,
                   std::vector<ForwardedSentence>& forwarded) {
  const bool all_refused =
      utterances > 1 && forwarded.size() == utterances &&
      std::none_of(forwarded.begin(), forwarded.end(),
                   [](const ForwardedSentence& each) { return each.refusal.empty(); });
  if (!all_refused) return;
  ForwardedSentence whole;
  whole.text = text;
  whole.about_object = true;
  for (const ForwardedSentence& each : forwarded) {
    whole.refusal += (whole.refusal.empty() ? "" : " ") + each.refusal;
    whole.reason += (whole.reason.empty() ? "" : "; ") + each.reason;
    whole.about_object = whole.about_object && each.about_object;
    if (whole.suggestion.empty()) whole.suggestion = each.suggestion;
  }
  forwarded = {whole};
}

}  // namespace

Dialogue::Handler Dialogue::handlerOf(const Utterance& u) {
  static const std::map<std::string, Handler> handlers{
      {"this_is", &Dialogue::nameThisPlace},
      {"forget_name", &Dialogue::forgetNames},
      {"rename", &Dialogue::rename},
      {"glass_wall", &Dialogue::addWall},
      {"virtual_wall", &Dialogue::addWall},
      {"forget_wall", &Dialogue::forgetWall},
      {"virtual_place", &Dialogue::addVirtualPlace},
      {"go_to", &Dialogue::goTo},
      {"go_back", &Dialogue::goToPreviousPlace},
      {"follow_me", &Dialogue::followPerson},
      {"stop", &Dialogue::stop},
      {"turn", &Dialogue::turnRobot},
      {"cancel", &Dialogue::cancel},
      {"where_are_you", &Dialogue::answerWhereAreYou},
      {"where_is", &Dialogue::answerWhereIs},
      {"is_here", &Dialogue::answerWhereIs},
      {"way_to", &Dialogue::answerRouteTo},
      {"what_is_next_to", &Dialogue::answerNextTo},
      {"what_is_opposite", &Dialogue::answerOpposite},
      {"what_is_on_side", &Dialogue::answerOnSide},
      {"what_is_size", &Dialogue::answerSize},
      {"which_places", &Dialogue::answerWhichPlaces},
      {"help", &Dialogue::help},
      {"greeting", &Dialogue::greet},
      {"thanks", &Dialogue::acceptThanks}};
  if (u.kind == UtteranceKind::kAnswer && u.intent != "this_is") return &Dialogue::answer;
  const auto found = handlers.find(u.intent);
  return found == handlers.end() ? nullptr : found->second;
}

template <typename Act>
void Dialogue::attempt(Reply& out, Act&& act) {
  try {
    act();
  } catch (const hyselam::InputError& e) {
    out.sentences.push_back(phrases().say("not_possible", {{"reason", e.what()}}));
  }
}

void Dialogue::say(const char* key, Turn& turn) {
  turn.reply.sentences.push_back(phrases().say(key));
}

bool Dialogue::isAboutObject(const Utterance& u) const {
  if (u.intent != "contains") return false;
  const std::vector<std::string> known = knownNames();
  const std::vector<SaidName> names = u.names("places");
  return std::all_of(names.begin(), names.end(), [&](const SaidName& name) {
    if (!name.reference.empty()) return true;
    return places_.find(name.text).empty() &&
           std::none_of(known.begin(), known.end(),
                        [&](const std::string& each) { return places_.sameName(each, name.text); });
  });
}

ParsedText Dialogue::parse(const std::string& text) {
  ParseOptions options;
  if (question_.kind == Question::Kind::kName || question_.kind == Question::Kind::kConfirmName)
    options.expected = {"name_answer"};
  options.preferred = language_;
  ParsedText parsed = parser_.parse(text, options);
  // Answered in the language of the sentence, understood or not: its reason is in that, too.
  if (phrases_.count(parsed.language) != 0) language_ = parsed.language;
  return parsed;
}

Reply Dialogue::hear(const std::string& text, const HearOptions& options) {
  const ParsedText parsed = parse(text);
  Turn turn;
  turn.reply = reply();
  turn.reply.utterances = parsed.utterances;
  turn.text = text;
  turn.options = options;
  for (const Utterance& u : parsed.utterances) {
    handleUtterance(u, turn);
    turn.end = std::min(text.size(), u.range.end);
  }
  joinForwarded(text, parsed.utterances.size(), turn.reply.forwarded);
  attempt(turn.reply, [&] { recordStatements(turn); });
  startGoal(turn);
  auto& sentences = turn.reply.sentences;
  // Questions come last, where they are answered.
  const bool asks = question_.kind != Question::Kind::kNone && !sentences.empty();
  sentences.insert(asks ? sentences.end() - 1 : sentences.end(), turn.not_understood.begin(),
                   turn.not_understood.end());
  return turn.reply;
}

void Dialogue::handleUtterance(const Utterance& u, Turn& turn) {
  const HearOptions& options = turn.options;
  if (!u.understood()) {
    const std::string refusal =
        phrases().say("not_understood", {{"text", u.text}, {"reason", u.reason}});
    if (options.forward_unknown) {
      forward(u, refusal, turn);
      turn.reply.forwarded.back().reason = u.reason;
      turn.reply.forwarded.back().suggestion = u.suggestion;
    } else {
      turn.not_understood.push_back(refusal);
      turn.reply.refusals.push_back({u.text, u.reason, false, u.suggestion});
    }
    return;
  }
  const bool for_others = (options.others_asked_last && u.kind == UtteranceKind::kAnswer) ||
                          (options.objects_spoken_of && isAboutObject(u));
  if (options.forward_unknown && for_others) {
    forward(u, "", turn);
  } else if (u.intent != "this_is" && DescriptionBuilder::handles(u.intent)) {
    addStatement(u, turn);
  } else {
    attempt(turn.reply, [&] { recordStatements(turn); });
    if (u.intent != "go_to") startGoal(turn);
    handleCommand(u, turn);
  }
}

void Dialogue::handleCommand(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const std::size_t said = out.sentences.size(), done = out.actions.size(),
                    goals = turn.goals.size();
  out.unknown_name = false;
  attempt(out, [&] {
    if (const Handler handler = handlerOf(u)) {
      (this->*handler)(u, turn);
    } else {
      say("cannot_do", turn);
    }
  });
  const bool nothing_done = out.actions.size() == done && turn.goals.size() == goals;
  // All that was said is that nobody knows the name: another node may.
  if (turn.options.forward_unknown && out.unknown_name && nothing_done &&
      out.sentences.size() == said + 1) {
    forward(u, out.sentences.back(), turn);
    turn.reply.forwarded.back().reason = out.sentences.back();
    out.sentences.pop_back();
  }
}

void Dialogue::forward(const Utterance& u, const std::string& refusal, Turn& turn) {
  // A correction with what stands before it: "No, the pen ...".
  const std::size_t begin = std::min(turn.end, u.range.begin);
  const std::string whole = turn.text.substr(begin, std::max(u.range.end, begin) - begin);
  ForwardedSentence sentence;
  sentence.text = u.correction ? whole : u.text;
  sentence.refusal = refusal;
  sentence.about_object = u.reason_code == "object";
  turn.reply.forwarded.push_back(std::move(sentence));
}

// ---- Small talk ----

void Dialogue::help(const Utterance&, Turn& turn) {
  say("help", turn);
}

void Dialogue::greet(const Utterance&, Turn& turn) {
  say("hello", turn);
}

void Dialogue::acceptThanks(const Utterance&, Turn& turn) {
  say("welcome", turn);
}

}  // namespace hyselam_topo
