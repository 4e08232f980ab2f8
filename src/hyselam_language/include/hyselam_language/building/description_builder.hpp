// Builds the description of a building (the graph of Fig. 5.5) from successive statements and their
// context: where the robot is, what "it" refers to. Corrections replace what was
// said; what contradicts it is reported and left out.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/building/place_names.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"

namespace hyselam_topo {

enum class IssueKind {
  kContradiction,  ///< contradicts an earlier statement, which is kept
  kAmbiguous,      ///< a name or "it" may mean several places
  kNoContext,      ///< a side without the robot's place, a correction of nothing, "it" of nothing
  kMeaningless,    ///< a place beside itself, more names than announced, a size out of range
  kNotice          ///< recorded, but something was assumed: metres
};

/// "contradiction", "ambiguous", "no context", "meaningless", "notice".
const char* toString(IssueKind kind);

/// A statement, or part of one, that could not be recorded as it was said.
struct DescriptionIssue {
  IssueKind kind = IssueKind::kContradiction;
  std::string reason;  ///< for people
  std::string text;    ///< what was said
  TextRange range;
};

class DescriptionBuilder {
 public:
  /// The word lists of all the parser's languages decide which names mean the same place.
  explicit DescriptionBuilder(const TopoParser& parser);

  /// Continues an earlier description.
  void continueFrom(DescribedBuilding building);

  /// Whether the intent describes the building: "neighbours", "size", ...; false for commands.
  static bool handles(const std::string& intent);

  /// Records one statement; returns the problems. Utterances of other kinds are ignored.
  std::vector<DescriptionIssue> add(const Utterance& utterance);
  std::vector<DescriptionIssue> add(const ParsedText& text);

  /// Sets the robot's place from another source than the description; adds the place if new.
  void setRobotPlace(const std::string& name);

  const DescribedBuilding& building() const { return building_; }
  /// The places that a name means; none, one, or several if it is ambiguous.
  std::vector<Id> find(const std::string& name) const;

 private:
  struct Failed {};

  void dispatch(const Utterance& u);
  void robotIn(const Utterance& u);
  void neighbours(const Utterance& u);
  void nthNeighbour(const Utterance& u);
  void contains(const Utterance& u);
  void joined(const Utterance& u);
  void relation(const Utterance& u, RelationKind kind);
  void alias(const Utterance& u);
  void kind(const Utterance& u);
  void size(const Utterance& u);
  void sizeOf(Id id, const Utterance& u);
  void parts(const Utterance& u);
  void buildingCount(const Utterance& u);
  /// A number that was said; one known before is replaced by a correction only. `told`: ends the
  /// sentence that says so.
  void takeCount(const Utterance& u, const std::string& told, std::optional<int>* known);
  void exists(const Utterance& u);
  void forget(const Utterance& u);

  /// The place of a name, made if it is new. Throws Failed after reporting.
  Id place(const SaidName& name);
  Id place(const Utterance& u, const std::string& slot);
  std::vector<Id> places(const Utterance& u, const std::string& slot);
  void checkCount(const Utterance& u, std::size_t named);
  void addAliases(const Utterance& u, Id id);
  void connect(Id from, Id to, Side side, std::optional<std::size_t> order);
  void setSize(std::optional<double>* member, const std::optional<double>& value,
               const std::string& what);
  std::string nameOf(Id id) const;
  void report(IssueKind kind, const std::string& reason);
  [[noreturn]] void fail(IssueKind kind, const std::string& reason);

  PlaceNames names_;
  DescribedBuilding building_;
  std::map<Id, std::vector<std::string>> variants_;  ///< what places were called besides
  std::vector<Id> subjects_;                         ///< what "it" may mean
  std::optional<Side> side_;                         ///< what "the same side" may mean
  bool correction_ = false;
  bool corrected_ = false;  ///< the correction has found something to replace
  const Utterance* current_ = nullptr;
  std::vector<DescriptionIssue> issues_;
};

}  // namespace hyselam_topo
