#include "hyselam_topo/dialogue/question_keeper.hpp"

#include <algorithm>

namespace hyselam_topo {

bool Question::isAboutName() const {
  return kind == Kind::kConfirmName || kind == Kind::kAlsoName || kind == Kind::kName ||
         (kind == Kind::kNewName && place != 0);
}

std::vector<Id> placesIn(const Question& question) {
  std::vector<Id> all;
  if (question.place != 0) all.push_back(question.place);
  const auto add = [&](const std::vector<Id>& ids) {
    all.insert(all.end(), ids.begin(), ids.end());
  };
  for (const MovedName& each : question.moved) {
    add(each.from);
    add(each.to);
  }
  for (const NamedGoal& goal : question.goals) add(goal.second);
  return all;
}

bool isStillValid(const Question& question, const PlaceMan& places) {
  const std::vector<Id> all = placesIn(question);
  if (!std::all_of(all.begin(), all.end(),
                   [&](Id id) { return places.map().findPlace(id) != nullptr; })) {
    return false;
  }
  return question.kind != Question::Kind::kAlsoName ||
         nameStateOf(*places.map().findPlace(question.place)) == NameState::kConfirmed;
}

void QuestionKeeper::ask(Question question, std::string sentence) {
  question_ = std::move(question);
  sentence_ = std::move(sentence);
  is_new_ = true;
  repeated_ = false;
  yields_ = false;
}

void QuestionKeeper::leave(std::string sentence) {
  sentence_ = std::move(sentence);
  yields_ = true;
}

void QuestionKeeper::drop() {
  question_ = {};
  sentence_.clear();
}

bool QuestionKeeper::endUtterance(Topic topic) {
  if (!isOpen() || is_new_) return false;
  if (topic == Topic::kOther || (topic == Topic::kNotUnderstood && repeated_)) {
    drop();
    return false;
  }
  if (topic != Topic::kNotUnderstood) return false;
  repeated_ = true;
  return true;
}

}  // namespace hyselam_topo
