// The matcher against Alg. 5.3 written down plainly, against the table of all pairs, and on the
// thesis' worked example.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/matching/ngram.hpp"
#include "ngram_slam/matching/ngram_matcher.hpp"
#include "random_matchers.hpp"
#include "random_texts.hpp"
#include "transcription/matching.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::radians;
using random_texts::randomParams;

namespace {

/// Fig. 4.9: 47 segments, 10 types of words. Types of the segments follow from the listed matches,
/// from the text (20 and 34 are one corner in both directions) and from what must not match:
/// the segments 14, 21, 32 and 33 are the only choice that adds no 2-gram to the list.
const std::vector<int>& segments() {
  static const std::vector<int> types = {6,  2, 8, 5, 8,  5, 7, 2, 9, 2, 7, 4, 6, 3, 8, 5,
                                         8,  3, 6, 1, 10, 3, 6, 5, 6, 4, 7, 2, 9, 2, 7, 5,
                                         10, 2, 6, 5, 6,  2, 8, 5, 8, 4, 6, 4, 8, 5, 8};
  return types;
}

/// Turning left and right at corners (1, 2) and bifurcations (3, 4), straight on at bifurcations
/// (5), corridors of five lengths (6 .. 10).
Syllables wordOfType(int type) {
  const float quarter = static_cast<float>(radians(90));
  switch (type) {
    case 1:
      return {1, 30, quarter};
    case 2:
      return {1, 30, -quarter};
    case 3:
      return {2, 30, quarter};
    case 4:
      return {2, 30, -quarter};
    case 5:
      return {2, 30, 0.0f};
    default:
      return {0, 20u << (type - 6), 0.0f};
  }
}

struct FoundGrams {
  std::size_t pairs = 0;                                    // "total matches"
  std::map<std::vector<int>, std::set<std::size_t>> types;  // words -> last segments, from 1
};

FoundGrams gramsOf(int n) {
  WordLattice text(1);
  NgramMatcherParams params;
  params.min_n = {n};
  NgramMatcher matcher(text, params);
  FoundGrams found;
  for (std::size_t i = 0; i < segments().size(); ++i) {
    text.push(wordOfType(segments()[i]));
    for (const NgramMatch& m : matcher.update()) {
      ++found.pairs;
      const std::vector<int> words(segments().begin() + static_cast<std::ptrdiff_t>(i + 1) - n,
                                   segments().begin() + static_cast<std::ptrdiff_t>(i + 1));
      found.types[words].insert(i + 1);
      found.types[words].insert(text.last(m.older) + 1);
    }
  }
  return found;
}

using Table = std::map<std::vector<int>, std::set<std::size_t>>;

/// Every pair with the lowest pass that accepts it and its longest n-gram there.
std::map<std::pair<WordIndex, WordIndex>, std::pair<int, int>> byPair(
    const std::vector<NgramMatch>& m) {
  std::map<std::pair<WordIndex, WordIndex>, std::pair<int, int>> out;
  for (const NgramMatch& x : m) {
    EXPECT_TRUE(out.emplace(std::make_pair(x.newer, x.older), std::make_pair(x.levels, x.n)).second)
        << "told twice";
  }
  return out;
}

}  // namespace

TEST(WorkedExample, hasTheTwoGramsOfTheThesis) {
  const FoundGrams found = gramsOf(2);
  EXPECT_EQ(found.pairs, 27u);
  EXPECT_EQ(found.types, (Table{{{6, 2}, {2, 38}},
                                {{2, 8}, {3, 39}},
                                {{8, 5}, {4, 6, 16, 40, 46}},
                                {{5, 8}, {5, 17, 41, 47}},
                                {{7, 2}, {8, 28}},
                                {{2, 9}, {9, 29}},
                                {{9, 2}, {10, 30}},
                                {{2, 7}, {11, 31}},
                                {{4, 6}, {13, 43}},
                                {{3, 6}, {19, 23}},
                                {{6, 5}, {24, 36}},
                                {{5, 6}, {25, 37}},
                                {{6, 4}, {26, 44}}}));
}

TEST(WorkedExample, hasTheThreeGramsOfTheThesis) {
  const FoundGrams found = gramsOf(3);
  EXPECT_EQ(found.pairs, 12u);
  EXPECT_EQ(found.types, (Table{{{6, 2, 8}, {3, 39}},
                                {{2, 8, 5}, {4, 40}},
                                {{8, 5, 8}, {5, 17, 41, 47}},
                                {{7, 2, 9}, {9, 29}},
                                {{2, 9, 2}, {10, 30}},
                                {{9, 2, 7}, {11, 31}},
                                {{6, 5, 6}, {25, 37}}}));
}

