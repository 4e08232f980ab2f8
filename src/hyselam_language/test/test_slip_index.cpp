// Words one slip of the pen away, against looking at all of them (the oracle).
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "grammar/slip_index.hpp"
#include "hyselam_common/edit_distance.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Few letters, so that many words are near one another.
std::string randomWord(std::mt19937* random) {
  const std::size_t length = (*random)() % 7;
  std::string word;
  for (std::size_t i = 0; i < length; ++i) word += static_cast<char>('a' + (*random)() % 3);
  return word;
}

TEST(SlipIndex, FindsWhatLookingAtAllWordsFinds) {
  std::mt19937 random(5);
  std::size_t found = 0;
  for (int round = 0; round < 50; ++round) {
    SlipIndex index;
    std::vector<std::string> words;
    for (int i = 0; i < 40; ++i) {
      words.push_back(randomWord(&random));
      index.add(words.back(), i);
    }
    for (int i = 0; i < 40; ++i) {
      const std::string said = randomWord(&random);
      std::vector<int> near;
      for (std::size_t w = 0; w < words.size(); ++w) {
        if (hyselam::isOneEditApart(said, words[w])) near.push_back(static_cast<int>(w));
      }
      ASSERT_EQ(index.near(said), near) << "'" << said << "'";
      ASSERT_EQ(index.hasNear(said), !near.empty()) << "'" << said << "'";
      found += near.size();
    }
  }
  EXPECT_GT(found, 1000u);
}

TEST(SlipIndex, KnowsLettersLeftOutAddedChangedAndExchanged) {
  SlipIndex index;
  index.add("corridor", 3);
  for (const char* said : {"coridor", "corrridor", "corridar", "corrdior"}) {
    EXPECT_EQ(index.near(said), std::vector<int>{3}) << said;
  }
  for (const char* said : {"corridor", "coridar", ""}) EXPECT_FALSE(index.hasNear(said)) << said;
}

}  // namespace
}  // namespace language
}  // namespace hyselam_topo
