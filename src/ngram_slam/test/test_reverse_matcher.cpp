// The reverse matcher against the table of all pairs, and what it is for.
#include <gtest/gtest.h>

#include <map>

#include "ngram_slam/matching/ngram.hpp"
#include "ngram_slam/matching/reverse_ngram_matcher.hpp"
#include "random_matchers.hpp"
#include "random_texts.hpp"
#include "transcription/matching.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using random_texts::randomParams;

namespace {

/// The longest reverse n-gram of every pair of words: the newer ones read forwards, the older ones
/// backwards, with their turns turned round.
class AllReversePairs {
 public:
  AllReversePairs(const std::vector<transcription::PlainWord>& words, int levels,
                  const WordTolerance& tolerance)
      : n_(words.size()), length_(n_ * n_, 0) {
    std::vector<std::vector<std::size_t>> after(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t p : words[i].P) after[p].push_back(i);
    }
    for (std::size_t a = 0; a < n_; ++a) {
      for (std::size_t b = a; b-- > 0;) {
        if (words[a].level >= levels || words[b].level >= levels) continue;
        transcription::PlainWord turned = words[b];
        turned.s.angle = -turned.s.angle;
        if (words[b].last >= words[a].first || !transcription::equal(words[a], turned, tolerance)) {
          continue;
        }
        int longest = 0;
        for (std::size_t p : words[a].P) {
          for (std::size_t q : after[b]) longest = std::max(longest, at(p, q));
        }
        length_[a * n_ + b] = longest + 1;
      }
    }
  }
  int at(std::size_t newer, std::size_t older) const { return length_[newer * n_ + older]; }

 private:
  std::size_t n_;
  std::vector<int> length_;
};

/// A random text with stretches that come back the other way, into `text`.
void writeBothWays(WordLattice& text, std::size_t positions, hyselam::Rng& rng) {
  WordLattice source(1);
  random_texts::write(source, positions, rng);
  std::vector<Syllables> real;
  for (Position p = 0; p < source.positions(); ++p) {
    if (source.startsRun(p)) text.startRun();
    real.push_back(source.syllables(source.realWord(p)));
    text.push(real.back());
    if (rng.below(8) != 0) continue;
    // Some way back, from here or from anywhere.
    std::size_t from =
        rng.below(3) == 0 ? real.size() - 1 : rng.below(static_cast<std::uint32_t>(real.size()));
    const std::size_t count = 2 + rng.below(10);
    for (std::size_t k = 0; k < count && k <= from && text.positions() < 2 * positions; ++k) {
      text.push(random_texts::noisy(reversed(real[from - k]), rng, 0.15, 0.3));
    }
  }
}

}  // namespace

TEST(ReversedWord, twiceIsTheSame) {
  for (float angle : {0.0f, 1.5f, -3.0f, static_cast<float>(hyselam::kPi)}) {
    const Syllables w{3, 17, angle};
    EXPECT_EQ(reversed(reversed(w)).angle, angle);
    EXPECT_EQ(reversed(w).size, 17u);
    EXPECT_EQ(reversed(w).density_class, 3);
  }
  EXPECT_EQ(reversed({0, 1, 1.5f}).angle, -1.5f);
}

TEST(ReversedWord, hasTheAngleOfTheReversePath) {
  hyselam::Rng rng(3);
  for (int round = 0; round < 1000; ++round) {
    const auto pose = [&] {
      return hyselam::Pose2{rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-3, 3)};
    };
    const hyselam::Pose2 a = pose(), b = pose(), c = pose();
    const double there = angleVariation(a, b, c);
    const double back = angleVariation(c, b, a);
    EXPECT_NEAR(hyselam::normalizeAngle(there + back), 0.0, 1e-9);
  }
}

