// The talk with people about places (dos Santos, sections 5, 7.2 and 7.3.1): text in, text out, and
// what the robot shall do.
//
// It knows no clock, no ROS and no robot: maps and poses are told to it, what follows from what it
// hears comes back as values. Equal input gives equal output. Not for several threads at once.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_topo/dialogue/glass_wall.hpp"
#include "hyselam_topo/dialogue/phrases.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"
#include "hyselam_topo/dialogue/place_pose.hpp"
#include "hyselam_topo/dialogue/route.hpp"
#include "hyselam_topo/dialogue/topo_state.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo {

struct DialogueParams {
  /// Of the first words of the robot; then it speaks as it was spoken to.
  std::string language = "en";
  /// TopoAskPlace (Alg. 1): when the robot asks by itself, on entering a place.
  enum class Ask {
    kNever,
    kUnconfirmed,  ///< whether a guessed name is right
    kAlways        ///< also for the name of a place without one
  };
  Ask ask = Ask::kUnconfirmed;
  /// After a description it asks for the name that tells apart best what fits about as well,
  /// wherever the place is (by its code word).
  bool ask_from_afar = false;
  MatchParams match = defaultMatch();
  GlassWallParams glass;
  RouteParams route;
  TopoStateParams state;

  /// Those of MatchParams, with a time limit of 2 s and answers kept that are worse by up to 0.03.
  static MatchParams defaultMatch();
};

/// Throws hyselam::ParameterError for a parameter out of range or a language without phrases.
void checkDialogueParams(const DialogueParams& params);

struct DialogueAction {
  enum class Kind {
    kMap,     ///< the names or places of map() have changed
    kWalls,   ///< the told walls have changed: the grid map with them, too
    kGo,      ///< drive `legs`, one after another
    kStop,    ///< stop driving
    kFollow,  ///< follow the person
    kTurn     ///< turn by `angle`
  };
  Kind kind = Kind::kMap;
  std::vector<RouteLeg> legs;
  double angle = 0.0;  ///< [rad], left > 0
};

/// A sentence for somebody else, who knows more than places.
struct PassedOn {
  std::string text;
  /// Said if nobody else understands it either; empty: the dialogue is to hear it after all.
  std::string refusal;
  bool of_a_thing = false;  ///< it was refused because it names an object: others know better why
};

struct Reply {
  std::string language;
  std::vector<std::string> sentences;
  std::vector<DialogueAction> actions;
  std::vector<PassedOn> passed_on;
  bool unknown_name = false;  ///< a place was named that nobody knows

  std::string text() const;  ///< the sentences, a blank between
  bool has(DialogueAction::Kind kind) const;
};

struct HearOptions {
  /// Somebody else listens: what is not understood, or names a place that nobody knows, comes back
  /// in Reply::passed_on instead of being refused.
  bool pass_on = false;
  /// Things were spoken of last: that "it", or what is no place, is in a room is of a thing.
  bool of_things = false;
  /// Somebody else has asked last: answers are for them.
  bool others_asked = false;
};

/// What the robot has asked and waits for.
struct Question {
  enum class Kind {
    kNone,
    kConfirmName,  ///< has `place` the names?
    kAlsoName,     ///< has `place`, which has other names, the names as well?
    kName,         ///< what is the name of `place`?
    kWall,         ///< is `wall` right?
    kWallLength,   ///< how long is the wall?
    kRadius        ///< how large is the virtual place at `point`?
  };
  Kind kind = Kind::kNone;
  Id place = 0;
  std::vector<std::string> names;
  hyselam::Point2 point;
  ToldWall wall;
  std::shared_ptr<GlassWallSearch> search;
};

/// All that a talk leaves behind; a plain value, for files (dialogue_state.hpp).
struct DialogueState {
  std::string language;
  PlaceMan::State places;
  DescribedBuilding description;
  /// Where the robot looked when sides were told, in the frame of the map [rad].
  std::optional<double> heading;
};

class Dialogue {
 public:
  /// Throws as checkDialogueParams().
  explicit Dialogue(const DialogueParams& params = {});
  Dialogue(const DialogueParams& params, TopoParser parser, std::vector<Phrases> phrases);

  // ---- What the robot perceives ----
  /// The topological map of a segmentation. Throws as PlaceMan::setMap().
  Reply setMap(const AugmentedTopologicalMap& fresh);
  /// The grid map, for glass walls.
  void setGrid(hyselam::OccupancyGrid grid);
  Reply setPose(double stamp, const hyselam::Pose2& pose);
  Reply poseLost(double stamp);

  // ---- What it is told ----
  /// Any text. Never throws for what it says.
  Reply hear(const std::string& text, const HearOptions& options = {});
  /// Drives to the nearest of the places; says so if there is none or no way. `name`: of them.
  Reply goTo(const std::string& name, const std::vector<Id>& places);
  /// "This place is called ..." of any place, as by a click on the map. Throws as PlaceMan.
  Reply name(Id place, const std::vector<std::string>& names);
  Reply forget(Id place);
  Reply addVirtualPlace(hyselam::Point2 centre, double radius,
                        const std::vector<std::string>& names);
  Reply addWall(const ToldWall& wall);

