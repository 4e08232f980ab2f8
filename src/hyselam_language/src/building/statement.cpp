#include "statement.hpp"

#include <algorithm>

#include "issue_texts.hpp"

namespace hyselam_topo {

Statement::Statement(const Utterance& said, const Listener& listener, DescriptionState* state)
    : said_(said), listener_(listener), state_(*state) {}

void Statement::replaces(const std::string& key, const Values& values) {
  if (!isCorrection()) fail(IssueKind::kContradiction, key, values);
  corrected_ = true;
}

void Statement::report(IssueKind kind, const std::string& key, const Values& values) {
  DescriptionIssue issue;
  issue.kind = kind;
  issue.reason = issueText(listener_.grammar, key, values);
  issue.text = said_.text;
  issue.range = said_.range;
  issues_.push_back(std::move(issue));
}

void Statement::fail(IssueKind kind, const std::string& key, const Values& values) {
  report(kind, key, values);
  throw Failed();
}

std::string Statement::nameOf(Id id) const {
  const DescribedPlace* found = state_.building.findPlace(id);
  return found == nullptr ? "" : found->name;
}

void Statement::recordAs(void (*record)(Statement&), const Utterance& said) {
  Statement part(said, listener_, &state_);
  const auto take = [&] {
    issues_.insert(issues_.end(), part.issues_.begin(), part.issues_.end());
    corrected_ = corrected_ || part.corrected_;
  };
  try {
    record(part);
  } catch (const Failed&) {
    take();
    throw;
  }
  take();
}

void Statement::setSubjects(std::vector<Id> ids) {
  DescriptionContext& context = state_.context;
  const auto inGroup = [&](Id id) {
    return std::find(context.group.begin(), context.group.end(), id) != context.group.end();
  };
  if (ids.size() > 1) {
    context.group = ids;
    context.told_of_group.clear();
  } else if (std::any_of(ids.begin(), ids.end(), inGroup)) {
    context.told_of_group.insert(ids.begin(), ids.end());
  } else {
    context.group.clear();
    context.told_of_group.clear();
  }
  context.pair.clear();
  context.subjects = std::move(ids);
}

}  // namespace hyselam_topo
