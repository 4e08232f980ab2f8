// FillMap (dos Santos, section 3.2.4): records in the object map what people say about objects,
// answers their questions, and asks a question back instead of guessing or overwriting.
//
// Rules
// - "a cup", "two cups": objects that the map already has at that place, with properties and
//   relation that do not contradict the phrase, are meant; missing ones are added. "another cup" is
//   always a new object.
// - "the cup", "it": the known object, first of those last mentioned, then at the place mentioned,
//   then anywhere; several: the robot asks which one. None: it is added.
// - A list related to something ("a PC and a pen over the table") is related to it as a whole,
//   without that thing itself ("a table and a cup on the table").
// - "cups" without a number: the robot asks how many; "some" or "yes" are at least two, two are
//   added.
// - "the green one", "another one", "the other cup": of the kind mentioned last.
// - "I moved the pen to the hall" reports a change: what was known of its place is replaced, and
//   told. "The pen is gone", "the pen is no longer on the table": it is removed.
// - "the cup on the tray on the table": first the tray is recorded, then the cup.
// - "in front of room 3" relates to a place; where the object is at remains unknown.
// - The place is the one stated, else that of the object it is related to, else the one mentioned
//   last, else where the robot is ("here").
// - An object is at one place and rests on one object; it has one color. A contradiction leads to a
//   question: only "yes" or "no, ..." (a correction) changes the map.
// - A text answers one question at most, and only one that was put before it. A question is dropped
//   by a sentence about something else.
// - Nothing that is not understood is the object of a later "it".
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_objects/language/object_parser.hpp"
#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/recognition/object_dictionary.hpp"

namespace hyselam_objects {

enum class ReplyKind { kDone, kAnswer, kQuestion, kNotUnderstood };
/// "done", "answer", "question", "not understood".
const char* toString(ReplyKind kind);

struct ObjectReply {
  ReplyKind kind = ReplyKind::kDone;
  std::string text;            ///< for people
  std::string code;            ///< of the phrase: "contradiction", "which_one", ...
  std::vector<Id> objects;     ///< objects that the reply is about
  std::vector<Id> places;      ///< places that the reply is about
  std::string reason;          ///< why it is not understood; "" otherwise
  std::string kind_of_object;  ///< of "this is a cup": kind of the demonstrated object
  /// Of kDone: what was taken down, sentence by sentence without full stop: "a pen is in the lab".
  std::vector<std::string> facts;
};

class FillMap {
 public:
  /// Both must outlive this; `map` is changed by process().
  FillMap(const ObjectParser& parser, ObjectMap& map);
  FillMap(ObjectParser&& parser, ObjectMap& map) = delete;

  /// Where the robot is, for "here" and for statements without a place; "": not known. Where it
  /// enters another place, what was said of others before is not meant any more: "There is a note
  /// on the desk" is here.
  void setRobotPlace(const std::string& name);
  /// Stamp of the statements from now on [s].
  void setTime(double stamp) { stamp_ = stamp; }

  /// Records the statements of a text and answers its questions: one reply for each sentence, or
  /// part of one that stands for itself.
  std::vector<ObjectReply> process(const std::string& text);

  /// Whether a question waits for its answer.
  bool hasQuestion() const { return pending_.has_value(); }
  /// The open question is over without an answer: stop, cancel, or something else was said.
  void dropQuestion() { pending_.reset(); }

  /// NewObject: kinds of objects in the map that the dictionary cannot recognize, sorted by name.
  std::vector<std::string> unknownKinds(const ObjectDictionary& dictionary) const;
  /// The kind that the robot should ask to be shown after these replies: one that they tell of and
  /// that the dictionary cannot recognize; "" after a question, for parts of the building and
  /// furniture, and for kinds that this was told of before.
  std::string kindToShow(const ObjectDictionary& dictionary,
                         const std::vector<ObjectReply>& replies);
  /// "I do not know what a pen looks like: show me one."
  std::string showRequest(const std::string& kind) const;
  /// "Now I know what a pen looks like."
  std::string learnedReply(const std::string& kind) const;
  /// "There is no camera here to look at a pen." Where nothing can be shown: instead of the reply
  /// with the code "shown".
  std::string noCameraReply(const std::string& kind) const;

  /// The map is another one: nothing was mentioned yet.
  void resetContext();