TEST(WorkedExample, hasTheFourAndFiveGramsOfTheThesisAndNoLonger) {
  const FoundGrams four = gramsOf(4);
  EXPECT_EQ(four.pairs, 4u);
  EXPECT_EQ(four.types, (Table{{{6, 2, 8, 5}, {4, 40}},
                               {{2, 8, 5, 8}, {5, 41}},
                               {{7, 2, 9, 2}, {10, 30}},
                               {{2, 9, 2, 7}, {11, 31}}}));
  const FoundGrams five = gramsOf(5);
  EXPECT_EQ(five.pairs, 2u);
  EXPECT_EQ(five.types, (Table{{{6, 2, 8, 5, 8}, {5, 41}}, {{7, 2, 9, 2, 7}, {11, 31}}}));
  EXPECT_EQ(gramsOf(6).pairs, 0u);
}

TEST(NgramMatcher, equalsTheTableOfAllPairsOnRandomTexts) {
  constexpr int kRounds = 10000;
  std::size_t accepted = 0, beyond_real = 0, across_levels = 0;
  for (int round = 0; round < kRounds; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    hyselam::Rng rng(53, static_cast<std::uint64_t>(round));
    const int levels = 1 + static_cast<int>(rng.below(4));
    const NgramMatcherParams params = randomParams(rng, levels);
    WordLattice text(levels);
    NgramMatcher matcher(text, params);
    // Word by word in one text out of two, else several at once.
    const bool one_by_one = rng.below(2) == 0;
    WordLattice whole(levels);
    random_texts::write(whole, 20 + rng.below(60), rng);
    const auto found = random_texts::matchesOf(whole, one_by_one, rng, text, matcher);
    ASSERT_EQ(text.words(), whole.words());

    const auto words = transcription::plainWords(text);
    const auto expected =
        random_texts::matchedPairs<transcription::AllPairs>(words, levels, params);
    ASSERT_EQ(byPair(found), expected);
    accepted += expected.size();
    for (const auto& [pair, how] : expected) {
      beyond_real += how.first > 1;
      across_levels += words[pair.second].level > 0;
    }
  }
  // The texts do put every branch to the test.
  EXPECT_GT(accepted, 100000u);
  EXPECT_GT(beyond_real, 10000u);
  EXPECT_GT(across_levels, 5000u);
}

TEST(NgramMatcher, equalsAlgorithm53OnRandomTexts) {
  constexpr int kRounds = 10000;
  std::size_t grams = 0, mixed = 0;
  for (int round = 0; round < kRounds; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    hyselam::Rng rng(54, static_cast<std::uint64_t>(round));
    const int levels = 1 + static_cast<int>(rng.below(3));
    const NgramMatcherParams params = randomParams(rng, levels);
    WordLattice text(levels);
    NgramMatcher matcher(text, params);
    random_texts::write(text, 8 + rng.below(20), rng);
    // Only the newest word: the words before are context.
    const WordIndex newest = text.realWord(text.positions() - 1);
    std::map<std::pair<WordIndex, WordIndex>, std::pair<int, int>> found;
    for (const NgramMatch& m : matcher.update()) {
      if (m.newer == newest) found[{m.newer, m.older}] = {m.levels, m.n};
    }

    const auto words = transcription::plainWords(text);
    std::map<std::pair<WordIndex, WordIndex>, std::pair<int, int>> expected;
    for (int k = 1; k <= levels; ++k) {
      const auto min_n = static_cast<std::size_t>(params.min_n[static_cast<std::size_t>(k - 1)]);
      const auto all = transcription::findMatches(words, newest, k, min_n, params.tolerance);
      std::map<WordIndex, int> longest;
      for (const auto& g : all) {
        int& n = longest[static_cast<WordIndex>(g.back().second)];
        n = std::max(n, static_cast<int>(g.size()));
      }
      for (const auto& [older, n] : longest) {
        expected.emplace(std::make_pair(newest, older), std::make_pair(k, n));
      }

      // The words of the matches, asked for one by one, are the same set.
      std::set<std::vector<std::pair<std::size_t, std::size_t>>> listed;
      for (const auto& [older, n] : longest) {
        forEachMaximalNgram(text, params.tolerance, {newest, older}, k,
                            [&](const std::vector<WordPair>& pairs) {
                              std::vector<std::pair<std::size_t, std::size_t>> g;
                              for (const WordPair& p : pairs) g.push_back({p.newer, p.older});
                              if (g.size() >= min_n) listed.insert(g);
                              for (const auto& p : g) {
                                mixed += text.level(static_cast<WordIndex>(p.first)) !=
                                         text.level(static_cast<WordIndex>(p.second));
                              }
                              return true;
                            });
        const auto chain = longestNgram(text, params.tolerance, {newest, older}, k);
        ASSERT_EQ(static_cast<int>(chain.size()), n);
        std::vector<std::pair<std::size_t, std::size_t>> g;
        for (const WordPair& p : chain) g.push_back({p.newer, p.older});
        ASSERT_EQ(all.count(g), 1u);
      }
      ASSERT_EQ(listed, all);
      grams += all.size();
    }
    ASSERT_EQ(found, expected);
  }
  EXPECT_GT(grams, 10000u);
  EXPECT_GT(mixed, 1000u);
}

