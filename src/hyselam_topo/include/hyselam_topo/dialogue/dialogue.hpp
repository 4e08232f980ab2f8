// The dialogue with people about places (dos Santos, sections 5, 7.2 and 7.3.1): text in, text out,
// and actions for the robot.
//
// Without clock, ROS or robot: maps and poses are given to it, answers and actions are returned.
// Equal input gives equal output. Not thread-safe.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_language/grammar/urgent_words.hpp"
#include "hyselam_topo/dialogue/ask_place.hpp"
#include "hyselam_topo/dialogue/change_history.hpp"
#include "hyselam_topo/dialogue/dialogue_params.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topo/dialogue/phrases.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"
#include "hyselam_topo/dialogue/place_pose.hpp"
#include "hyselam_topo/dialogue/question_keeper.hpp"
#include "hyselam_topo/dialogue/reply.hpp"
#include "hyselam_topo/dialogue/route.hpp"
#include "hyselam_topo/dialogue/topo_state.hpp"
#include "hyselam_topo/dialogue/uncertainty.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo {

struct SaidAnswer;

class Dialogue {
 public:
  /// @throws hyselam::ParameterError for a parameter out of range or a language without phrases.
  explicit Dialogue(const DialogueParams& params = {});
  Dialogue(const DialogueParams& params, TopoParser parser, std::vector<Phrases> phrases);

  // ---- Perception ----
  /// A new topological map from segmentation. Throws as PlaceMan::setMap().
  Reply setMap(const AugmentedTopologicalMap& fresh);
  /// The grid map, for glass walls.
  void setGrid(hyselam::OccupancyGrid grid);
  Reply setPose(double stamp, const hyselam::Pose2& pose);
  Reply losePose(double stamp);

  // ---- Input of people ----
  /// Any text. Never throws, whatever the content. Stop and cancel are obeyed first, wherever they
  /// stand in it (urgent_words.hpp).
  Reply hear(const std::string& text, const HearOptions& options = {});
  /// Another node has understood what was said, of things: "undo that" does not go behind it
  /// unasked.
  void thingsSpokenOf() { talk_.things_since = true; }
  /// What "undo that" would take back now, for people: a statement, or names; "": nothing, or it
  /// would have to be asked for twice, or another question is open.
  std::string nextUndo() const;
  /// Where "carry on" would drive to, after a stop on the way; "": nowhere.
  std::string haltedGoal() const;
  /// Obeys stop and cancel in a text of any length, and nothing else of it; nothing without them.
  std::optional<Reply> obeyUrgent(const std::string& text);
  /// What hear() would not understand of a text, part by part, as an answer to the open question,
  /// too; nothing is done.
  std::vector<std::string> notUnderstood(const std::string& text) const;
  /// No other node has understood a forwarded sentence: the refusal, or what may have been meant
  /// as a question.
  Reply refuse(const ForwardedSentence& sentence);
  /// Drives to the nearest of `places`; replies with the reason if there is none or no path.
  /// `name`: what the replies call them.
  Reply goTo(const std::string& name, const std::vector<Id>& places);
  /// These are the names of any place from now on, e.g. after a click on the map; what it was
  /// called before is forgotten.
  /// @throws hyselam::InputError without names, and as PlaceMan::confirm().
  Reply name(Id place, const std::vector<std::string>& names);
  /// Removes all names of a place; what was told of it stays, without them. Throws as
  /// PlaceMan::forget().
  Reply forget(Id place);
  /// Adds a place that has no walls, so that segmentation cannot find it: a disc of `radius` [m]
  /// around `centre` [m, map frame]. Throws as PlaceMan::addVirtualPlace().
  Reply addVirtualPlace(hyselam::Point2 centre, double radius,
                        const std::vector<std::string>& names);
  Reply addWall(const DescribedWall& wall);
  /// The wall of this kind between these ends is there no more. Without actions: there was none.
  Reply removeWall(const DescribedWall& wall);
  /// The talk goes on in that language. False if the robot does not speak it.
  bool useLanguage(const std::string& language);
  /// Asks about the robot's place now, as on entering it with AskPolicy::kAlways. Nothing where its
  /// name is confirmed, the place is not known, or another question is open.
  Reply askHere();
  /// A reply without content, in the language of the conversation.
  Reply reply() const;

