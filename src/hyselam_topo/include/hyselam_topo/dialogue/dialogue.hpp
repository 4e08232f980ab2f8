// The dialogue with people about places (dos Santos, sections 5, 7.2 and 7.3.1): text in, text out,
// and actions for the robot.
//
// Without clock, ROS or robot: maps and poses are given to it, answers and actions are returned.
// Equal input gives equal output. Not thread-safe.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_topo/dialogue/ask_place.hpp"
#include "hyselam_topo/dialogue/glass_wall.hpp"
#include "hyselam_topo/dialogue/phrases.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"
#include "hyselam_topo/dialogue/place_pose.hpp"
#include "hyselam_topo/dialogue/route.hpp"
#include "hyselam_topo/dialogue/topo_state.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo {

struct DialogueParams {
  /// Of the robot's first sentences; then it answers in the language of the person.
  std::string language = "en";
  /// When the robot asks by itself, on entering a place.
  AskPolicy ask = AskPolicy::kUnconfirmed;
  /// After a description it asks for the name whose answer best separates assignments that fit
  /// about as well, wherever the place is (by its code word).
  bool ask_from_afar = false;
  SolverParams match = defaultMatch();
  GlassWallParams glass;
  RouteParams route;
  TopoStateParams state;

  /// Those of SolverParams, with a time limit of 2 s and answers kept that are worse by up to 0.03.
  static SolverParams defaultMatch();

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError for a parameter out of range.
  void validate() const;
};

struct DialogueAction {
  enum class Kind {
    kMap,     ///< the names or places of map() have changed
    kWalls,   ///< the described walls have changed: the grid map with them, too
    kGo,      ///< drive `legs`, one after another
    kStop,    ///< stop driving
    kFollow,  ///< follow the person
    kTurn     ///< turn by `angle`
  };
  Kind kind = Kind::kMap;
  std::vector<RouteLeg> legs;
  double angle = 0.0;  ///< [rad], left > 0
};

/// A sentence for another node, which knows more than places.
struct ForwardedSentence {
  std::string text;
  /// Answer if no other node understands it either; empty: the dialogue handles it after all.
  std::string refusal;
  bool about_object = false;  ///< refused because it names an object: another node knows better why
};

struct Reply {
  std::string language;
  std::vector<std::string> sentences;
  std::vector<DialogueAction> actions;
  std::vector<ForwardedSentence> forwarded;
  bool unknown_name = false;  ///< a place was named that nobody knows

  std::string text() const;  ///< the sentences, a blank between
  bool has(DialogueAction::Kind kind) const;
};

struct HearOptions {
  /// Another node listens: what is not understood, or names an unknown place, is returned in
  /// Reply::forwarded instead of being refused.
  bool forward_unknown = false;
  /// Objects were spoken of last: that "it", or what is no place, is in a room is about an object.
  bool objects_spoken_of = false;
  /// Another node asked the last question: answers are for it.
  bool others_asked_last = false;
};

/// The robot's open question.
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
  DescribedWall wall;
  std::shared_ptr<GlassWallSearch> search;
};

/// State of a dialogue; a plain value, for files (dialogue_state.hpp).
struct DialogueState {
  std::string language;
  PlaceMan::State places;
  DescribedBuilding description;
  /// Heading of the robot when sides were described, in the frame of the map [rad].
  std::optional<double> heading;
};

class Dialogue {
 public:
  /// @throws hyselam::ParameterError for a parameter out of range or a language without phrases.
  explicit Dialogue(const DialogueParams& params = {});
  Dialogue(const DialogueParams& params, TopoParser parser, std::vector<Phrases> phrases);

  // ---- Perception ----
  /// The topological map of a segmentation. Throws as PlaceMan::setMap().
  Reply setMap(const AugmentedTopologicalMap& fresh);
  /// The grid map, for glass walls.
  void setGrid(hyselam::OccupancyGrid grid);
  Reply setPose(double stamp, const hyselam::Pose2& pose);
  Reply losePose(double stamp);

  // ---- Input of people ----
  /// Any text. Never throws for what it says.
  Reply hear(const std::string& text, const HearOptions& options = {});
  /// Drives to the nearest of the places; says so if there is none or no way. `name`: of them.
  Reply goTo(const std::string& name, const std::vector<Id>& places);
  /// "This place is called ..." of any place, as by a click on the map. Throws as PlaceMan.
  Reply name(Id place, const std::vector<std::string>& names);
  Reply forget(Id place);
  Reply addVirtualPlace(hyselam::Point2 centre, double radius,
                        const std::vector<std::string>& names);
  Reply addWall(const DescribedWall& wall);