 private:
  struct Target;
  struct PhraseMeaning;
  struct StatementMeaning;
  enum class Asked { kYesNo, kPlace, kCount, kChoice, kProposal };
  /// A statement that waits for the answer to a question about it.
  struct Pending {
    ObjectStatement statement;
    Asked asked = Asked::kYesNo;
    std::vector<Id> choices;            ///< of kChoice
    bool landmark_is_asked = false;     ///< of kChoice: the statement's landmark; else its object
    std::size_t object = 0;             ///< of kChoice: which of its objects
    std::vector<ObjectStatement> rest;  ///< of the same sentence, to go on with
    int failures = 0;                   ///< texts that were not understood since
  };
  using Values = std::vector<std::pair<std::string, std::string>>;
  /// The question that must be answered first, if any.
  using Question = std::optional<ObjectReply>;

  void forgetGone();
  /// Those that the map still has.
  std::vector<Id> stillThere(const std::vector<Id>& objects) const;
  std::vector<ObjectReply> processAll(const std::vector<ObjectStatement>& statements);
  std::vector<ObjectReply> processOne(const ObjectStatement& statement);
  ObjectReply processStatement(const ObjectStatement& statement);
  bool isWhole(const std::string& sentence) const;
  /// Asks for what a refused statement may have meant, its suggestion (0) or the alternatives from
  /// that number on; nothing without one that makes sense.
  std::optional<ObjectReply> proposed(const ObjectStatement& statement, std::size_t from);
  ObjectReply refuse(const ObjectStatement& statement);
  ObjectReply record(const ObjectStatement& statement);
  /// `replaces`: the reply tells again of the objects of the one before, and more.
  static void addReply(ObjectReply reply, bool continues, bool replaces,
                       std::vector<ObjectReply>* replies);
  ObjectReply correctLast(const ObjectStatement& statement);
  ObjectReply describeLast(const ObjectStatement& statement);
  void takeMissed(ObjectStatement* statement);
  ObjectReply recordObjects(const ObjectStatement& statement);
  ObjectReply recordProperties(const ObjectStatement& statement);
  ObjectReply recordOwner(const ObjectStatement& statement);
  ObjectReply setProperties(const ObjectStatement& statement, const std::vector<Id>& objects,
                            const std::map<std::string, std::string>& properties);
  ObjectReply removeObjects(const ObjectStatement& statement);
  ObjectReply removeFromPlace(const ObjectStatement& statement);
  ObjectReply answerQuestion(const ObjectStatement& statement);
  std::vector<ObjectReply> processAnswer(const ObjectStatement& statement);
  std::vector<ObjectReply> answerPending(const Pending& pending, const ObjectStatement& answer);
  std::vector<Id> chosenOf(const Pending& pending, const ObjectStatement& answer) const;
  /// Kinds of "the green one"; false if nothing was mentioned.
  bool resolveOnes(ObjectStatement* statement) const;

  // The meaning of a statement; nothing is changed.
  Question interpretPlace(const ObjectStatement& statement, StatementMeaning& meaning);
  Question interpretLandmark(const ObjectStatement& statement, StatementMeaning& meaning);
  std::optional<std::vector<Id>> subjectOrLandmark(const ObjectStatement& statement) const;
  Question interpretPhrases(const ObjectStatement& statement, StatementMeaning& meaning);
  Question interpretDefinite(const ObjectStatement& statement, const StatementMeaning& meaning,
                             std::size_t index, PhraseMeaning& phrase);
  Question interpretIndefinite(const ObjectStatement& statement, StatementMeaning& meaning,
                               PhraseMeaning& phrase);
  Question checkPlaceKnown(const ObjectStatement& statement, StatementMeaning& meaning);
  Question checkContradictions(const ObjectStatement& statement, const StatementMeaning& meaning);
  ObjectReply applyMeaning(const ObjectStatement& statement, StatementMeaning& meaning);
  std::vector<std::string> changedFacts(const std::vector<Id>& objects, bool definite,
                                        const ObjectMap& before,
                                        const std::map<Id, std::string>& places_before);
  void removeSurplus(const StatementMeaning& meaning);
  std::vector<Id> applyPhrase(const PhraseMeaning& phrase, const Target& target);

  // Phrases and the objects that they mean.
  Id findPlace(const std::string& name) const;
  std::string resolvePlaceName(const hyselam_topo::SaidName& said) const;
  bool matchesPhrase(const ObjectInstance& object, const ObjectPhrase& phrase) const;
  std::vector<Id> candidates(const ObjectPhrase& phrase) const;
  /// Objects that a definite phrase means; empty: none is known; several: ambiguous.
  /// `only_there`: of several candidates only those at `place`, which was stated.
  std::vector<Id> resolveReference(const ObjectPhrase& phrase, Id place,
                                   bool only_there = false) const;
  std::string contradiction(Id object, const Target& target) const;
  bool isSupportedBy(Id object, Id other) const;
  bool isRelatedToRoom(Id object) const;
  bool areCompatible(RelationWord a, Id other_a, RelationWord b, Id other_b) const;
  /// Whether an object is known to be related so to one of the others.
  bool isRelatedSo(const ObjectInstance& object, RelationWord word,
                   const std::vector<Id>& others) const;
  /// What the landmarks and further relations of a question mean; false if there is no such thing.
  bool narrow(const ObjectStatement& question, std::vector<Id>* landmarks,
              std::vector<std::vector<Id>>* further) const;
  bool matchesQuestion(const ObjectInstance& object, const ObjectStatement& question, Id place,
                       const std::vector<Id>& landmarks) const;