  // ---- State ----
  const AugmentedTopologicalMap& map() const { return places_.map(); }
  /// The place manager (PlaceMan, dos Santos 2014, section 3.2.2): names, glass walls and virtual
  /// places that people add.
  const PlaceMan& places() const { return places_; }
  const RobotPlace& robot() const { return topo_state_.robot(); }
  const DescribedBuilding& description() const { return builder_.building(); }
  const Question& question() const { return talk_.questions.question(); }
  /// The open question as it was put; "" for none.
  const std::string& openQuestion() const { return talk_.questions.sentence(); }
  /// Assignment of the description's names to places of the map; nothing if there is none.
  const std::optional<PlaceAssignment>& match() const { return talk_.match; }
  /// Names of it whose places are not sure, and where they may be.
  const Uncertainty& unsure() const { return talk_.unsure; }
  /// Of the names whose place is not sure, where they may be; of those that are nowhere yet, the
  /// places without a name.
  std::map<std::string, std::vector<Id>> whereMayBe() const;
  /// The grid map with the described walls in it (PlaceMan::withWalls()); nothing without a grid
  /// map.
  std::optional<hyselam::OccupancyGrid> gridWithWalls() const;
  /// All place names, confirmed, guessed or only described, sorted.
  std::vector<std::string> knownNames() const;
  /// Reply when no node answers a forwarded sentence.
  std::string sayNobodyAnswers() const;
  /// The nearest place with this name or generated id (e.g. SS03), and a pose in it; nothing if no
  /// place has it.
  std::optional<std::pair<Id, PlacePose>> poseOf(const std::string& name) const;

  DialogueState state() const;
  /// The talk begins anew with that state. @throws hyselam::InputError for an inconsistent one.
  void restore(DialogueState state);

 private:
  struct Turn;  // one text of a person: reply, goals and statements while it is handled
  using Handler = void (Dialogue::*)(const Utterance&, Turn&);
  class Change;  // of what is known, while it is made

  // Each section is a source file. Handlers of intents take what was said and the text that it is
  // part of (handlerOf()).

  // ---- What the robot perceives, its knowledge (dialogue.cpp) ----
  const Phrases& phrases() const;
  void enterPlace(Reply& reply);
  void askAboutPlace(Id place, AskPolicy policy, Reply& reply);
  /// What was asked or told right before of places that a new map does not have is over.
  void forgetLost(const std::vector<Id>& lost, const KnownBefore& known);
  /// How many named places are not to be seen any more, and how many again.
  void tellOutOfSight(const PlaceMan::MapReport& report, Reply& out) const;

