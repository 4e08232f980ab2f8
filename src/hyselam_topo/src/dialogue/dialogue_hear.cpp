// From a text to what it leads to: its utterances one by one, each by the handler of its intent.
#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "dialogue_turn.hpp"
#include "hyselam_common/edit_distance.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "said_answer.hpp"

namespace hyselam_topo {
namespace {

constexpr std::size_t kMinSlip = 4;  // shorter names may not be misspelt [letters]

/// "it's in the hall": no place is named that lies within another.
bool isOfReferences(const Utterance& u) {
  const std::vector<SaidName> names = u.names("places");
  return std::all_of(names.begin(), names.end(),
                     [](const SaidName& name) { return !name.reference.empty(); });
}

/// What may be meant by the parts is one question; of the other parts it is told that they are not
/// understood.
void proposeTogether(const std::vector<ForwardedSentence>& parts, ForwardedSentence* whole) {
  std::string together;
  const ForwardedSentence* only = nullptr;
  for (const ForwardedSentence& each : parts) {
    if (!each.suggests_meaning) {
      whole->rest += (whole->rest.empty() ? "" : " ") + each.refusal;
      continue;
    }
    if (!each.rest.empty()) whole->rest += (whole->rest.empty() ? "" : " ") + each.rest;
    only = together.empty() ? &each : nullptr;
    together += (together.empty() ? "" : " ") + each.suggestion;
  }
  if (together.empty()) {
    whole->rest.clear();
    return;
  }
  whole->suggests_meaning = true;
  whole->suggestion = together;
  if (only != nullptr) whole->alternatives = only->alternatives;
}

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
  proposeTogether(forwarded, &whole);
  forwarded = {whole};
}

/// "No, wait, it's on the windowsill": the one who waits is the speaker, who corrects what was
/// said.
void joinCorrections(const std::string& text, std::vector<Utterance>* all) {
  for (std::size_t i = 0; i + 1 < all->size(); ++i) {
    Utterance& no = (*all)[i];
    const Utterance& wait = (*all)[i + 1];
    if (no.intent != "no" || wait.intent != "stop" || wait.range.begin < no.range.end) continue;
    const std::string between =
        text.substr(no.range.end, std::min(wait.range.begin, text.size()) - no.range.end);
    const bool goes_on = !no.left_out.empty() || !wait.left_out.empty();
    if (!goes_on || between.find_first_of(".!?;\n") != std::string::npos) continue;
    no.left_out.insert(no.left_out.end(), wait.left_out.begin(), wait.left_out.end());
    no.range.end = wait.range.end;
    all->erase(all->begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
}

/// Whether one of the words of a key of the grammar stands in the text.
bool hasWordOf(const std::string& key, const std::string& text, const Grammar& grammar) {
  if (!grammar.has(key)) return false;
  std::string words = " ";
  for (const char c : hyselam::utf8Fold(text)) {
    const bool ends = std::string(" ,.;:!?").find(c) != std::string::npos;
    words += ends ? ' ' : c;
  }
  std::istringstream all(grammar.say(key));
  for (std::string word; all >> word;) {
    if ((words + " ").find(" " + word + " ") != std::string::npos) return true;
  }
  return false;
}

/// "See this room we're in?": of where the robot stands.
bool saysHere(const std::string& text, const Grammar& grammar) {
  return hasWordOf("says_here", text, grammar);
}

}  // namespace

Dialogue::Handler Dialogue::handlerOf(const Utterance& u) {
  static const std::map<std::string, Handler> handlers{
      {"this_is", &Dialogue::nameThisPlace},
      {"forget_name", &Dialogue::forgetNames},
      {"forget_everything", &Dialogue::askForgetEverything},
      {"speaker", &Dialogue::introduce},
      {"rename", &Dialogue::rename},
      {"glass_wall", &Dialogue::addWall},
      {"virtual_wall", &Dialogue::addWall},
      {"forget_wall", &Dialogue::forgetWall},
      {"virtual_place", &Dialogue::addVirtualPlace},
      {"go_to", &Dialogue::goTo},
      {"go_back", &Dialogue::goToPreviousPlace},
      {"carry_on", &Dialogue::carryOn},
      {"open_door", &Dialogue::openDoor},
      {"shut_door", &Dialogue::shutDoor},
      {"confirm_all", &Dialogue::confirmAll},
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
      {"ask_told", &Dialogue::answerTold},
      {"what_is_known", &Dialogue::answerWhatIsKnown},
      {"owner_of", &Dialogue::answerOwner},
      {"ask_owner", &Dialogue::answerOwner},
      {"person_place", &Dialogue::answerPersonPlace},
      {"is_located", &Dialogue::answerIsLocated},
      {"ask_relation", &Dialogue::answerIsLocated},
      {"is_joined", &Dialogue::answerIsJoined},
      {"is_larger", &Dialogue::answerIsLarger},
      {"what_is_located", &Dialogue::answerWhatIsLocated},
      {"is_known", &Dialogue::answerIsKnown},
      {"nearest", &Dialogue::answerNearest},
      {"how_many", &Dialogue::answerHowMany},
      {"ask_how_many", &Dialogue::answerHowMany},
      {"largest", &Dialogue::answerLargest},
      {"who_am_i", &Dialogue::answerWhoAmI},
      {"follow_corridor", &Dialogue::refuseCorridor},
      {"come_here", &Dialogue::refuseComing},
      {"carry", &Dialogue::refuseCarrying},
      {"help", &Dialogue::help},
      {"greeting", &Dialogue::greet},
      {"thanks", &Dialogue::acceptThanks}};
  const auto found = handlers.find(u.intent);
  return found == handlers.end() ? nullptr : found->second;
}

void Dialogue::say(const char* key, Turn& turn) {
  turn.reply.sentences.push_back(phrases().say(key));
}

bool Dialogue::isAboutObject(const Utterance& u) const {
  if (u.intent == "gone") return isOfReferences(u);  // "It's gone."
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

bool Dialogue::knowsLanguage(const std::string& language) const {
  const auto& grammars = parser_.grammars();
  return std::any_of(grammars.begin(), grammars.end(),
                     [&](const Grammar& each) { return each.language() == language; });
}

bool Dialogue::isOfThisPlace(const Utterance& u, const Turn& turn) const {
  if (u.intent != "alias" || turn.described || talk_.described_last || turn.lost) return false;
  const std::vector<SaidName> place = u.names("place");
  return place.size() == 1 && !place.front().reference.empty() && u.find("aliases") != nullptr;
}

bool Dialogue::pointsBack(const Utterance& u, const Turn& turn) const {
  if (u.intent != "this_is" || !(turn.told || turn.lost) || !grammar().has("points_back") ||
      u.slots.size() != 1 || u.slots.front().name != "place") {
    return false;
  }
  return hasWordOf("points_back", u.text.substr(0, u.text.find(' ')), grammar());
}

bool Dialogue::isOfNumberedPlace(const Utterance& u, Utterance* named) const {
  static const std::set<std::string> kKinds{"alias", "this_is"};
  const std::size_t more = u.find("was") != nullptr || !u.word("denied").empty() ? 1 : 0;
  if (kKinds.count(u.intent) == 0 || u.slots.size() != 2 + more) return false;
  const std::vector<SaidName> place = u.names("place"), aliases = u.names("aliases");
  if (place.size() != 1 || aliases.empty()) return false;
  const auto isNumber = [&](const SaidName& name) {
    return name.reference.empty() && isCode(name.text) && places_.find(name.text).size() == 1;
  };
  const bool first = isNumber(place.front());
  const bool second = aliases.size() == 1 && isNumber(aliases.front());
  if (first == second) return false;
  *named = u;
  named->slots = {*u.find(first ? "place" : "aliases"), *u.find(first ? "aliases" : "place")};
  named->slots.front().name = "place";
  named->slots.back().name = "aliases";
  return true;
}

bool Dialogue::isOnlyOnMap(const Utterance& u) const {
  static const std::map<std::string, const char*> kSlots{{"forget_place", "place"},
                                                         {"gone", "places"}};
  const auto slot = kSlots.find(u.intent);
  if (slot == kSlots.end() || u.slots.size() != 1) return false;
  const std::vector<std::string> names = textsOf(u.names(slot->second));
  return !names.empty() && std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return builder_.find(name).empty() && !places_.find(name).empty();
  });
}

ParsedText Dialogue::parsed(const std::string& text) const {
  ParseOptions options;
  const bool asks_for_name =
      question().isAboutName() || question().kind == Question::Kind::kSpeaker;
  if (asks_for_name) options.expected = {"name_answer", "denied_name"};
  if (isWondering()) options.expected = {"where_answer"};
  // "Go on." may be a "yes", too, where something is asked.
  const bool nothing_asked = question().kind == Question::Kind::kNone && !talk_.others_asked;
  if (nothing_asked && !haltedGoal().empty()) options.expected.insert("carry_on");
  options.preferred = language_;
  ParsedText parsed = parser_.parse(text, options);
  const auto& all = parsed.utterances;
  if (isWondering() && std::any_of(all.begin(), all.end(), [&](const Utterance& u) {
        return u.intent == "where_answer" && !placeIn(u);
      })) {  // "The kitchen."
    options.expected.clear();
    parsed = parser_.parse(text, options);
  }
  // A word or two that nobody understands is of no other language than the talk.
  const bool nothing = parsed.misunderstood() == parsed.utterances.size();
  const bool short_text = std::count(text.begin(), text.end(), ' ') < 2;
  if (nothing && short_text && parsed.language != language_ && knowsLanguage(language_)) {
    options.language = language_;
    parsed = parser_.parse(text, options);
  }
  return parsed;
}

ParsedText Dialogue::parse(const std::string& text) {
  ParsedText parsed = this->parsed(text);
  // Answered in the language of the sentence, understood or not: its reason is in that, too.
  if (phrases_.count(parsed.language) != 0) language_ = parsed.language;
  builder_.setLanguage(parsed.language);
  return parsed;
}

std::vector<std::string> Dialogue::notUnderstood(const std::string& text) const {
  std::vector<std::string> parts;
  for (const Utterance& u : parsed(text).utterances) {
    if (!u.understood()) parts.push_back(u.text);
  }
  return parts;
}

Reply Dialogue::hear(const std::string& text, const HearOptions& options) {
  talk_.questions.beginUtterance();
  talk_.wonders_anew = false;
  talk_.others_asked = options.others_asked_last;
  dropStaleQuestion();
  const UrgentWords urgent = findUrgentWords(text, parser_.grammars());
  Reply out = urgent.urgency == Urgency::kNone ? understand(text, options) : obey(urgent);
  if (!out.sentences.empty()) talk_.last_said = out.sentences;
  return out;
}

Reply Dialogue::understand(const std::string& text, const HearOptions& options) {
  const std::string language_before = language_;
  ParsedText parsed = parse(text);
  if (!talk_.under_way) joinCorrections(text, &parsed.utterances);
  Turn turn;
  turn.reply = reply();
  turn.reply.utterances = parsed.utterances;
  turn.text = text;
  turn.options = options;
  turn.says_more = std::any_of(parsed.utterances.begin(), parsed.utterances.end(),
                               [](const Utterance& u) { return u.understood() && !isAnswer(u); });
  if (refuseOtherLanguage(parsed, language_before, turn)) return turn.reply;
  if (!options.others_asked_last) attempt(turn.reply, [&] { takeAnswer(parsed, turn); });
  for (std::size_t i = turn.used; i < parsed.utterances.size() && !turn.broken_off; ++i) {
    const Utterance& u = parsed.utterances[i];
    const bool last = i + 1 == parsed.utterances.size();
    turn.until = last ? text.size() : std::min(text.size(), parsed.utterances[i + 1].range.begin);
    handleUtterance(u, turn);
    turn.end = std::min(text.size(), u.range.end);
  }
  joinForwarded(text, parsed.utterances.size(), turn.reply.forwarded);
  finish(turn);
  turn.reply.ends_other_question =
      options.others_asked_last && turn.about_else && turn.reply.forwarded.empty();
  return turn.reply;
}

void Dialogue::finish(Turn& turn) {
  attempt(turn.reply, [&] { recordStatements(turn); });
  startGoal(turn);
  tellLeftOut(turn);
  auto& sentences = turn.reply.sentences;
  // Questions come last, where they are answered.
  const bool asks = talk_.questions.isOpen() && talk_.questions.isNew() && !sentences.empty();
  sentences.insert(asks ? sentences.end() - 1 : sentences.end(), turn.not_understood.begin(),
                   turn.not_understood.end());
  propose(turn);
  settleQuestion(turn);
  talk_.described_last = turn.told;
  if (turn.about_else && !talk_.wonders_anew) talk_.wondered.clear();
  if (!turn.again.empty()) turn.reply.append(understand(turn.again, {}));
}

void Dialogue::handleUtterance(const Utterance& u, Turn& turn) {
  const HearOptions& options = turn.options;
  // "That was wrong. Forget what I just said": in other words, but meant once.
  const std::string took_back =
      std::exchange(turn.took_back, u.intent == "undo" ? hyselam::utf8Fold(u.text) : "");
  if (u.intent == "undo" && !took_back.empty() && took_back != turn.took_back) {
    turn.left_out.insert(turn.left_out.end(), u.left_out.begin(), u.left_out.end());
    return;
  }
  if (!u.understood()) {
    if (forgetsKnown(u, turn)) return;
    builder_.sentenceRefused();
    refuse(u, turn);
    turn.lost = turn.lost || !saysHere(u.text, grammar());
    return;
  }
  // "Somebody moved the trolley, it's in the hall now": of what others were told right before.
  const bool goes_on = turn.forwarded_last && u.intent == "contains" && isOfReferences(u);
  const bool behind_forwarded = std::exchange(turn.forwarded_last, false);
  const bool for_others = (options.others_asked_last && u.kind == UtteranceKind::kAnswer) ||
                          (options.objects_spoken_of && isAboutObject(u)) || goes_on;
  if (options.forward_unknown && for_others) {
    // One answer answers one question.
    if (isAnswer(u) && turn.answered) return;
    turn.answered = turn.answered || isAnswer(u);
    forward(u, "", turn);
    return;
  }
  if (isAnswer(u)) {
    if (!correctsObject(u, behind_forwarded, turn) && !turn.says_more) meetAnswer(u, turn);
    return;
  }
  if (u.intent == "undo" && !turn.described && takeBack(turn)) {
    turn.about_else = true;
    return;
  }
  static const std::set<std::string> kNeutral{"greeting", "thanks", "help"};
  if (kNeutral.count(u.intent) == 0) turn.about_else = true;
  turn.left_out.insert(turn.left_out.end(), u.left_out.begin(), u.left_out.end());
  static const std::set<std::string> kOwn{"this_is", "forget_everything", "speaker"};
  Utterance numbered;
  if (pointsBack(u, turn)) {
    // "... há uma portinha, isso é a despensa": the place that was spoken of, not where it stands.
    Utterance named = u;
    named.intent = "alias";
    Slot& place = named.slots.front();
    place.name = "aliases";
    Slot spoken_of = place;
    spoken_of.name = "place";
    spoken_of.names.resize(1);
    spoken_of.names.front().text = u.text.substr(0, u.text.find(' '));
    spoken_of.names.front().reference = "it";
    named.slots.insert(named.slots.begin(), spoken_of);
    addStatement(named, turn);
  } else if (isOfNumberedPlace(u, &numbered)) {
    attempt(turn.reply, [&] {
      recordStatements(turn);
      const Id place = places_.find(numbered.slots.front().names.front().text).front();
      if (u.word("denied").empty() && u.find("was") == nullptr) {
        namePlace(place, numbered, turn);
      } else {
        correctName(place, u, turn);
      }
    });
  } else if (isOnlyOnMap(u)) {
    attempt(turn.reply, [&] {
      recordStatements(turn);
      Utterance forget = u;
      forget.slots.front().name = "place";
      forgetNames(forget, turn);
    });
  } else if (isOfThisPlace(u, turn)) {
    attempt(turn.reply, [&] { recordStatements(turn); });
    Utterance named = u;
    named.intent = "this_is";
    named.slots = {*u.find("aliases")};
    named.slots.front().name = "place";
    handleCommand(named, turn);
  } else if (!u.to_confirm.empty() && DescriptionBuilder::handles(u.intent)) {
    builder_.sentenceRefused();
    turn.lost = true;
    turn.to_confirm += (turn.to_confirm.empty() ? "" : " ") + u.to_confirm;
  } else if (kOwn.count(u.intent) == 0 && DescriptionBuilder::handles(u.intent)) {
    addStatement(u, turn);
  } else {
    attempt(turn.reply, [&] { recordStatements(turn); });
    if (u.intent != "go_to") startGoal(turn);
    handleCommand(u, turn);
  }
}

/// "No, on the hook.", of the coat that was spoken of.
bool Dialogue::correctsObject(const Utterance& u, bool behind_forwarded, Turn& turn) {
  const HearOptions& options = turn.options;
  if (u.left_out.empty() || turn.answered || !options.forward_unknown) return false;
  // The sentence before may have its mark with it.
  const std::size_t mark = std::min(turn.end - std::min<std::size_t>(turn.end, 1), u.range.begin);
  const bool new_sentence =
      turn.text.substr(mark, u.range.begin - mark).find_first_of(".!?;\n") != std::string::npos;
  const bool of_object = (behind_forwarded && u.intent == "no" && new_sentence) ||
                         (options.objects_spoken_of && !turn.says_more);
  if (!of_object) return false;
  ForwardedSentence whole;
  const std::size_t from = std::min(turn.end == 0 ? 0 : u.range.begin, turn.until);
  whole.text = turn.text.substr(from, turn.until - from);
  turn.reply.forwarded.push_back(std::move(whole));
  turn.answered = turn.forwarded_last = true;
  return true;
}

bool Dialogue::forgetsKnown(const Utterance& u, Turn& turn) {
  if (u.culprit.end <= u.culprit.begin || u.culprit.end > turn.text.size()) return false;
  const std::string word = turn.text.substr(u.culprit.begin, u.culprit.end - u.culprit.begin);
  const std::string folded = hyselam::utf8Fold(word);
  std::set<std::string> same, near;
  for (const std::string& name : knownNames()) {
    if (places_.sameName(name, word)) same.insert(name);
    // Where others listen it may be a thing: "forget ball" is not of the hall.
    if (!turn.options.forward_unknown && folded.size() >= kMinSlip &&
        hyselam::isOneEditApart(folded, hyselam::utf8Fold(name))) {
      near.insert(name);
    }
  }
  const std::set<std::string>& meant = same.empty() ? near : same;
  if (meant.size() != 1) return false;
  ParseOptions options;
  options.language = knowsLanguage(language_) ? language_ : "";
  const std::string quoted = turn.text.substr(u.range.begin, u.culprit.begin - u.range.begin) +
                             "\"" + *meant.begin() + "\"";
  const ParsedText again = parser_.parse(quoted, options);
  if (u.culprit.end < u.range.end || again.utterances.size() != 1) return false;
  Utterance forget = again.utterances.front();
  if (forget.intent != "forget_place" && forget.intent != "forget_name") return false;
  if (same.empty()) {
    turn.proposals = {forget.text};
    turn.refusal_of_proposal = phrases().say("not_taken_down_say", {{"suggestion", forget.text}});
    turn.about_else = true;
    return true;
  }
  forget.text = u.text;
  forget.range = u.range;
  handleUtterance(forget, turn);
  return true;
}

bool Dialogue::askWhose(const Utterance& u, Turn& turn) {
  if (u.intent == "this_is") return false;  // "my classroom": there is one here
  for (const Slot& slot : u.slots) {
    for (const SaidName& name : slot.names) {
      if (!name.speaker || name.elliptic || !builder_.speaker().empty()) continue;
      if (!places_.find(name.text).empty()) continue;
      Question question;
      question.kind = Question::Kind::kSpeaker;
      question.sentence = u.text;
      ask(std::move(question), phrases().say("speaker_unknown"), turn.reply);
      return true;
    }
  }
  return false;
}

Utterance Dialogue::withSpeaker(Utterance u) const {
  if (builder_.speaker().empty() || u.intent == "this_is") return u;
  for (Slot& slot : u.slots) {
    for (SaidName& name : slot.names) {
      // "My mum's café" is hers.
      if (!name.speaker || name.elliptic || name.text.find('\'') != std::string::npos) continue;
      name.text = builder_.ofSpeaker(name.text);
      name.speaker = false;
    }
  }
  return u;
}

void Dialogue::handleCommand(const Utterance& heard, Turn& turn) {
  if (askWhose(heard, turn)) return;
  const Utterance u = withSpeaker(heard);
  Reply& out = turn.reply;
  const std::size_t said = out.sentences.size(), done = out.actions.size(),
                    goals = turn.goals.size();
  out.unknown_name = false;
  const Handler handler = handlerOf(u);
  attempt(out, [&] {
    if (handler != nullptr) {
      (this->*handler)(u, turn);
    } else {
      say("cannot_do", turn);
    }
  });
  const bool nothing_done = out.actions.size() == done && turn.goals.size() == goals;
  // All that was said is that nobody knows the name, or can do it: another node may ("fetch the
  // pen").
  if (turn.options.forward_unknown && (out.unknown_name || handler == nullptr) && nothing_done &&
      out.sentences.size() == said + 1) {
    forward(u, out.sentences.back(), turn);
    turn.reply.forwarded.back().reason = out.sentences.back();
    turn.reply.forwarded.back().understood = true;
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
  turn.forwarded_last = true;
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
