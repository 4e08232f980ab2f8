// A robot in one of two rooms (two_rooms.hpp) with a person beside it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "hyselam_topo/dialogue/dialogue.hpp"
#include "two_rooms.hpp"

/// Grammars are read once for all tests.
inline const hyselam_topo::TopoParser& sharedParser() {
  static const hyselam_topo::TopoParser kParser;
  return kParser;
}

inline const std::vector<hyselam_topo::Phrases>& sharedPhrases() {
  static const std::vector<hyselam_topo::Phrases> kPhrases{hyselam_topo::Phrases::shipped("en"),
                                                           hyselam_topo::Phrases::shipped("pt")};
  return kPhrases;
}

/// Room 1 is west, room 2 east; the robot stands in room 1 and asks nothing by itself.
struct Talk {
  hyselam_topo::Dialogue dialogue;
  double time = 0.0;

  explicit Talk(hyselam_topo::AskPolicy ask = hyselam_topo::AskPolicy::kNever)
      : dialogue(paramsOf(ask), sharedParser(), sharedPhrases()) {
    dialogue.setMap(two_rooms::map());
    at(2.0);
  }
  static hyselam_topo::DialogueParams paramsOf(hyselam_topo::AskPolicy ask) {
    hyselam_topo::DialogueParams params;
    params.ask = ask;
    return params;
  }
  /// x < 4: room 1.
  hyselam_topo::Reply at(double x) { return dialogue.setPose(time += 10.0, {x, 1.5, 0.0}); }
  std::string say(const std::string& text) { return dialogue.hear(text).text(); }
  std::vector<std::string> names(hyselam_topo::Id id) const {
    return hyselam_topo::namesOf(*dialogue.map().findPlace(id));
  }
  bool isConfirmed(hyselam_topo::Id id) const {
    return hyselam_topo::nameStateOf(*dialogue.map().findPlace(id)) ==
           hyselam_topo::NameState::kConfirmed;
  }
  /// The name of a room is only guessed.
  void guess(hyselam_topo::Id id, const std::string& name) {
    hyselam_topo::DialogueState state = dialogue.state();
    state.places.map.findPlace(id)->words = {{name, false}};
    dialogue.restore(state);
  }
  hyselam_topo::Question::Kind asked() const { return dialogue.question().kind; }
  /// The robot asks whether the room where it stands is the kitchen, which is only guessed.
  std::string askAboutKitchen() {
    guess(1, "kitchen");
    at(2.0);
    return dialogue.askHere().text();
  }
};