TEST(ReverseNgramMatcher, equalsTheTableOfAllPairsOnRandomTexts) {
  std::size_t accepted = 0, beyond_real = 0, across_levels = 0, long_ones = 0;
  for (int round = 0; round < 10000; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    hyselam::Rng rng(61, static_cast<std::uint64_t>(round));
    const int levels = 1 + static_cast<int>(rng.below(4));
    const NgramMatcherParams params = randomParams(rng, levels);
    WordLattice whole(levels), text(levels);
    writeBothWays(whole, 8 + rng.below(20), rng);
    ReverseNgramMatcher matcher(text, params);
    const bool one_by_one = rng.below(2) == 0;
    const auto found = random_texts::matchesOf(whole, one_by_one, rng, text, matcher);
    random_texts::MatchedPairs got;
    for (const NgramMatch& m : found) {
      ASSERT_EQ(m.direction, Direction::kReverse);
      ASSERT_TRUE(
          got.emplace(std::make_pair(m.newer, m.older), std::make_pair(m.levels, m.n)).second)
          << "told twice";
    }
    const auto words = transcription::plainWords(text);
    const auto expected = random_texts::matchedPairs<AllReversePairs>(words, levels, params);
    ASSERT_EQ(got, expected);
    for (const auto& [pair, how] : expected) {
      const auto chain = longestNgram(text, params.tolerance, {pair.first, pair.second}, how.first,
                                      1000, Direction::kReverse);
      ASSERT_EQ(static_cast<int>(chain.size()), how.second);
      for (std::size_t i = 1; i < chain.size(); ++i) {
        ASSERT_EQ(text.last(chain[i - 1].newer) + 1, text.first(chain[i].newer));
        ASSERT_EQ(text.last(chain[i].older) + 1, text.first(chain[i - 1].older));
      }
      beyond_real += how.first > 1;
      across_levels += words[pair.second].level > 0;
      long_ones += how.second > 5;
    }
    accepted += expected.size();
  }
  // The texts do put every branch to the test.
  EXPECT_GT(accepted, 50000u);
  EXPECT_GT(beyond_real, 2500u);
  EXPECT_GT(across_levels, 700u);
  EXPECT_GT(long_ones, 3000u);
}

TEST(ReverseNgramMatcher, recognizesThePathBackOutOfADeadEnd) {
  const std::vector<Syllables> way = {{0, 100, 0.0f}, {1, 30, 1.5f},  {0, 60, 0.0f}, {2, 25, 0.0f},
                                      {0, 80, 0.0f},  {1, 31, -1.5f}, {3, 40, 0.0f}};
  WordLattice text(1);
  NgramMatcherParams params;
  params.min_n = {4};
  ReverseNgramMatcher matcher(text, params);
  for (const auto& w : way) {
    text.push(w);
    EXPECT_TRUE(matcher.update().empty());
  }
  text.push({4, 20, 3.1f});  // turns round
  std::size_t told = 0;
  for (std::size_t i = way.size(); i-- > 0;) {
    text.push(reversed(way[i]));
    for (const NgramMatch& m : matcher.update()) {
      ++told;
      EXPECT_EQ(text.last(m.older), i);
      EXPECT_EQ(m.n, static_cast<int>(way.size() - i));
    }
  }
  EXPECT_EQ(told, 4u);  // from the fourth word on
}

TEST(ReverseNgramMatcher, skippedRunsCanBeMatchedLater) {
  hyselam::Rng rng(9);
  std::size_t compared = 0;
  for (int round = 0; round < 200; ++round) {
    WordLattice text(3);
    NgramMatcherParams params;
    params.min_n = {3, 4, 5};
    params.index_bits = 12;
    ReverseNgramMatcher all(text, params), late(text, params);
    writeBothWays(text, 40, rng);
    late.skip();
    text.startRun();
    const Position begin = text.positions();
    writeBothWays(text, 30, rng);
    random_texts::MatchedPairs expected, got;
    for (const NgramMatch& m : all.update()) {
      if (text.last(m.newer) >= begin) expected[{m.newer, m.older}] = {m.levels, m.n};
    }
    for (const NgramMatch& m : late.update()) got[{m.newer, m.older}] = {m.levels, m.n};
    ASSERT_EQ(got, expected);
    compared += got.size();
  }
  EXPECT_GT(compared, 500u);
}