  // ---- Knowledge ----
  const AugmentedTopologicalMap& map() const { return places_.map(); }
  const PlaceMan& places() const { return places_; }
  const RobotPlace& robot() const { return topo_state_.robot(); }
  const DescribedBuilding& description() const { return builder_.building(); }
  const Question& question() const { return question_; }
  /// Of the last description; nothing before one was matched with a map.
  const std::optional<PlaceAssignment>& match() const { return match_; }
  /// The grid map with all described walls in it; nothing without a grid map.
  std::optional<hyselam::OccupancyGrid> gridWithWalls() const;
  /// All known names, confirmed, guessed or only described, sorted.
  std::vector<std::string> knownNames() const;
  /// What the robot says when those do not answer that a sentence was passed on to.
  std::string sayNobodyAnswers() const;
  /// The pose in the nearest of the places that have a name or code word; nothing for unknown ones.
  std::optional<std::pair<Id, PlacePose>> poseOf(const std::string& name) const;

  DialogueState state() const;
  /// Throws hyselam::InputError for a state that makes no sense.
  void restore(DialogueState state);

 private:
  struct Turn;  // what one text leads to, while it is handled
  using Handler = void (Dialogue::*)(const Utterance&, Turn&);

  const Phrases& phrases() const;
  Reply reply() const;
  ParsedText parse(const std::string& text);
  void handleUtterance(const Utterance& u, Turn& turn);
  void handleCommand(const Utterance& u, Turn& turn);
  /// What to do for an intent of the grammar; nullptr for one that is not handled.
  static Handler handlerOf(const Utterance& u);
  void forward(const Utterance& u, const std::string& refusal, Turn& turn);
  /// Calls act(); a hyselam::InputError becomes a sentence of the reply.
  template <typename Act>
  void attempt(Reply& reply, Act&& act);
  void say(const char* key, Turn& turn);
  /// Whether it says that something is in a room which is no place that was ever heard of.
  bool isAboutObject(const Utterance& u) const;

  // descriptions
  void addStatement(const Utterance& u, Turn& turn);
  void recordStatements(Turn& turn);
  void matchDescription(Reply& reply, bool report);
  void reportMatch(Reply& reply) const;

  // names
  void nameThisPlace(const Utterance& u, Turn& turn);
  void forgetNames(const Utterance& u, Turn& turn);
  void rename(const Utterance& u, Turn& turn);
  /// Whether a place is confirmed to have names, and none of these.
  bool isNamedOtherwise(Id place, const std::vector<std::string>& names) const;
  void nameHere(Id place, const std::vector<std::string>& names, Reply& reply);

  // questions of the robot, and their answers
  void enterPlace(Reply& reply);
  void askConfirm(Id place, Reply& reply);
  void askName(Id place, Reply& reply);
  /// Whether a place with other names has these as well.
  void askAlso(Id place, const std::vector<std::string>& names, Reply& out);
  void askFromAfar(const MatchProblem& problem, Reply& reply);
  void rejectGuess(Reply& reply);
  void answer(const Utterance& u, Turn& turn);
  void answerName(const std::vector<std::string>& names, Reply& reply);
  void answerLength(double length, Reply& reply);
  void answerYes(Reply& reply);
  void answerNo(Reply& reply);

  // walls and virtual places
  void addWall(const Utterance& u, Turn& turn);
  void askWall(const std::optional<GlassWall>& found, Reply& reply);
  void forgetWall(const Utterance& u, Turn& turn);
  void addVirtualPlace(const Utterance& u, Turn& turn);
  void addVirtualAndAsk(hyselam::Point2 centre, double radius,
                        const std::vector<std::string>& names, Reply& reply);

  // going
  void goTo(const Utterance& u, Turn& turn);
  void goBack(const Utterance& u, Turn& turn);
  void followPerson(const Utterance& u, Turn& turn);
  void turnRobot(const Utterance& u, Turn& turn);
  void stop(const Utterance& u, Turn& turn);
  void cancel(const Utterance& u, Turn& turn);
  void startGoal(Turn& turn);

  // small talk
  void help(const Utterance& u, Turn& turn);
  void greet(const Utterance& u, Turn& turn);
  void acceptThanks(const Utterance& u, Turn& turn);

  // questions of people
  void answerWhereAreYou(const Utterance& u, Turn& turn);
  void answerWhereIs(const Utterance& u, Turn& turn);
  void answerWayTo(const Utterance& u, Turn& turn);
  void answerNextTo(const Utterance& u, Turn& turn);
  void answerOpposite(const Utterance& u, Turn& turn);
  void answerOnSide(const Utterance& u, Turn& turn);
  void answerSize(const Utterance& u, Turn& turn);
  void answerWhichPlaces(const Utterance& u, Turn& turn);

  /// The places that a name, "here" or "it" means; says so if there are none.
  std::vector<Id> resolve(const SaidName& name, Reply& reply);
  std::vector<Id> resolve(const Utterance& u, const std::string& slot, Reply& reply);
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
  std::optional<PlaceAssignment> match_;
  std::optional<double> heading_;  // when sides were described
  Question question_;
  Id asked_ = 0;    // the place that was asked about during this stay
  Id subject_ = 0;  // what "it" means
};

}  // namespace hyselam_topo