  // ---- What it knows ----
  const AugmentedTopologicalMap& map() const { return places_.map(); }
  const PlaceMan& places() const { return places_; }
  const RobotPlace& robot() const { return topo_state_.robot(); }
  const DescribedBuilding& description() const { return builder_.building(); }
  const Question& question() const { return question_; }
  /// Of the last description; nothing before one was matched with a map.
  const std::optional<Match>& match() const { return match_; }
  /// The grid map with all told walls in it; nothing without a grid map.
  std::optional<hyselam::OccupancyGrid> gridWithWalls() const;
  /// All names that mean something, confirmed, guessed or only told of, sorted.
  std::vector<std::string> knownNames() const;
  /// What the robot says when those do not answer that a sentence was passed on to.
  std::string nobodyAnswers() const;
  /// The pose in the nearest of the places that have a name or code word; nothing for unknown ones.
  std::optional<std::pair<Id, PlacePose>> poseOf(const std::string& name) const;

  DialogueState state() const;
  /// Throws hyselam::InputError for a state that makes no sense.
  void restore(DialogueState state);

 private:
  struct Turn;  // what one text leads to, while it is worked on

  const Phrases& phrases() const;
  Reply reply() const;
  bool understands(const Utterance& u, Turn* turn);
  bool isOfThing(const Utterance& u) const;

  // describing
  void statement(const Utterance& u, Turn* turn);
  void takeDown(Turn* turn);
  void solve(Reply* reply, bool tell);
  void tellMatch(Reply* reply) const;

  // names
  void thisIs(const Utterance& u, Turn* turn);
  void forgetNames(const Utterance& u, Turn* turn);
  void rename(const Utterance& u, Turn* turn);
  /// Whether a place is confirmed to have names, and none of these.
  bool isNamedOtherwise(Id place, const std::vector<std::string>& names) const;
  void nameHere(Id place, const std::vector<std::string>& names, Reply* reply);

  // what the robot asks, and what is answered
  void placeEntered(Reply* reply);
  void askConfirm(Id place, Reply* reply);
  void askName(Id place, Reply* reply);
  /// Whether a place with other names has these as well.
  void askAlso(Id place, const std::vector<std::string>& names, Reply* out);
  void askFromAfar(const MatchProblem& problem, Reply* reply);
  void notConfirmed(Reply* reply);
  void answer(const Utterance& u, Turn* turn);
  void answerName(const std::vector<std::string>& names, Reply* reply);
  void answerLength(double length, Reply* reply);
  void answerYes(Reply* reply);
  void answerNo(Reply* reply);

  // walls and virtual places
  void wall(const Utterance& u, WallKind kind, Turn* turn);
  void askWall(const std::optional<GlassWall>& found, Reply* reply);
  void forgetWall(const Utterance& u, Turn* turn);
  void virtualPlace(const Utterance& u, Turn* turn);
  void addVirtualAndAsk(hyselam::Point2 centre, double radius,
                        const std::vector<std::string>& names, Reply* reply);

  // going
  void goTo(const Utterance& u, Turn* turn);
  void setOut(Turn* turn);

  // questions
  void whereAreYou(Reply* reply);
  void whereIs(const Utterance& u, Turn* turn);
  void wayTo(const Utterance& u, Turn* turn);
  void nextTo(const Utterance& u, Turn* turn);
  void opposite(const Utterance& u, Turn* turn);
  void onSide(const Utterance& u, Turn* turn);
  void size(const Utterance& u, Turn* turn);
  void whichPlaces(Reply* reply);

  /// The places that a name, "here" or "it" means; says so if there are none.
  std::vector<Id> resolve(const SaidName& name, Reply* reply);
  std::vector<Id> resolve(const Utterance& u, const std::string& slot, Reply* reply);
  /// "CC04, corridor"; "SS02, perhaps kitchen"; "SS03".
  std::string label(Id place) const;
  /// "corridor"; "kitchen"; "SS03".
  std::string shortName(Id place) const;
  std::vector<std::string> labels(const std::vector<Id>& places) const;

  DialogueParams params_;
  TopoParser parser_;
  std::map<std::string, Phrases> phrases_;
  std::string language_;
  PlaceMan places_;
  DescriptionBuilder builder_;
  TopoState topo_state_;
  bool entered_ = false;  ///< another place, or the same on another map; not looked at yet
  std::optional<hyselam::OccupancyGrid> grid_;
  std::optional<Match> match_;
  std::optional<double> heading_;  // when sides were told
  Question question_;
  Id asked_ = 0;    // the place that was asked about during this stay
  Id subject_ = 0;  // what "it" means
};

}  // namespace hyselam_topo
