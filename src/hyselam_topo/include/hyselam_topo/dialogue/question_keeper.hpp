// The robot's open question, and when it is over.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_topo/dialogue/glass_wall.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"

namespace hyselam_topo {

/// Where to go: what people call it, and the places that it may be.
using NamedGoal = std::pair<std::string, std::vector<Id>>;

/// A guessed name that a new match puts elsewhere.
struct MovedName {
  std::string name;
  std::vector<Id> from;
  std::vector<Id> to;  ///< empty: the name has no place any more
};

/// The robot's open question.
struct Question {
  enum class Kind {
    kNone,
    kConfirmName,  ///< are `names` the names of `place`?
    kAlsoName,     ///< are `names` additional names of `place`, which has others already?
    kName,         ///< what is the name of `place`?
    kNewName,      ///< may a place be called `names`, which does not sound like one?
    kWall,         ///< is `wall` where the person means it?
    kWallLength,   ///< how long is the wall?
    kRadius,       ///< how large is the virtual place at `point`?
    kProposal,     ///< was `sentence` meant?
    kMoved,        ///< is it right that names move (`moved`)?
    kGo,           ///< drive to `goals`, though it is not sure that they are called so?
    kForgetAll,    ///< forget all names and all that was told?
    kSpeaker,      ///< what is the name of the person who speaks? Then `sentence` is heard again
    kPose,         ///< does the robot stand in `place`, whose names were told of where it is?
    kOpenDoor      ///< is the door that `wall` shuts open again? Then drive to `goals`
  };
  Kind kind = Kind::kNone;
  Id place = 0;  ///< of the kinds about names (0 of a kNewName that was told), kPose
  std::vector<std::string> names;  ///< likewise; kRadius: of the virtual place
  hyselam::Point2 point;           ///< kRadius: its middle
  DescribedWall wall;              ///< kWall, kWallLength, kOpenDoor
  /// kWall, kWallLength: the search for the described glass wall, continued with the answer.
  std::shared_ptr<GlassWallSearch> search;
  /// What is heard after the answer. kProposal: what may have been meant; kNewName: the statement
  /// that has the name, empty: it is that of `place`; kSpeaker: what could not be understood
  /// without the speaker; kPose, after a "no": what was said, from "you are in the canteen" on.
  std::string sentence;
  /// kPose, after a "yes": what was said behind "you are in the canteen".
  std::string rest;
  /// kProposal: what to ask after a "no".
  std::vector<std::string> alternatives;
  std::vector<MovedName> moved;  ///< kMoved
  std::vector<NamedGoal> goals;  ///< kGo, kOpenDoor

  /// Whether it is about the name of `place`.
  bool isAboutName() const;
};

/// The places that a question is about.
std::vector<Id> placesIn(const Question& question);

/// Whether a question can still be answered: all its places are there, and one that has other names
/// still has them.
bool isStillValid(const Question& question, const PlaceMan& places);

/// Keeps one question at most. It is over when it is answered, when another one is asked, and
/// after the next utterance about something else; for the name of a place also when the robot
/// leaves that, as the next name that it hears would be of another one.
class QuestionKeeper {
 public:
  const Question& question() const { return question_; }
  bool isOpen() const { return question_.kind != Question::Kind::kNone; }
  /// As it was put to the person.
  const std::string& sentence() const { return sentence_; }

  void ask(Question question, std::string sentence);
  void drop();
  /// The robot is no longer in the place that it asked about: it stays open, as one would put it
  /// from elsewhere, until there is something to ask about where the robot is now.
  void leave(std::string sentence);
  /// Whether a question about where the robot is now takes its place.
  bool yields() const { return !isOpen() || yields_; }

  /// What an utterance had to do with the question.
  enum class Topic {
    kAnswer,         ///< was about it
    kNeutral,        ///< a greeting, thanks
    kOther,          ///< was about something else
    kNotUnderstood,  ///< perhaps an answer
  };
  void beginUtterance() { is_new_ = false; }
  /// Whether it was asked after beginUtterance(): no part of that utterance answers it.
  bool isNew() const { return is_new_; }
  /// Returns whether the question should be put again: once, after what was not understood.
  bool endUtterance(Topic topic);

 private:
  Question question_;
  std::string sentence_;
  bool is_new_ = false;
  bool repeated_ = false;
  bool yields_ = false;
};

}  // namespace hyselam_topo