TEST(NgramMatcher, keepsRunsApart) {
  WordLattice text(1);
  NgramMatcherParams params;
  params.min_n = {3};
  NgramMatcher matcher(text, params);
  const auto write = [&](std::vector<int> types) {
    std::size_t matches = 0;
    for (int t : types) {
      text.push(wordOfType(t));
      matches = matcher.update().size();
    }
    return matches;
  };
  write({6, 2, 8, 5, 9});
  text.startRun();
  EXPECT_EQ(write({2, 8, 5}), 1u);  // seen in the first run
  text.startRun();
  EXPECT_EQ(write({9, 2, 8}), 0u);  // in no run: 9 ends one, 2 8 begins another
  text.startRun();
  EXPECT_EQ(write({8, 5}), 0u);  // the newest run is too short by itself
}

TEST(NgramMatcher, recognizesARegionBehindADoorThatIsNowOpen) {
  // Fig. 5.1: a corridor is one word; with a door open it is three. Level 1 sees through it.
  const std::vector<Syllables> tail = {{1, 30, 0.0f}, {2, 55, 0.0f}, {1, 31, 1.5f}};
  WordLattice text(2);
  NgramMatcherParams params;
  params.min_n = {6, 6};
  NgramMatcher matcher(text, params);
  const auto push = [&](Syllables s) {
    text.push(s);
    return matcher.update();
  };
  push({3, 80, 0.0f});
  push({0, 100, 0.0f});
  for (const auto& w : tail) push(w);
  push({4, 12, 0.0f});
  text.startRun();
  push({3, 82, 0.0f});
  push({0, 40, 0.0f});
  push({2, 9, 0.0f});  // the open door
  push({0, 52, 0.0f});
  for (const auto& w : tail) EXPECT_TRUE(push(w).empty());
  const auto found = push({4, 12, 0.0f});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].levels, 2);
  EXPECT_EQ(found[0].n, 6);
  const auto chain = longestNgram(text, params.tolerance, {found[0].newer, found[0].older}, 2);
  ASSERT_EQ(chain.size(), 6u);
  EXPECT_EQ(text.level(chain[1].newer), 1);
  EXPECT_EQ(text.level(chain[1].older), 0);
}

TEST(NgramMatcher, skippedRunsCanBeMatchedLater) {
  hyselam::Rng rng(8);
  for (int round = 0; round < 200; ++round) {
    WordLattice text(3);
    NgramMatcherParams params;
    params.min_n = {3, 4, 5};
    params.index_bits = 12;
    NgramMatcher all(text, params), late(text, params);
    random_texts::write(text, 60, rng);
    late.skip();
    text.startRun();
    const Position begin = text.positions();
    random_texts::write(text, 40, rng);
    std::vector<NgramMatch> expected;
    for (const NgramMatch& m : all.update()) {
      if (text.last(m.newer) >= begin) expected.push_back(m);
    }
    ASSERT_EQ(byPair(late.update()), byPair(expected));
  }
}

