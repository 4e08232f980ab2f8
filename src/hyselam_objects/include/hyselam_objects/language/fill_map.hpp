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
// - "I moved the pen to the hall" reports a change: what was known of its place is replaced.
// - The place is the one stated, else that of the object it is related to, else the one mentioned
//   last, else where the robot is ("here").
// - An object is at one place and rests on one object; it has one color. A contradiction leads to a
//   question: only "yes" or "no, ..." (a correction) changes the map.
#pragma once

#include <optional>
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
};

class FillMap {
 public:
  /// Both must outlive this; `map` is changed by process().
  FillMap(const ObjectParser& parser, ObjectMap& map);
  FillMap(ObjectParser&& parser, ObjectMap& map) = delete;

  /// Where the robot is, for "here" and for statements without a place; "": not known.
  void setRobotPlace(const std::string& name) { robot_place_ = name; }
  /// Stamp of the statements from now on [s].
  void setTime(double stamp) { stamp_ = stamp; }

  /// Records the statements of a text and answers its questions: one reply for each sentence, or
  /// part of one that stands for itself.
  std::vector<ObjectReply> process(const std::string& text);

  /// NewObject: kinds of objects in the map that the dictionary cannot recognize, sorted by name.
  std::vector<std::string> unknownKinds(const ObjectDictionary& dictionary) const;
  /// "I do not know what a pen looks like: show me one."
  std::string showRequest(const std::string& kind) const;
  /// "Now I know what a pen looks like."
  std::string learnedReply(const std::string& kind) const;

  /// The open question is over without an answer: stop, cancel, or something else was said.
  void dropQuestion() { pending_.reset(); }
  /// The map is another one: nothing was mentioned yet.
  void resetContext();

 private:
  struct Target;
  struct PhraseMeaning;
  struct StatementMeaning;
  /// A statement that waits for the answer to a question about it.
  struct Pending {
    ObjectStatement statement;
    bool for_place = false;
    bool for_count = false;
  };
  using Values = std::vector<std::pair<std::string, std::string>>;
  /// The question that must be answered first, if any.
  using Question = std::optional<ObjectReply>;

  ObjectReply processStatement(const ObjectStatement& statement);
  ObjectReply recordObjects(const ObjectStatement& statement);
  ObjectReply recordProperties(const ObjectStatement& statement);
  ObjectReply removeObjects(const ObjectStatement& statement);
  ObjectReply answerQuestion(const ObjectStatement& statement);
  ObjectReply processAnswer(const ObjectStatement& statement);

  // The meaning of a statement; nothing is changed.
  Question interpretPlace(const ObjectStatement& statement, StatementMeaning& meaning);
  Question interpretLandmark(const ObjectStatement& statement, StatementMeaning& meaning);
  Question interpretPhrases(const ObjectStatement& statement, StatementMeaning& meaning);
  Question interpretDefinite(const ObjectStatement& statement, const StatementMeaning& meaning,
                             PhraseMeaning& phrase);
  Question interpretIndefinite(const ObjectStatement& statement, StatementMeaning& meaning,
                               PhraseMeaning& phrase);
  Question checkPlaceKnown(const ObjectStatement& statement, StatementMeaning& meaning);
  Question checkContradictions(const ObjectStatement& statement, const StatementMeaning& meaning);
  ObjectReply applyMeaning(const ObjectStatement& statement, StatementMeaning& meaning);
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
  ObjectReply goToAnswer(const std::vector<Id>& objects, const std::vector<Id>& places) const;
  ObjectReply isThereAnswer(const std::vector<Id>& objects) const;
  /// A question to the person; those that "yes" or a place answers are kept as pending.
  ObjectReply askBack(const ObjectStatement& statement, const std::string& key,
                      const Values& values, bool for_place = false);
  std::string objectName(Id object) const;
  std::string objectLocation(Id object) const;
  std::string enumeration(const std::vector<std::string>& items) const;
  std::string placeNames(const std::vector<Id>& places) const;

  const ObjectParser& parser_;
  ObjectMap& map_;
  std::string language_;  ///< of the last sentence
  std::string robot_place_;
  double stamp_ = 0.0;
  std::vector<Id> last_objects_;  ///< mentioned last
  Id last_place_ = 0;             ///< mentioned last
  std::optional<Pending> pending_;
};

}  // namespace hyselam_objects
