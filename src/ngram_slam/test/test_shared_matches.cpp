// Observations of one place by the matches that they share.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/matching/shared_matches.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header

namespace {

constexpr int kRegion = 40;   // observations
constexpr int kRegions = 12;  // of a lap

/// Rounds of a building with regions of these classes, straight on; each is a run of its own.
struct Rounds {
  NgramRecognizer recognizer;
  std::vector<NgramMatch> matches;

  static NgramRecognizerParams params() {
    NgramRecognizerParams p;
    p.levels = 1;
    p.matcher.min_n = {3};
    p.with_probability = true;
    return p;
  }
  explicit Rounds(const std::vector<std::vector<int>>& rounds) : recognizer(params()) {
    for (const auto& classes : rounds) {
      int i = 0;
      for (const int c : classes) {
        for (int k = 0; k < kRegion; ++k, ++i) {
          DensityObservation o;
          o.stamp = 0.1 * i;
          o.base_in_odom = {0.1 * i, 0.0, 0.0};
          o.soft = 0.125 * c + 0.06;
          take(recognizer.add(o));
        }
      }
      take(recognizer.endRun());
    }
  }
  void take(const NgramRecognizerUpdate& update) {
    matches.insert(matches.end(), update.matches.begin(), update.matches.end());
  }
  /// A match of the words that end with those of two rounds, sure as told.
  NgramMatch match(int newer_round, int older_round, int region, double probability, int n = 3) {
    NgramMatch m;
    const auto& runs = recognizer.text().runs();
    const auto word = [&](int round) {
      return recognizer.text().realWord(runs[static_cast<std::size_t>(round)] +
                                        static_cast<Position>(region));
    };
    m.newer = word(newer_round);
    m.older = word(older_round);
    m.n = n;
    m.probability = probability;
    return m;
  }
};

std::vector<int> round() {
  return {1, 4, 2, 6, 3, 5, 1, 7, 2, 5, 3, 6};
}

/// The similarity of the observations in the middle of a region in two rounds; 0 if not told.
double similarity(const std::vector<SimilarObservations>& pairs, int newer_round, int older_round,
                  int region, int region_before) {
  const std::uint32_t length = kRegion * kRegions;
  const auto newer = static_cast<std::uint32_t>(newer_round) * length +
                     kRegion * static_cast<std::uint32_t>(region) + kRegion / 2;
  const auto older = static_cast<std::uint32_t>(older_round) * length +
                     kRegion * static_cast<std::uint32_t>(region_before) + kRegion / 2;
  for (const SimilarObservations& p : pairs) {
    if (p.direction == Direction::kSame && p.newer <= newer && newer < p.newer + p.count &&
        p.older + (newer - p.newer) == older) {
      return p.similarity;
    }
  }
  return 0.0;
}

}  // namespace

TEST(SharedMatches, aPassThatWasMatchedWithAnotherIsAlsoWhereThatOneWas) {
  Rounds rounds({round(), round(), round()});
  const auto pairs = SharedMatches(rounds.recognizer)
                         .of({rounds.match(1, 0, 5, 0.95), rounds.match(2, 1, 5, 0.95)});
  EXPECT_GT(similarity(pairs, 1, 0, 5, 5), 0.1);
  EXPECT_GT(similarity(pairs, 2, 1, 5, 5), 0.1);
  EXPECT_GT(similarity(pairs, 2, 0, 5, 5), 0.1) << "never matched themselves";
}

TEST(SharedMatches, aMatchGoesOnBeyondItsWordsWhileDensitiesAgree) {
  std::vector<int> other = round();
  other[9] = 1;  // beside 5: something was changed there
  Rounds rounds({round(), other});
  const auto pairs = SharedMatches(rounds.recognizer).of({rounds.match(1, 0, 5, 0.95)});
  for (const int region : {0, 3, 5, 8})
    EXPECT_GT(similarity(pairs, 1, 0, region, region), 0.1) << region;
  EXPECT_EQ(similarity(pairs, 1, 0, 9, 9), 0.0);
  EXPECT_EQ(similarity(pairs, 1, 0, 11, 11), 0.0);
}

