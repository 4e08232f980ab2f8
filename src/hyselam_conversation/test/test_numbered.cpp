// "The third door on the right" in things, owners, relations, orders and questions: the place of
// the map that it means is told; where it is not sure, nothing is taken down.
#include <gtest/gtest.h>

#include "example.hpp"

using namespace hyselam_conversation;  // NOLINT: a test, not a header

namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Of the places of all things.
std::string placesOfThings(const Conversation& talk) {
  std::string all;
  for (const auto& object : talk.objects().objects) {
    const auto* place = talk.objects().findPlace(talk.objects().placeOf(object.id));
    all += object.kind + " " + (place == nullptr ? "?" : place->name) + "; ";
  }
  return all;
}

TEST(Numbered, ThingsAreInThePlaceOfTheMap) {
  for (const auto& [said, told] :
       {std::pair("There is a bicycle in the third room on the right.", "bicycle SS03; "),
        std::pair("The umbrella is in the last office on the right.", "umbrella SS09; "),
        std::pair("A bicicleta está na terceira sala à direita.", "bicicleta SS03; ")}) {
    ExampleTalk example;
    example.talk.say(has(said, "bicicleta") ? "Estás no corredor." : "You are in the corridor.");
    const Exchange exchange = example.talk.say(said);
    EXPECT_EQ(placesOfThings(example.talk), told) << exchange.replyText();
    EXPECT_TRUE(has(exchange.replyText(), has(said, "last") ? "SS09" : "SS03"))
        << exchange.replyText();
  }
}

/// Things told to be in SS09 are in the archive once that is its name.
TEST(Numbered, ThingsAreInThePlaceThatIsNamedLater) {
  ExampleTalk example;
  example.talk.say("You are in the corridor.");
  example.talk.say("There is a bicycle in the last room on the right.");
  ASSERT_EQ(placesOfThings(example.talk), "bicycle SS09; ");
  const Exchange named = example.talk.say("SS09 is the archive.");
  EXPECT_EQ(placesOfThings(example.talk), "bicycle archive; ") << named.replyText();
}

TEST(Numbered, WhatIsCalledSoIsMeant) {
  ExampleTalk example;
  example.talk.say("You are in the corridor. The third door on the right is the archive.");
  const Exchange thing = example.talk.say("There is a bicycle in the third room on the right.");
  EXPECT_EQ(placesOfThings(example.talk), "bicycle archive; ") << thing.replyText();
  const Exchange fact = example.talk.say("The pantry is opposite the third door on the right.");
  EXPECT_TRUE(has(fact.replyText(), "The pantry is opposite the archive.")) << fact.replyText();
}

TEST(Numbered, WhatIsToldOfItIsOfTheNameToldLater) {
  ExampleTalk example;
  example.talk.say("You are in the corridor.");
  const Exchange fact = example.talk.say("The pantry is opposite the last door on the right.");
  EXPECT_TRUE(has(fact.question, "SS09")) << fact.replyText();
  example.talk.say("Yes.");
  example.talk.say("The last door on the right is the archive.");
  const Exchange asked = example.talk.say("What is opposite the archive?");
  EXPECT_TRUE(has(asked.replyText(), "pantry")) << asked.replyText();
}

TEST(Numbered, OrdersAndQuestionsMeanThePlaceOfTheMap) {
  ExampleTalk example;
  const Exchange asked = example.talk.say("Go to the last door on the right.");
  EXPECT_FALSE(asked.goal.has_value()) << asked.replyText();
  const Exchange going = example.talk.say("Yes.");
  ASSERT_TRUE(going.goal.has_value()) << going.replyText();
  EXPECT_EQ(*going.goal, 9u);
  ExampleTalk other;
  const Exchange size = other.talk.say("How big is the last room on the right?");
  EXPECT_TRUE(has(size.replyText(), "SS09")) << size.replyText();
}

TEST(Numbered, WhatIsNotSureIsNotTakenDown) {
  ExampleTalk example;
  example.talk.say("You are in the corridor.");
  const Exchange fact = example.talk.say("The pantry is opposite the tenth door on the right.");
  EXPECT_TRUE(fact.understood.empty()) << fact.replyText();
  EXPECT_TRUE(has(fact.replyText(), "tenth door on the right")) << fact.replyText();
  const Exchange going = example.talk.say("Go to the tenth door on the right.");
  EXPECT_FALSE(going.goal.has_value()) << going.replyText();
  // Led about in thought, it sees other sides than it does.
  ExampleTalk led;
  const Exchange there = led.talk.say(
      "You are in the corridor. On your left is the kitchen. Now you are in the kitchen. The "
      "pantry "
      "is opposite the last door on the right.");
  EXPECT_FALSE(has(there.replyText(), "SS09")) << there.replyText();
}

/// What it may be is asked, one after the other.
TEST(Numbered, WhatMayBeSeveralIsAsked) {
  ExampleTalk example;
  example.talk.say("You are in the corridor.");
  const Exchange asked = example.talk.say("The pantry is opposite the third door on the right.");
  EXPECT_TRUE(has(asked.question, "The pantry is opposite SS03")) << asked.replyText();
  EXPECT_TRUE(asked.understood.empty());
  const Exchange other = example.talk.say("No.");
  EXPECT_TRUE(has(other.question, "The pantry is opposite SS04")) << other.replyText();
  const Exchange taken = example.talk.say("Yes.");
  EXPECT_TRUE(has(taken.replyText(), "The pantry is opposite SS04.")) << taken.replyText();
}

}  // namespace