  // ---- One text, utterance by utterance (dialogue_hear.cpp) ----
  /// As what may answer the open question, if need be; nothing is changed.
  ParsedText parsed(const std::string& text) const;
  /// The same; the talk goes on in its language.
  ParsedText parse(const std::string& text);
  /// Whether the parser has a grammar of it.
  bool knowsLanguage(const std::string& language) const;
  /// What remains after stop and cancel.
  Reply understand(const std::string& text, const HearOptions& options);
  /// What all texts end with: statements are recorded, goals set out for, questions asked.
  void finish(Turn& turn);
  /// "Forget Narnia", where a place is called so: without an article it may be anything else. One
  /// letter away from such a name is asked about. False if nothing known is to be forgotten.
  bool forgetsKnown(const Utterance& u, Turn& turn);
  void handleUtterance(const Utterance& u, Turn& turn);
  /// Passes a "no" with more behind it on; `behind_forwarded`: so was what stands before it.
  bool correctsObject(const Utterance& u, bool behind_forwarded, Turn& turn);
  void handleCommand(const Utterance& heard, Turn& turn);
  /// Asks who speaks if "my office" cannot be told otherwise.
  bool askWhose(const Utterance& u, Turn& turn);
  /// What is the speaker's under its full name: "Tom's office".
  Utterance withSpeaker(Utterance u) const;
  /// The member function for an intent of the grammar; nullptr for one that is not handled.
  static Handler handlerOf(const Utterance& u);
  void forward(const Utterance& u, const std::string& refusal, Turn& turn);
  void say(const char* key, Turn& turn);
  /// Whether the statement is "A is in room X" and A is "it" or not a known place.
  bool isAboutObject(const Utterance& u) const;
  /// Whether "it is X" names the place where the robot is: nothing else was spoken of.
  bool isOfThisPlace(const Utterance& u, const Turn& turn) const;
  /// Whether "that is X" is of a place that was spoken of right before in the same text.
  bool pointsBack(const Utterance& u, const Turn& turn) const;
  /// "SS05 is the library", also the other way round, in `named`: as if said there.
  bool isOfNumberedPlace(const Utterance& u, Utterance* named) const;
  /// "Forget the kitchen", which is a name of the map that nobody has told anything of.
  bool isOnlyOnMap(const Utterance& u) const;
  void help(const Utterance& u, Turn& turn);
  void greet(const Utterance& u, Turn& turn);
  void acceptThanks(const Utterance& u, Turn& turn);
  /// Calls act(); a hyselam::InputError becomes a sentence of the reply.
  template <typename Act>
  void attempt(Reply& reply, Act&& act);

  // ---- Stop and cancel (dialogue_urgent.cpp) ----
  /// Stop or cancel was said.
  Reply obey(const UrgentWords& urgent);
  void heedRest(const UrgentRest& rest, Turn& turn);
  void refuseRest(const UrgentRest& rest, Turn& turn);

  // ---- What is not understood, and what may have been meant (dialogue_refusals.cpp) ----
  void tellLeftOut(Turn& turn);
  void refuse(const Utterance& u, Turn& turn);
  /// Nothing of it was understood, and it is in another language.
  bool refuseOtherLanguage(const ParsedText& parsed, const std::string& language_before,
                           Turn& turn);
  /// Asks whether something was meant that was not understood.
  void propose(Turn& turn);
  /// Whether a sentence that is proposed would be taken as it stands.
  bool isAcceptable(const std::string& sentence) const;
  std::vector<std::string> acceptableOf(std::vector<std::string> proposals) const;
  /// A sentence as it can be said, of names that are known here.
  std::string withKnownNames(const std::string& advice, const std::string& said_text) const;
  /// One cause and one advice; `advice`: "" for that of the reason.
  std::string sayNotUnderstood(const std::string& text, const std::string& reason,
                               const std::string& advice) const;

  // ---- From names to places and back (dialogue_reference.cpp) ----
  /// Of the language of the talk.
  const Grammar& grammar() const;
  /// The places of the description that a name, "here" or "it" means.
  std::vector<Id> described(const SaidName& name) const;
  /// The places of the map where a name is confirmed.
  std::vector<Id> confirmedPlaces(const std::string& name) const;
  /// The places of the map with a name of the same kind: all toilets.
  std::vector<Id> placesOfKind(const std::string& name) const;
  /// Whether a name of another language may mean several names: "casa de banho" the toilet and the
  /// bathroom.
  bool areOfOtherNames(const std::string& name, const std::vector<Id>& places) const;
  /// That a place is not on this map now; of one that was never found, what was told of it, and how
  /// to tell where it is. False if nothing was told.
  bool tellOnlyTold(const std::string& name, Reply& reply);
  /// The places that a name, "here" or "it" refers to; adds the reason to `reply` if none.
  std::vector<Id> resolve(const SaidName& name, Reply& reply);
  std::vector<Id> resolve(const Utterance& u, const std::string& slot, Reply& reply);
  /// For lists, the code first: "CC04, corridor"; "SS02, perhaps kitchen"; "SS03".
  std::string codeAndNames(Id place) const;
  /// Name, else code, without an article: "corridor"; "kitchen"; "SS03".
  std::string shortName(Id place) const;
  /// For sentences, the name first: "the corridor (CC04)", "perhaps the kitchen (SS02)", "SS03".
  std::vector<std::string> labels(const std::vector<Id>& places) const;
  /// A name with its article in the language of the talk: "the kitchen", but "room 5".
  std::string said(const std::string& name) const;
  std::vector<std::string> said(std::vector<std::string> names) const;
  /// As said(), where a sentence begins that speaks of one: "The kitchen", but "stairs".
  std::string subject(const std::string& name) const;