TEST(SharedMatches, aMatchThatNobodySharesIsLessThanThoseThatAgree) {
  // Two halls of a building are alike. Once a pass of one is taken for the other.
  std::vector<int> twice = {1, 4, 2, 6, 3, 5, 1, 4, 2, 6, 3, 5};
  Rounds rounds({twice, twice, twice, twice, twice});
  std::vector<NgramMatch> matches;
  for (int newer = 1; newer < 5; ++newer) {
    for (int older = 0; older < newer; ++older)
      matches.push_back(rounds.match(newer, older, 4, 0.9));
  }
  NgramMatch wrong = rounds.match(4, 0, 4, 0.9);
  wrong.older = rounds.match(4, 0, 10, 0.9).older;
  matches.push_back(wrong);
  const auto pairs = SharedMatches(rounds.recognizer).of(matches);
  EXPECT_GT(similarity(pairs, 4, 0, 4, 4), 2.0 * similarity(pairs, 4, 0, 4, 10));
  EXPECT_GT(similarity(pairs, 4, 0, 4, 10), 0.0);
}

TEST(SharedMatches, areOfOnePlaceAlsoWhereTheWayWasGoneBack) {
  std::vector<int> back = round();
  std::reverse(back.begin(), back.end());
  Rounds rounds({round(), back, round()});
  // Of twelve regions the sixth is the seventh from the other end. In reverse the older words of a
  // match begin with the one that is told.
  const NgramMatch sixth = rounds.match(1, 0, 5, 0.95);
  NgramMatch there = rounds.match(1, 0, 6, 0.95), again = rounds.match(2, 1, 5, 0.95);
  there.older = sixth.older;
  again.older = there.newer;
  there.direction = again.direction = Direction::kReverse;
  const auto pairs = SharedMatches(rounds.recognizer).of({there, again});
  const bool reversed = std::any_of(pairs.begin(), pairs.end(), [](const SimilarObservations& p) {
    return p.direction == Direction::kReverse;
  });
  EXPECT_TRUE(reversed);
  EXPECT_GT(similarity(pairs, 2, 0, 5, 5), 0.1);
}

TEST(SharedMatches, isTheCosineOfRowsOfTheGraphOfMatches) {
  // Without carrying on, and each region a cell: the links are the matches' words.
  Rounds rounds({round(), round(), round(), round()});
  SharedMatchesParams params;
  params.cell = kRegion;
  params.max_drop = 0.0;
  params.min_similarity = 0.01;
  params.angle_scale = 1e-9;
  params.density_scale = 1e-9;
  const double pa = 0.9, pb = 0.6, pc = 0.3;
  const auto pairs =
      SharedMatches(rounds.recognizer, params)
          .of({rounds.match(1, 0, 5, pa), rounds.match(2, 1, 5, pb), rounds.match(3, 1, 5, pc)});
  const auto weight = [](double p) { return -std::log(1.001 - p); };
  // Cells before the third round's: 0 is linked with 1, 1 with 0, the third with 1.
  EXPECT_NEAR(similarity(pairs, 2, 0, 5, 5),
              weight(pa * pb) / std::sqrt((5 + weight(pb)) * (5 + weight(pa))), 1e-4);
  EXPECT_NEAR(similarity(pairs, 2, 1, 5, 5),
              weight(pb) / std::sqrt((5 + weight(pb)) * (5 + weight(pa))), 1e-4);
  // Before the fourth round's, the second one's link with the third counts, too.
  EXPECT_NEAR(similarity(pairs, 3, 1, 5, 5),
              weight(pc) / std::sqrt((5 + weight(pc)) * (5 + weight(pa) + weight(pb))), 1e-4);
}

TEST(SharedMatches, theOrderOfTheMatchesDoesNotMatterAndNothingIsToldOfNone) {
  Rounds rounds({round(), round(), round(), round()});
  ASSERT_FALSE(rounds.matches.empty());
  std::vector<NgramMatch> other = rounds.matches;
  std::reverse(other.begin(), other.end());
  const SharedMatches shared(rounds.recognizer);
  const auto a = shared.of(rounds.matches), b = shared.of(other);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].newer, b[i].newer);
    EXPECT_EQ(a[i].older, b[i].older);
    EXPECT_EQ(a[i].similarity, b[i].similarity);
  }
  EXPECT_TRUE(shared.of({}).empty());
  EXPECT_TRUE(SharedMatches(NgramRecognizer(Rounds::params())).of({}).empty());
}

TEST(SharedMatches, parametersAreChecked) {
  Rounds rounds({round()});
  SharedMatchesParams params;
  params.cell = 0;
  EXPECT_THROW(SharedMatches(rounds.recognizer, params), hyselam::ParameterError);
  params = {};
  params.prior = 0.0;
  EXPECT_THROW(SharedMatches(rounds.recognizer, params), hyselam::ParameterError);
}