  // Changes of the map.
  void applyTarget(Id object, const Target& target);
  void moveToPlace(Id object, Id place);
  void relateToLandmark(Id object, const Target& target);
  Id addObject(const ObjectPhrase& phrase, const Target& target);

  // Words of the replies.
  std::string phraseText(const std::string& key, const Values& values = {}) const;
  ObjectReply reply(ReplyKind kind, const std::string& key, const Values& values = {}) const;
  ObjectReply answerText(const ObjectStatement& question, const std::vector<Id>& objects,
                         const std::vector<Id>& places) const;
  ObjectReply goToAnswer(const ObjectStatement& question, const std::vector<Id>& objects,
                         const std::vector<Id>& places) const;
  bool startsWithMany(const std::vector<Id>& objects) const;
  static std::string sentencesOf(const std::vector<std::string>& facts);
  ObjectReply isThereAnswer(const std::vector<Id>& objects) const;
  ObjectReply propertyAnswer(const ObjectStatement& question, const std::vector<Id>& objects) const;
  /// A question to the person; those that "yes" or a place answers are kept as pending.
  ObjectReply askBack(const ObjectStatement& statement, const std::string& key,
                      const Values& values, Asked asked = Asked::kYesNo);
  ObjectReply askWhich(const ObjectStatement& statement, const ObjectPhrase& phrase,
                       const std::vector<Id>& choices, bool landmark_is_asked,
                       std::size_t object = 0);
  /// In the grammar's form for a word, if it has one: "an {what}".
  std::string formed(const std::string& key, const std::string& kind, const Values& values) const;
  std::string contracted(const std::string& text) const;
  /// "small red cup", "small red cups", without article.
  std::string bareName(Id object, bool plural) const;
  /// "a red cup", "the red cup", "John's cup".
  std::string objectName(Id object, bool definite = true) const;
  /// "two red cups".
  std::string countedName(const std::vector<Id>& objects, bool definite) const;
  /// "a PC and two pens".
  std::string countedNames(const std::vector<Id>& objects, bool definite) const;
  std::string placeName(const std::string& name) const;
  /// "on the table in the kitchen"; "" if nothing is known.
  std::string objectLocation(Id object) const;
  /// "a PC and two pens are on the table in the office", one for each location.
  /// With `key` "gone": "the pen is no longer on the table". `with_positions`: of those with no
  /// other location the measured position, if there is one.
  std::vector<std::string> factsOf(const std::vector<Id>& objects, bool definite,
                                   const std::string& key = "where",
                                   bool with_positions = false) const;
  /// "at (28.6, -7.0)", x and y in the frame of the map [m]; "" if it was never seen.
  std::string measuredLocation(Id object) const;
  std::string enumeration(const std::vector<std::string>& items, bool choice = false) const;
  std::string placeNames(const std::vector<Id>& places) const;

  const ObjectParser& parser_;
  ObjectMap& map_;
  std::string language_;  ///< of the last sentence
  std::string robot_place_;
  std::string last_named_place_;  ///< of the robot
  bool just_came_ = false;        ///< it has entered another place, and nothing was told since
  double stamp_ = 0.0;
  std::vector<Id> last_objects_;    ///< mentioned last
  std::vector<Id> landmarks_told_;  ///< of the same sentence: "it" does not mean them
  Id last_landmark_ = 0;            ///< that they were related to
  std::string last_kind_;           ///< of the objects mentioned last
  std::optional<ObjectStatement> last_statement_;  ///< taken down last
  std::vector<Id> last_added_;                     ///< objects that it has added
  std::optional<ObjectPhrase> missed_;             ///< said to be gone: "it" of the next sentence
  std::optional<ObjectStatement> last_question_;   ///< asked right before
  std::set<std::string> shown_kinds_;              ///< that the robot has asked to be shown
  bool question_is_new_ = false;                   ///< the text that is processed has led to it
  Id last_place_ = 0;                              ///< mentioned last
  std::optional<Pending> pending_;
};

}  // namespace hyselam_objects