  // ---- Statements about the building, matched with the map (dialogue_descriptions.cpp) ----
  /// Sides are told from where the robot is, also where it has been driven since that was told.
  /// `also_unnamed`: also where nobody has named the place, then under the map's own name.
  void followRobot(bool also_unnamed);
  /// "The corridor", where the robot stands in one and nobody has told of another.
  bool saysItsCorridor(const Utterance& u) const;
  /// In the description the robot is where one of the names belongs; it stays where it was told to
  /// be if each of them fits several places that were told of. `kind` as setRobotPlace().
  void tellRobotPlace(Id place, std::vector<std::string> names,
                      std::optional<PlaceKind> kind = std::nullopt);
  /// Names of a place that was told of under the map's own name for it.
  void giveNames(Id place);
  /// Whether a name is the map's own for a place of it (SS03).
  bool isCode(const std::string& name) const;
  void addStatement(const Utterance& u, Turn& turn);
  void recordStatements(Turn& turn);
  void reportIssues(Turn& turn);
  /// Asks what the person can answer.
  void askAboutIssue(const DescriptionIssue& issue, bool asks_speaker, Reply& reply);
  /// Reads the statements back that `before` did not have.
  void readBack(const DescribedBuilding& before, bool here_told, Reply& reply);
  void matchDescription(Reply& reply, bool report);
  /// `moved` is told by tellMoved().
  void reportMatch(const std::vector<MovedName>& moved, Reply& reply);
  /// Where the names are that have come to a likely place since people were told.
  void tellLikely(const std::vector<MovedName>& moved, Reply& reply);

  // ---- What people say against what they have confirmed (dialogue_confirmed.cpp) ----
  /// What was told since `before` of the names of places that have confirmed ones holds for the
  /// map, too: "the library is also called Atlantis".
  void nameAsTold(const DescribedBuilding& before);
  /// Why two places cannot lie as told since `before`: both are confirmed, and far apart.
  std::optional<std::string> deniedByMap(const DescribedBuilding& before) const;
  /// "You are in the canteen", which is known elsewhere: asks whether the robot is lost. False
  /// where it may be there.
  bool askPose(const Utterance& u, Turn& turn);
  void startFrom(const Question& asked, Turn& turn);

  // ---- Names, told one by one (dialogue_naming.cpp) ----
  void nameThisPlace(const Utterance& u, Turn& turn);
  void namePlace(Id place, const Utterance& u, Turn& turn);
  /// "SS05 is not the library", and what it is instead, if that is said.
  void correctName(Id place, const Utterance& u, Turn& turn);
  /// "All the names are right": the places that have only guesses keep them.
  void confirmAll(const Utterance& u, Turn& turn);
  /// Names, with the others that people have told of the place that is called so.
  std::vector<std::string> withTold(const std::vector<std::string>& names) const;
  /// ... but for those that another place has.
  std::vector<std::string> ownNames(Id place, const std::vector<std::string>& names) const;
  /// Names of a place that are no more are gone from what was told, too, but not what was told of
  /// the place.
  bool forgetNamesOf(Id place);
  void dropTold(Id place, const std::vector<std::string>& names);
  void forgetNames(const Utterance& u, Turn& turn);
  void askForgetEverything(const Utterance& u, Turn& turn);
  void forgetEverything(Reply& reply);
  void rename(const Utterance& u, Turn& turn);
  /// A person has agreed that places may be called so.
  void acceptNames(const std::vector<std::string>& names);
  void setSpeaker(const std::string& name, Reply& reply);
  void introduce(const Utterance& u, Turn& turn);
  /// Whether a place has confirmed names, and none of these.
  bool isNamedOtherwise(Id place, const std::vector<std::string>& names) const;
  /// Confirms names, updates the match with the description and replies.
  /// `instead`: of all names that the place has.
  void confirmNames(Id place, const std::vector<std::string>& names, Reply& reply,
                    bool instead = false);

