// "Undo that": how what is known becomes what it was before a change.
#include <algorithm>
#include <utility>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {
namespace {

bool has(const std::vector<Id>& all, Id id) {
  return std::find(all.begin(), all.end(), id) != all.end();
}

std::vector<Id> virtualPlacesOf(const AugmentedTopologicalMap& map) {
  std::vector<Id> all;
  for (const Place& place : map.places) {
    if (place.kind == PlaceKind::kVirtual) all.push_back(place.id);
  }
  return all;
}

}  // namespace

KnownBefore Dialogue::knownNow() const {
  KnownBefore now;
  now.names = places_.names();
  now.walls = places_.walls();
  now.virtual_places = virtualPlacesOf(places_.map());
  now.statements = now.after = builder_.statementCount();
  now.told_at = told_at_;
  return now;
}

bool Dialogue::isChanged(const KnownBefore& since) const {
  return !haveSameNames(since.names, places_.names()) || !(since.walls == places_.walls()) ||
         since.virtual_places != virtualPlacesOf(places_.map());
}

Dialogue::Change::Change(Dialogue* dialogue) {
  if (dialogue->talk_.changing) return;
  dialogue_ = dialogue;
  dialogue_->talk_.changing = true;
  before_ = dialogue_->knownNow();
  before_.told = dialogue_->builder_.memory();
}

Dialogue::Change::Change(Dialogue* dialogue, KnownBefore before) {
  if (dialogue->talk_.changing) return;
  dialogue_ = dialogue;
  dialogue_->talk_.changing = true;
  before_ = std::move(before);
}

Dialogue::Change::~Change() {
  if (dialogue_ == nullptr) return;
  dialogue_->talk_.changing = false;
  const DescriptionBuilder& builder = dialogue_->builder_;
  const bool told_more = before_.told ? !(before_.told->state.building == builder.building())
                                      : builder.statementCount() > before_.statements;
  if (told_more || dialogue_->isChanged(before_)) dialogue_->remember(std::move(before_));
}

void Dialogue::remember(KnownBefore before) {
  talk_.things_since = false;
  before.after = builder_.statementCount();
  talk_.changes.add(std::move(before));
}

std::string Dialogue::lastChange() const {
  if (!barrierToUndo().empty()) return "";
  const Utterance* said = builder_.lastStatement();
  const std::string statement = said != nullptr ? said->text : "";
  if (talk_.changes.isStatementLast(builder_.statementCount())) return statement;
  const KnownBefore* last = talk_.changes.last();
  std::vector<std::string> changed;
  const auto namesAt = [](const PlaceMan::Names& names, Id id) {
    const auto found = names.words.find(id);
    return found == names.words.end() ? std::vector<std::string>{} : confirmedOf(found->second);
  };
  const auto tellMissing = [&](const std::vector<std::string>& all,
                               const std::vector<std::string>& others) {
    for (const std::string& name : all) {
      if (std::find(others.begin(), others.end(), name) == others.end()) changed.push_back(name);
    }
  };
  const PlaceMan::Names now = places_.names();
  for (const Place& place : places_.map().places) {
    tellMissing(namesAt(now, place.id), namesAt(last->names, place.id));
  }
  if (changed.empty()) {  // some were taken away
    for (const Place& place : places_.map().places) {
      tellMissing(namesAt(last->names, place.id), namesAt(now, place.id));
    }
  }
  for (const Id id : virtualPlacesOf(places_.map())) {
    if (!has(last->virtual_places, id)) changed.push_back(codeOf(*places_.map().findPlace(id)));
  }
  const auto& walls = places_.walls();
  if (changed.empty() && !(walls == last->walls)) {
    const DescribedWall& wall =
        walls.size() > last->walls.size() ? walls.back() : last->walls.back();
    changed.push_back(phrases().wall(wall.kind));
  }
  return changed.empty() ? statement : phrases().list(changed);
}

std::string Dialogue::nextUndo() const {
  const Question::Kind asked = question().kind;
  const bool told_last = asked == Question::Kind::kAlsoName || asked == Question::Kind::kNewName;
  return talk_.things_since || told_last ? "" : lastChange();
}

std::string Dialogue::barrierToUndo() const {
  switch (talk_.changes.barrier(builder_.statementCount())) {
    case KnownBefore::Barrier::kPlaceGone:
      return "cannot_take_back_gone";
    case KnownBefore::Barrier::kTooLongAgo:
      return "cannot_take_back";
    case KnownBefore::Barrier::kNone:
      break;
  }
  return "";
}

