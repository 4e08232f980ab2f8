// One statement while it is recorded: what was said, what it changes, its problems.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_language/building/description_builder.hpp"

namespace hyselam_topo {

/// What the builder knows besides the description.
struct Listener {
  const PlaceNames& names;
  const Grammar& grammar;  ///< of the language spoken
  const DescriptionParams& params;
  const std::string& speaker;
  const std::set<std::string>& accepted;
  const std::optional<hyselam::Pose2>& viewpoint;  ///< as DescriptionBuilder::setViewpoint()
  /// The description before the last statement; nullptr without one.
  const DescribedBuilding* before_last = nullptr;
};

class Statement {
 public:
  /// The statement cannot be recorded; why was reported.
  struct Failed {};
  using Values = std::vector<std::pair<std::string, std::string>>;

  Statement(const Utterance& said, const Listener& listener, DescriptionState* state);

  const Utterance& said() const { return said_; }
  const Listener& listener() const { return listener_; }
  const DescriptionState& state() const { return state_; }
  DescribedBuilding& building() { return state_.building; }
  DescriptionContext& context() { return state_.context; }
  std::vector<DescriptionIssue>& issues() { return issues_; }

  /// "no, ...": what contradicts it is replaced; denials always are such.
  bool isCorrection() const { return said_.correction; }
  bool isDenial() const { return !said_.word("denied").empty(); }
  bool hasCorrected() const { return corrected_; }
  /// To call before something told is replaced: fails with a contradiction (key of issue_texts.hpp)
  /// unless this is a correction.
  void replaces(const std::string& key, const Values& values);
  void setCorrected() { corrected_ = true; }

  void report(IssueKind kind, const std::string& key, const Values& values = {});
  [[noreturn]] void fail(IssueKind kind, const std::string& key, const Values& values = {});

  std::string nameOf(Id id) const;
  DescribedPlace& at(Id id) { return *state_.building.findPlace(id); }
  /// Records what another utterance tells, as a part of this statement.
  void recordAs(void (*record)(Statement&), const Utterance& said);
  /// The statement was about these: "it" and "they" from now on.
  void setSubjects(std::vector<Id> ids);

 private:
  const Utterance& said_;
  const Listener& listener_;
  DescriptionState& state_;
  std::vector<DescriptionIssue> issues_;
  bool corrected_ = false;
};

/// The kinds of statements by the names of their intents; nullptr for another one.
using RecordStatement = void (*)(Statement&);
RecordStatement statementKind(const std::string& intent);

}  // namespace hyselam_topo