  // ---- Where names belong that have no sure place (dialogue_wondering.cpp) ----
  /// From now on until something else is spoken of, "it is SS03", "in place 3" tells where the
  /// first of these names belongs that is not said.
  void wonder(std::vector<std::string> names);
  bool isWondering() const { return !talk_.wondered.empty() && !talk_.questions.isOpen(); }
  /// The place of a "where" that was answered: "SS03", "number 3"; nothing for another text.
  std::optional<Id> placeIn(const Utterance& u) const;
  bool takeWhere(const ParsedText& text, Turn& turn);
  /// "Yes", where names were wondered about: asks whether the place that was guessed is right.
  /// False if there is none.
  bool askWondered(Reply& reply);
  bool isOfOtherFloor(const std::string& name) const;
  /// How to tell where a name belongs that has no place on the map.
  void askWhere(Reply& reply);

  // ---- "Undo that" (dialogue_undo.cpp) ----
  /// "Undo that": of the question for a name that was told last, else of the last change of what
  /// is known; false if there is none.
  bool takeBack(Turn& turn);
  /// Which names have changed since, as sentences.
  void tellNamesAgain(const PlaceMan::Names& since, Reply& reply) const;
  KnownBefore knownNow() const;
  void remember(KnownBefore before);
  /// Whether names, walls or virtual places are others now.
  bool isChanged(const KnownBefore& since) const;
  /// Why "undo that" can take nothing back, as a phrase; "" where it can.
  std::string barrierToUndo() const;
  /// As nextUndo(), whether things were spoken of since or not.
  std::string lastChange() const;
  /// The map as it was before, without what statements have told.
  void restoreKnown(const KnownBefore& before, Reply& reply);

  // ---- Questions of the robot ... (dialogue_robot_asks.cpp) ----
  /// The first of the proposals; the others after a "no". At least one.
  void askProposal(const std::vector<std::string>& proposals, Reply& reply);
  /// Puts the open question again, or drops it if the text was about something else.
  void settleQuestion(Turn& turn);
  void askConfirm(Id place, Reply& reply);
  /// The open question is over if what it is about is gone.
  void dropStaleQuestion();
  /// The robot is not where the question is about: what is answered with yes or no stays open.
  void leaveQuestion();
  /// A question about a name, of a place by its generated id.
  std::string sayFromAfar(const Question& question) const;
  void askName(Id place, Reply& reply);
  /// Asks whether a place with other names has these as well.
  void askAlso(Id place, const std::vector<std::string>& names, Reply& out);
  /// For the name of a place where the robot may not be, by its generated id.
  void askFromAfar(Id place, Reply& reply);
  void askMostInformativeQuestion(const MatchProblem& problem, Reply& reply);
  /// Asks whether a place may be called so; `sentence`: Question::sentence.
  void askNewName(Id place, const std::vector<std::string>& names, const std::string& sentence,
                  Reply& reply);
  /// Tells which names are elsewhere now; `asks`: whether that is right.
  void tellMoved(std::vector<MovedName> moved, bool asks, Reply& reply);
  void ask(Question question, const std::string& sentence, Reply& reply);