TEST(NgramMatcher, doesNotCompareWordsThatCannotContinueAGram) {
  // Words of 60 kinds in random order: grams of 7 words never come back by chance.
  const auto comparisonsPerWord = [](std::size_t positions) {
    hyselam::Rng rng(1);
    WordLattice text(1);
    NgramMatcherParams params;
    params.min_n = {7};
    NgramMatcher matcher(text, params);
    std::uint64_t before = 0;
    for (std::size_t i = 0; i < positions; ++i) {
      if (i + 1000 == positions) before = matcher.counters().comparisons;
      text.push({static_cast<int>(i % 2 * 10 + rng.below(6)), 4u << (2 * rng.below(5)), 0.0f});
      matcher.update();
    }
    return static_cast<double>(matcher.counters().comparisons - before) / 1000.0;
  };
  // 1 in 30 words matches: a scan of 30,000 words needs 30,000 comparisons for a word.
  EXPECT_LT(comparisonsPerWord(30000), 30.0);
}

TEST(NgramMatcher, followsTheNewestPlacesOfTooMany) {
  // A circuit of eight words, 200 laps: with every lap one more place matches.
  WordLattice text(2);
  NgramMatcherParams params;
  params.min_n = {4, 5};
  params.index_bits = 12;
  NgramMatcher all(text, params);
  params.max_followed = 20;
  NgramMatcher few(text, params);
  for (int i = 0; i < 1600; ++i) {
    text.push({i % 8 / 2, 10u << i % 8 / 2, i % 2 == 0 ? 0.0f : 1.5f});
    auto complete = byPair(all.update());
    const auto newest = byPair(few.update());
    ASSERT_EQ(newest.size(), std::min<std::size_t>(complete.size(), 20));
    while (complete.size() > 20) complete.erase(complete.begin());
    ASSERT_EQ(newest, complete) << i;
  }
}

TEST(NgramMatcher, isExactBelowMaxFollowed) {
  // The same texts with room for few grams and with room for all.
  std::size_t complete_texts = 0, short_texts = 0;
  for (std::uint64_t round = 0; round < 2000; ++round) {
    hyselam::Rng rng(55, round);
    WordLattice text(3);
    NgramMatcherParams params = randomParams(rng, 3);
    NgramMatcher all(text, params);
    params.max_followed = 1 + static_cast<int>(rng.below(12));
    NgramMatcher few(text, params);
    NgramMatcher again(text, params);
    random_texts::write(text, 60, rng);
    const auto whole = byPair(all.update()), part = byPair(few.update());
    ASSERT_EQ(byPair(again.update()), part);
    for (const auto& [pair, how] : part) {
      const auto found = whole.find(pair);
      ASSERT_NE(found, whole.end());
      ASSERT_GE(how.first, found->second.first);  // never with fewer levels
      if (how.first == found->second.first) {
        ASSERT_LE(how.second, found->second.second);
      }
    }
    ++(part == whole ? complete_texts : short_texts);
  }
  EXPECT_GT(complete_texts, 100u);
  EXPECT_GT(short_texts, 100u);
}

TEST(NgramMatcher, refusesParametersOutOfRange) {
  const auto messageFor = [](const std::function<void(NgramMatcherParams&)>& change,
                             int levels = 3) {
    NgramMatcherParams p;
    change(p);
    const WordLattice text(levels);
    return hyselam::testing::messageOf<hyselam::ParameterError>([&] { NgramMatcher m(text, p); });
  };
  EXPECT_EQ(messageFor([](NgramMatcherParams&) {}), "");
  EXPECT_NE(messageFor([](NgramMatcherParams&) {}, 2).find("min_n"), std::string::npos);
  EXPECT_NE(messageFor([](NgramMatcherParams& p) { p.min_n[1] = 0; }).find("min_n"),
            std::string::npos);
  EXPECT_NE(messageFor([](NgramMatcherParams& p) { p.tolerance.size = 1.0; }).find("size"),
            std::string::npos);
  EXPECT_NE(messageFor([](NgramMatcherParams& p) { p.tolerance.angle = 0.0; }).find("angle"),
            std::string::npos);
  EXPECT_NE(messageFor([](NgramMatcherParams& p) { p.index_gram = 0; }).find("index_gram"),
            std::string::npos);
  EXPECT_NE(messageFor([](NgramMatcherParams& p) { p.max_followed = 0; }).find("max_followed"),
            std::string::npos);
  EXPECT_NE(messageFor([](NgramMatcherParams& p) { p.index_bits = 40; }).find("index_bits"),
            std::string::npos);
}
