#include <gtest/gtest.h>

#include "hyselam_topo/dialogue/question_keeper.hpp"

using hyselam_topo::Question;
using hyselam_topo::QuestionKeeper;
using Topic = QuestionKeeper::Topic;

namespace {

QuestionKeeper asking() {
  QuestionKeeper keeper;
  Question question;
  question.kind = Question::Kind::kName;
  keeper.ask(question, "What is the name of this place?");
  return keeper;
}

}  // namespace

TEST(QuestionKeeper, AQuestionIsNotAnsweredByTheUtteranceThatLedToIt) {
  QuestionKeeper keeper = asking();
  EXPECT_TRUE(keeper.isNew());
  EXPECT_FALSE(keeper.endUtterance(Topic::kOther));
  EXPECT_TRUE(keeper.isOpen());
  keeper.beginUtterance();
  EXPECT_FALSE(keeper.isNew());
}

TEST(QuestionKeeper, AQuestionIsOverAfterSomethingElse) {
  QuestionKeeper keeper = asking();
  keeper.beginUtterance();
  EXPECT_FALSE(keeper.endUtterance(Topic::kNeutral));
  EXPECT_TRUE(keeper.isOpen());
  EXPECT_FALSE(keeper.endUtterance(Topic::kOther));
  EXPECT_FALSE(keeper.isOpen());
  EXPECT_EQ(keeper.sentence(), "");
}

TEST(QuestionKeeper, AQuestionIsPutAgainOnce) {
  QuestionKeeper keeper = asking();
  keeper.beginUtterance();
  EXPECT_TRUE(keeper.endUtterance(Topic::kNotUnderstood));
  EXPECT_FALSE(keeper.endUtterance(Topic::kNotUnderstood));
  EXPECT_FALSE(keeper.isOpen());
}