  // ---- ... and what is answered to them (dialogue_person_answers.cpp) ----
  void rejectGuess(const Question& asked, Reply& reply);
  /// Takes the answer to the open question from the begin of a text.
  void takeAnswer(const ParsedText& text, Turn& turn);
  void heedFirstWord(const std::string& text, SaidAnswer* said) const;
  void answer(const SaidAnswer& said, Turn& turn);
  void answerName(const SaidAnswer& said, const Question& asked, Reply& reply);
  void answerLength(double length, const Question& asked, Reply& reply);
  void answerYes(const Question& asked, Turn& turn);
  void answerNo(const Question& asked, Reply& reply);
  /// Yes, no or a number where nothing is asked.
  void meetAnswer(const Utterance& u, Turn& turn);
  /// Whether a name sounds like one of a place, or is known as one.
  bool isPlaceName(const SaidName& name) const;

  // ---- Described walls, shut doors, virtual places (dialogue_walls.cpp) ----
  /// Why there is no way, where one would lead through a shut door or a described wall. Of a door
  /// that is treated as shut it asks whether that is open again; then it drives to `goals_then`.
  void tellWallInTheWay(const hyselam::Pose2& from, const std::vector<Id>& goals,
                        const std::vector<NamedGoal>& goals_then, Reply& reply);
  /// That it is there now, or no more; of one that shuts a door, what becomes of the door.
  std::string sayWall(const DescribedWall& wall, bool is_there) const;
  void addWall(const Utterance& u, Turn& turn);
  void askWall(const std::optional<WallLine>& found, Question question, Reply& reply);
  void forgetWall(const Utterance& u, Turn& turn);
  /// The number in PlaceMan::walls() of the nearest wall on a side of the robot.
  std::optional<std::size_t> wallOnSide(Side side) const;
  /// The places of each name that tells which door is meant; nothing if one is not known.
  std::optional<std::vector<std::vector<Id>>> sidesOfDoor(const Utterance& u, Reply& reply);
  /// A door that people tell to be closed is shut by a virtual wall.
  void shutDoor(const Utterance& u, Turn& turn);
  void openDoor(const Utterance& u, Turn& turn);
  /// The wall that shuts it is gone.
  void openDoor(const DescribedWall& wall, Reply& reply);
  void addVirtualPlace(const Utterance& u, Turn& turn);
  void addVirtualAndAsk(hyselam::Point2 centre, double radius,
                        const std::vector<std::string>& names, Reply& reply);

  // ---- Driving (dialogue_driving.cpp) ----
  /// As planRoute(), through no shut door.
  std::optional<RouteLeg> route(const hyselam::Pose2& from, const std::vector<Id>& goals) const;
  void goTo(const Utterance& u, Turn& turn);
  void goToPreviousPlace(const Utterance& u, Turn& turn);
  void followPerson(const Utterance& u, Turn& turn);
  void turnRobot(const Utterance& u, Turn& turn);
  /// "Carry on": where it was going when it was stopped.
  void carryOn(const Utterance& u, Turn& turn);
  void stop(const Utterance& u, Turn& turn);
  void cancel(const Utterance& u, Turn& turn);
  void startGoal(Turn& turn);
  /// Whether it is not sure that the place is called so.
  bool isUnsure(const NamedGoal& goal) const;
  void drive(const std::vector<NamedGoal>& goals, Reply& reply);
  /// No more motion.
  void halt(Reply& reply);
  /// It is under way from now on, to that place or, for 0, behind a person; how long it has stood
  /// before is no sign that it has arrived.
  void setOut(Id to);
  /// A robot that stands in the place it was sent to is not under way any more.
  void seeWhetherArrived();
  /// A robot that drives stops when a door is shut, which may be on its way.
  void haltAtDoor(const DescribedWall& wall, Reply& out);
  void refuseCorridor(const Utterance& u, Turn& turn);
  void refuseComing(const Utterance& u, Turn& turn);
  void refuseCarrying(const Utterance& u, Turn& turn);