void Dialogue::restoreKnown(const KnownBefore& before, Reply& out) {
  const Phrases& p = phrases();
  bool moved = false;
  std::vector<std::string> told;
  for (const Id id : virtualPlacesOf(places_.map())) {
    if (has(before.virtual_places, id)) continue;
    told.push_back(p.say("virtual_gone", {{"code", codeOf(*places_.map().findPlace(id))}}));
    places_.removeVirtualPlace(id);
    if (talk_.subject == id) talk_.subject = 0;
    moved = true;
  }
  if (moved) {
    topo_state_.mapChanged(places_.map());
    if (robot().has_pose) topo_state_.update(places_.map(), robot().stamp, robot().pose);
  }
  const auto isIn = [](const std::vector<DescribedWall>& all, const DescribedWall& wall) {
    return std::find(all.begin(), all.end(), wall) != all.end();
  };
  const std::size_t before_walls = told.size();
  for (std::size_t i = places_.walls().size(); i-- > 0;) {
    const DescribedWall wall = places_.walls()[i];
    if (isIn(before.walls, wall)) continue;
    places_.removeWall(i);
    told.push_back(sayWall(wall, false));
  }
  for (const DescribedWall& wall : before.walls) {
    if (isIn(places_.walls(), wall)) continue;
    places_.addWall(wall);
    told.push_back(sayWall(wall, true));
    haltAtDoor(wall, out);
  }
  if (told.size() > before_walls) {
    out.actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
  }
  places_.restoreNames(before.names);
  told_at_ = before.told_at;
  out.sentences.insert(out.sentences.end(), told.begin(), told.end());
}

void Dialogue::tellNamesAgain(const PlaceMan::Names& since, Reply& out) const {
  const Phrases& p = phrases();
  std::vector<std::string> nameless;
  for (const Place& place : places_.map().places) {
    const auto found = since.words.find(place.id);
    if (found == since.words.end()) continue;
    const std::vector<std::string> names = confirmedOf(place.words);
    const std::vector<std::string> before = confirmedOf(found->second);
    if (names == before) continue;
    const std::string code = codeOf(place);
    const bool guessed = std::any_of(place.words.begin(), place.words.end(), [&](const auto& word) {
      return std::find(before.begin(), before.end(), word.text) != before.end();
    });
    if (names.empty() && guessed) {
      out.sentences.push_back(
          p.say("no_longer_sure", {{"code", code}, {"names", p.list(said(before))}}));
    } else if (names.empty()) {
      nameless.push_back(code);
    } else {
      out.sentences.push_back(
          p.say("names_again", {{"code", code}, {"names", p.list(said(names))}}));
    }
  }
  if (!nameless.empty()) {
    out.sentences.push_back(p.say("forgot_names", {{"places", p.list(nameless)}}));
  }
}

bool Dialogue::takeBack(Turn& turn) {
  Reply& out = turn.reply;
  const Question::Kind asked = question().kind;
  const bool told_last = asked == Question::Kind::kAlsoName || asked == Question::Kind::kNewName;
  const std::string barrier = barrierToUndo();
  const bool nothing =
      !barrier.empty() || (talk_.changes.last() == nullptr && builder_.statementCount() == 0);
  if (told_last || (nothing && question().isAboutName())) {
    talk_.questions.drop();
    say("cancelled", turn);
    return true;
  }
  if (std::exchange(talk_.things_since, false)) {
    const std::string before = lastChange();
    if (before.empty()) {
      say("undo_of_things", turn);
    } else {
      out.sentences.push_back(phrases().say("undo_behind_things", {{"text", before}}));
    }
    return true;
  }
  if (!barrier.empty()) {
    say(barrier.c_str(), turn);
    return true;
  }
  KnownBefore* last = talk_.changes.last();
  const PlaceMan::Names since = places_.names();
  if (!talk_.changes.isStatementLast(builder_.statementCount())) {
    if (last->told) builder_.restore(std::move(*last->told));
    restoreKnown(*last, out);
    talk_.changes.dropLast();
  } else {
    const Utterance* said = builder_.lastStatement();
    if (said == nullptr) return false;
    out.sentences.push_back(phrases().say("statement_taken_back", {{"text", said->text}}));
    builder_.undo();
    if (builder_.building().places.empty()) places_.guess({});
    if (last != nullptr && last->barrier == KnownBefore::Barrier::kNone && !last->told &&
        builder_.statementCount() <= last->statements) {
      restoreKnown(*last, out);
      talk_.changes.dropLast();
    }
  }
  talk_.questions.drop();
  Reply matched = reply();  // what names are guesses again is known then
  matchDescription(matched, false);
  tellNamesAgain(since, out);
  if (out.sentences.empty()) say("taken_back", turn);
  out.append(std::move(matched));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return true;
}

}  // namespace hyselam_topo
