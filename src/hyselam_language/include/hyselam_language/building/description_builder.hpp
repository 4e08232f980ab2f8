// Builds the description of a building (the graph of Fig. 5.5) from successive statements and their
// context: where the robot is, what "it" refers to, who speaks. Corrections replace what was
// said; what contradicts it is reported and left out; what only the person can tell is asked.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/building/description_state.hpp"
#include "hyselam_language/building/place_names.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"

namespace hyselam_topo {

enum class IssueKind {
  kContradiction,  ///< contradicts an earlier statement, which is kept
  kAmbiguous,      ///< a name or "it" may mean several places
  kNoContext,      ///< a side without the robot's place, "it" of nothing, nothing to take back
  kMeaningless,    ///< a place beside itself, more names than announced, a size out of range
  kNotice,         ///< recorded, but something was assumed or left out: metres
  kAsk,            ///< the person can answer: whose office? which of two toilets?
  kStrangeName     ///< a new name of no kind of place: "Shall I call a place 'uh-huh'?"
};

/// "contradiction", "ambiguous", "no context", "meaningless", "notice", "ask", "strange name".
const char* toString(IssueKind kind);

/// A statement, or part of one, that could not be recorded as it was said. Unless it is a notice,
/// nothing of the statement has been recorded, or that part of it has not.
struct DescriptionIssue {
  IssueKind kind = IssueKind::kContradiction;
  std::string reason;  ///< for people, in the language of setLanguage()
  std::string text;    ///< what was said
  TextRange range;
  std::string name;  ///< of kStrangeName: the name, for acceptName()
};

struct DescriptionParams {
  /// A new name is recorded at once only if it looks like one of a place (PlaceNames::isOfPlace()),
  /// was put between quotation marks or was told as a name ("There is a place called Atlantis");
  /// others are kStrangeName.
  bool ask_strange_names = true;
};

class DescriptionBuilder {
 public:
  /// The word lists of all the parser's languages decide which names mean the same place.
  explicit DescriptionBuilder(const TopoParser& parser, const DescriptionParams& params = {});

  /// Continues an earlier description; nothing of before can be taken back.
  void continueFrom(DescribedBuilding building);

  /// The language of reasons and of names that the builder makes ("Lisa's office"), at first the
  /// parser's first one. Throws hyselam::ParameterError for one that the parser does not know.
  void setLanguage(const std::string& language);

  /// Whether the intent describes the building: "neighbours", "size", ...; false for commands.
  static bool handles(const std::string& intent);

  /// Records one statement; returns the problems. Utterances of other kinds are ignored, but for
  /// those not understood, which are as sentenceRefused(). "undo", "replace" and
  /// "forget_everything" are statements, too.
  std::vector<DescriptionIssue> add(const Utterance& utterance);
  /// The same of all; sets the language.
  std::vector<DescriptionIssue> add(const ParsedText& text);

  /// A sentence was said that is not part of the description as it was not understood: "it" means
  /// nothing of before it.
  void sentenceRefused();

  /// From now on "my office" is the office of this person; "" of nobody known.
  void setSpeaker(const std::string& name) { speaker_ = name; }
  const std::string& speaker() const { return speaker_; }
  /// "office" as that person's: "Tom's office". The speaker must be known.
  std::string ofSpeaker(const std::string& kind) const;

  /// Where the robot stands and looks in the frame of the map while people tell what lies on which
  /// side; nothing: not known. Kept with what they tell.
  void setViewpoint(const std::optional<hyselam::Pose2>& viewpoint);

  /// The person has confirmed that a name (DescriptionIssue::name) is one of a place: statements
  /// that have it are recorded from now on.
  void acceptName(const std::string& name);

  /// Takes back the last statement that changed the description, be it a correction; false if there
  /// is none (at most the last 32 can be taken back).
  bool undo();
  /// The statement that undo() would take back; nullptr if there is none.
  const Utterance* lastStatement() const;
  /// How many statements have changed the description and were not taken back.
  std::size_t statementCount() const { return statements_; }

  struct Recorded {
    DescriptionState before;
    Utterance said;
    /// Of one that replaced others ("No, seven"): before the first of them.
    std::optional<DescriptionState> before_replaced = std::nullopt;
    /// What a replacement of it goes on from.
    const DescriptionState& base() const { return before_replaced ? *before_replaced : before; }
  };
  /// What was told, with what can be taken back of it.
  struct Memory {
    DescriptionState state;
    std::vector<Recorded> history;
    std::size_t statements = 0;
  };
  Memory memory() const { return {state_, history_, statements_}; }
  void restore(Memory memory);

  /// Sets the robot's place from another source than the description; adds the place if new.
  /// `kind`: known of the place where its name does not tell it.
  void setRobotPlace(const std::string& name, std::optional<PlaceKind> kind = std::nullopt);

  const DescribedBuilding& building() const { return state_.building; }
  /// A place that was told of under a name that nobody gave it, as the map's own for it, has this
  /// one from now on. Where another place has it already, all that was told is of that one.
  void giveName(const std::string& made_up, const std::string& name);
  /// Both are names of one place: what was told of two is of that one.
  void unite(const std::string& name, const std::string& other);
  /// A place is not called `old` any more, but `name`; as giveName() otherwise.
  void rename(const std::string& old, const std::string& name);
  /// Nothing is called so any more: a place that has no other name is gone with all that was told
  /// of it. Returns whether anything was.
  bool forgetName(const std::string& name);

  /// The places that a name means; none, one, or several if it is ambiguous.
  std::vector<Id> find(const std::string& name) const;
  /// "Corridor", "hallway": a word for a corridor, and nothing that tells which.
  bool isCorridorWithoutName(const std::string& name) const;

 private:
  /// The one place that has this name, as it is written best; 0: none, or several.
  Id called(const std::string& name) const;
  std::vector<DescriptionIssue> record(const Utterance& utterance);
  void remember(const DescriptionState& before, const Utterance& said);
  void remember(Recorded recorded);
  std::vector<DescriptionIssue> replaceLast(const Utterance& utterance);
  /// "No, seven": the one number of the last statement was another one.
  std::vector<DescriptionIssue> replaceNumber(const Utterance& utterance);
  /// Records the last statement as it should have been, in its place; undo() gives it back.
  std::vector<DescriptionIssue> recordInstead(const Utterance& again, const Utterance& correction);

  DescriptionParams params_;
  std::vector<Grammar> grammars_;
  std::size_t language_ = 0;  ///< of `grammars_`
  PlaceNames names_;
  DescriptionState state_;
  std::string speaker_;
  std::optional<hyselam::Pose2> viewpoint_;
  std::set<std::string> accepted_;  ///< NameKey::full
  std::vector<Recorded> history_;
  std::size_t statements_ = 0;
};

}  // namespace hyselam_topo