  // ---- Answers to questions about the building: from the map ... (dialogue_answers.cpp) ----
  void answerWhereAreYou(const Utterance& u, Turn& turn);
  void answerWhereIs(const Utterance& u, Turn& turn);
  void answerRouteTo(const Utterance& u, Turn& turn);
  void answerNextTo(const Utterance& u, Turn& turn);
  void answerOpposite(const Utterance& u, Turn& turn);
  void answerOnSide(const Utterance& u, Turn& turn);
  void answerSize(const Utterance& u, Turn& turn);
  void answerWhichPlaces(const Utterance& u, Turn& turn);

  // ---- ... and from what was told, then from the map (dialogue_told_answers.cpp) ----
  void answerTold(const Utterance& u, Turn& turn);
  void answerWhatIsKnown(const Utterance& u, Turn& turn);
  void answerOwner(const Utterance& u, Turn& turn);
  void answerPersonPlace(const Utterance& u, Turn& turn);
  void answerIsLocated(const Utterance& u, Turn& turn);
  void answerIsJoined(const Utterance& u, Turn& turn);
  void answerIsLarger(const Utterance& u, Turn& turn);
  void answerWhatIsLocated(const Utterance& u, Turn& turn);
  void answerIsKnown(const Utterance& u, Turn& turn);
  void answerNearest(const Utterance& u, Turn& turn);
  void answerHowMany(const Utterance& u, Turn& turn);
  void answerLargest(const Utterance& u, Turn& turn);
  void answerWhoAmI(const Utterance& u, Turn& turn);
  void sayTruth(const std::optional<bool>& truth, const std::string& reason, Reply& reply);

  DialogueParams params_;
  TopoParser parser_;
  std::map<std::string, Phrases> phrases_;
  std::string language_;
  PlaceNames names_;
  PlaceMan places_;
  DescriptionBuilder builder_;
  TopoState topo_state_;
  std::shared_ptr<const hyselam::OccupancyGrid> grid_;
  std::optional<double> heading_;            // DialogueState::heading
  std::optional<hyselam::Point2> position_;  ///< then
  Id told_at_ = 0;                           ///< DialogueState::told_at

  /// What is in no DialogueState: nothing of it outlives restore().
  struct Talk {
    // Names on the map
    std::optional<PlaceAssignment> match;
    Uncertainty unsure;                     ///< of match
    std::map<std::string, Id> told_likely;  ///< Uncertainty::likely as people know it
    std::vector<std::string> wondered;      ///< names whose place was said not to be sure
    bool wonders_anew = false;              ///< ... in this turn
    std::set<std::string> accepted;         ///< names that a person has agreed to (NameKey::full)

    // What the robot asks
    QuestionKeeper questions;
    bool entered = false;  ///< the robot's place or the map has changed; not processed yet
    Id asked = 0;          ///< the place for which a question was considered since entering it

    // What was said before
    Id subject = 0;                      ///< antecedent of "it"
    bool described_last = false;         ///< the last utterance told of places: "it" is one of them
    bool others_asked = false;           ///< the last question was another node's
    std::vector<std::string> last_said;  ///< for "what?"
    bool is_here = false;                ///< it was asked about where it is told to be
    bool is_trial = false;               ///< only to see whether a sentence would be taken

    // Driving
    std::optional<Id> under_way;  ///< the place that it drives to; 0: it follows a person
    std::vector<NamedGoal> way;   ///< where it was sent last, what is left of it ...
    bool halted = false;          ///< ... and it was stopped on the way
    hyselam::Pose2 stood_at;      ///< where it was when it moved last
    double stands_since = 0.0;    ///< [s]

    // "Undo that"
    ChangeHistory changes;
    bool changing = false;      ///< within a Change
    bool things_since = false;  ///< things were spoken of since the last change
  };
  Talk talk_;
};

}  // namespace hyselam_topo
