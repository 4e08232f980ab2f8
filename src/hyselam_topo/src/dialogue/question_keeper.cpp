#include "hyselam_topo/dialogue/question_keeper.hpp"

namespace hyselam_topo {

bool Question::isAboutName() const {
  return kind == Kind::kConfirmName || kind == Kind::kAlsoName || kind == Kind::kName ||
         (kind == Kind::kNewName && place != 0);
}

void QuestionKeeper::ask(Question question, std::string sentence) {
  question_ = std::move(question);
  sentence_ = std::move(sentence);
  is_new_ = true;
  repeated_ = false;
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
