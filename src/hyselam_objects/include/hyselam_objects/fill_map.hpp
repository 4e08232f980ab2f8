// FillMap (dos Santos, section 3.2.4): takes down in the object map what people tell, answers what
// they ask, and asks back instead of guessing or overwriting.
//
// Rules
// - "a cup", "two cups": those that the map already has at that place, with properties and relation
//   that do not speak against it, are meant; what is missing is added. "another cup" is always new.
// - "the cup", "it": the one that the map knows, first of those last spoken of, then at the place
//   spoken of, then anywhere; several: the robot asks which. None: it is added.
// - A list related to something ("a PC and a pen over the table") is related to it as a whole,
//   without what is that thing itself ("a table and a cup on the table").
// - "cups" without a number: the robot asks how many; "some" or "yes" are at least two, two are
// taken.
// - "I moved the pen to the hall" tells of a change: what was known of its place gives way.
// - The place is the one told, else that of the thing it is related to, else the last one spoken
//   of, else where the robot is ("here").
// - A thing is at one place and rests on one thing; it has one colour. What says otherwise is asked
//   about: "yes" or "no, ..." (corrections) change the map, nothing else does.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_objects/object_dictionary.hpp"
#include "hyselam_objects/object_map.hpp"
#include "hyselam_objects/object_parser.hpp"

namespace hyselam_objects {

enum class ReplyKind { kDone, kAnswer, kQuestion, kNotUnderstood };
/// "done", "answer", "question", "not understood".
const char* toString(ReplyKind kind);

struct ObjectReply {
  ReplyKind kind = ReplyKind::kDone;
  std::string text;         ///< for people
  std::string code;         ///< of the phrase: "contradiction", "which_one", ...
  std::vector<Id> objects;  ///< what it is about
  std::vector<Id> places;
  std::string kind_of_object;  ///< of "this is a cup": what is shown
};

class FillMap {
 public:
  /// All must outlive this.
  FillMap(const ObjectParser* parser, ObjectMap* map);

  /// Where the robot is, for "here" and for what is told without a place; "" nowhere known.
  void setPlace(const std::string& name) { here_ = name; }
  /// Stamp of what is told from now on [s].
  void setTime(double stamp) { stamp_ = stamp; }

  /// One reply for each sentence, or part of one that stands for itself.
  std::vector<ObjectReply> say(const std::string& text);

  /// NewObject: kinds of objects in the map that the dictionary cannot recognise, in the order of
  /// their names.
  std::vector<std::string> unknownKinds(const ObjectDictionary& dictionary) const;
  /// "I do not know what a pen looks like: show me one."
  std::string askToShow(const std::string& kind) const;
  /// "Now I know what a pen looks like."
  std::string learnt(const std::string& kind) const;

  /// The map is another one: nothing was spoken of.
  void forgetContext();

 private:
  struct Target;
  struct Pending {
    std::vector<ObjectStatement> statements;  ///< what waits for an answer
    bool for_place = false;
    bool for_count = false;
  };

  ObjectReply take(const ObjectStatement& statement);
  ObjectReply tell(const ObjectStatement& statement);
  ObjectReply describe(const ObjectStatement& statement);
  ObjectReply forget(const ObjectStatement& statement);
  ObjectReply ask(const ObjectStatement& statement);
  ObjectReply answer(const ObjectStatement& statement);

  std::string phrase(const std::string& key,
                     const std::vector<std::pair<std::string, std::string>>& values = {}) const;
  ObjectReply reply(ReplyKind kind, const std::string& key,
                    const std::vector<std::pair<std::string, std::string>>& values = {}) const;
  ObjectReply askBack(const ObjectStatement& statement, const std::string& key,
                      const std::vector<std::pair<std::string, std::string>>& values,
                      bool for_place = false);

  Id findPlace(const std::string& name) const;
  std::string placeName(const hyselam_topo::SaidName& said) const;
  bool fits(const ObjectInstance& object, const ObjectPhrase& said) const;
  std::vector<Id> candidates(const ObjectPhrase& said) const;
  /// Those that a definite phrase means; empty: none is known; several: it is not clear.
  /// `only_there`: of several those at the place, which was told.
  std::vector<Id> resolve(const ObjectPhrase& said, Id place, bool only_there = false) const;
  std::string contradiction(Id object, const Target& target) const;
  bool restsOn(Id object, Id other) const;
  void put(Id object, const Target& target);
  Id add(const ObjectPhrase& said, const Target& target);
  std::string name(Id object) const;
  std::string whereIs(Id object) const;
  std::string list(const std::vector<std::string>& items) const;

  const ObjectParser& parser_;
  ObjectMap& map_;
  std::string language_;  ///< last spoken
  std::string here_;
  double stamp_ = 0.0;
  std::vector<Id> subjects_;  ///< last spoken of
  Id place_ = 0;              ///< last spoken of
  std::optional<Pending> pending_;
};

}  // namespace hyselam_objects
