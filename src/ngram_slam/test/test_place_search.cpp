// Places found by their signatures: the index against exact search, scores of single places and of
// chains against plain transcriptions, candidates for loops from keyframes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/signatures/place_recognizer.hpp"
#include "ngram_slam/slam/signature_places.hpp"
#include "random_signatures.hpp"
#include "transcription/signatures.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::Rng;
using hyselam::testing::messageOf;

TEST(PlaceIndex, findsWhatExactSearchFinds) {
  Rng rng(11);
  const SignatureModel& model = SignatureModel::shipped();
  PlaceIndex index(model);
  for (int i = 0; i < 40000; ++i) index.add(randomSignature(rng));
  int found = 0;
  constexpr int kQuestions = 100;
  for (int i = 0; i < kQuestions; ++i) {
    const std::uint32_t place = rng.below(30000);
    const PlaceSignature wanted = visited(index[place], model, rng);
    const auto all = index.searchAll(wanted, 20, 30000);
    ASSERT_EQ(all.size(), 20U);
    EXPECT_EQ(all.front().place, place);
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
    const auto some = index.search(wanted, 20, 30000);
    found += !some.empty() && some.front().place == place ? 1 : 0;
    for (const auto& f : some) EXPECT_LT(f.place, 30000U);
  }
  EXPECT_GE(found, 95);
  // Few are all compared.
  const PlaceSignature wanted = randomSignature(rng);
  const auto exact = index.searchAll(wanted, 20, 5000), same = index.search(wanted, 20, 5000);
  ASSERT_EQ(exact.size(), same.size());
  for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_EQ(exact[i].place, same[i].place);
  EXPECT_TRUE(index.search(wanted, 20, 0).empty());
}

TEST(PlaceIndex, looksAtPlacesOfAllAgesWhereTheyAreTooMany) {
  Rng rng(12);
  const SignatureModel& model = SignatureModel::shipped();
  PlaceIndex index(model);
  // One building that looks the same everywhere: all places in one cell.
  const PlaceSignature place = randomSignature(rng);
  constexpr std::uint32_t kPlaces = 4 * PlaceIndex::kMaxSeen;
  for (std::uint32_t i = 0; i < kPlaces; ++i) index.add(place);
  const auto found = index.search(place, PlaceIndex::kMaxSeen, kPlaces);
  ASSERT_EQ(found.size(), PlaceIndex::kMaxSeen);
  std::array<int, 4> of_quarter{};
  for (const auto& f : found) ++of_quarter[f.place / PlaceIndex::kMaxSeen];
  for (const int count : of_quarter) {
    EXPECT_EQ(count, static_cast<int>(PlaceIndex::kMaxSeen / 4));
  }
}

TEST(PlaceRecognizer, findsAWayAgainInBothDirections) {
  Rng rng(13);
  const SignatureModel& model = SignatureModel::shipped();
  PlaceRecognizer recognizer(model);
  std::vector<PlaceSignature> way;
  for (int i = 0; i < 100; ++i) way.push_back(randomSignature(rng));
  for (const auto& s : way) recognizer.add(visited(s, model, rng));
  for (int i = 20; i < 60; ++i) {
    recognizer.add(visited(way[static_cast<std::size_t>(i)], model, rng));
  }
  recognizer.endRun();
  for (int i = 80; i > 40; --i) {
    recognizer.add(visited(way[static_cast<std::size_t>(i)], model, rng));
  }
  const auto same = recognizer.candidates(120);
  ASSERT_FALSE(same.empty());
  EXPECT_EQ(same.front().older, 40U);
  EXPECT_EQ(same.front().direction, Direction::kSame);
  const auto reverse = recognizer.candidates(150);  // way[70]
  ASSERT_FALSE(reverse.empty());
  EXPECT_EQ(reverse.front().older, 70U);
  EXPECT_EQ(reverse.front().direction, Direction::kReverse);
  const auto other = recognizer.candidates(150, [](std::uint32_t older) { return older != 70; });
  for (const auto& c : other) EXPECT_NE(c.older, 70U);
  EXPECT_EQ(recognizer.runOf(150), (std::pair<std::uint32_t, std::uint32_t>{140, 180}));
}

TEST(PlaceRecognizer, scoresAsThePlainSumOfItsPairs) {
  Rng rng(17);
  const SignatureModel& model = SignatureModel::shipped();
  PlaceRecognizer recognizer(model);
  for (int i = 0; i < 90; ++i) {
    recognizer.add(randomSignature(rng));
    if (i == 40) recognizer.endRun();
  }
  const PlaceIndex& index = recognizer.index();
  for (int i = 0; i < 200; ++i) {
    const std::uint32_t newer = 41 + rng.below(49), older = rng.below(41);
    for (const Direction direction : {Direction::kSame, Direction::kReverse}) {
      double sum = 0.0;
      int pairs = 0;
      for (int o = -4; o <= 4; ++o) {
        const int a = static_cast<int>(newer) + o;
        const int b = static_cast<int>(older) + (direction == Direction::kSame ? o : -o);
        if (a < 41 || a >= 90 || b < 0 || b >= 41) continue;
        sum += transcription::logRatio(model, index[static_cast<std::uint32_t>(a)],
                                       index[static_cast<std::uint32_t>(b)]);
        ++pairs;
      }
      EXPECT_NEAR(recognizer.score(newer, older, direction), sum / pairs,
                  0.02 * (1.0 + std::abs(sum / pairs)));
    }
  }
  for (const auto& c : recognizer.candidatesOfAll(60)) {
    EXPECT_LE(c.older, 41U);
    EXPECT_EQ(c.score, recognizer.score(60, c.older, c.direction));
  }
}

namespace {

/// A way, and a second run in which parts of it are travelled again among places never seen.
void addWayWithParts(PlaceRecognizer* recognizer, const SignatureModel& model, Rng& rng) {
  std::vector<PlaceSignature> way;
  for (int i = 0; i < 60; ++i) {
    way.push_back(randomSignature(rng));
    recognizer->add(visited(way.back(), model, rng));
  }
  recognizer->endRun();
  for (int i = 0; i < 60; ++i) {
    const bool is_known = i % 20 < 13;
    const auto again = static_cast<std::size_t>(i < 40 ? i : 99 - i);  // the last third backwards
    recognizer->add(is_known ? visited(way[again], model, rng) : randomSignature(rng));
  }
}

}  // namespace

TEST(PlaceRecognizer, scoresChainsAsTheBestNgramsThroughTheirPairs) {
  Rng rng(18);
  const SignatureModel& model = SignatureModel::shipped();
  PlaceRecognizerParams params;
  params.chain_length = 12;
  params.chain_decay = 0.8;
  PlaceRecognizer recognizer(model, params);
  addWayWithParts(&recognizer, model, rng);
  const PlaceIndex& index = recognizer.index();
  int long_ones = 0;
  for (std::uint32_t newer = 60; newer < 120; ++newer) {
    for (std::uint32_t older = 0; older < 60; ++older) {
      for (const Direction direction : {Direction::kSame, Direction::kReverse}) {
        const auto ratio = [&](int d) -> std::optional<double> {
          const int a = static_cast<int>(newer) + d;
          const int b = static_cast<int>(older) + (direction == Direction::kSame ? d : -d);
          if (a < 60 || a >= 120 || b < 0 || b >= 60) return std::nullopt;
          return index.score(index.questionOf(index[static_cast<std::uint32_t>(a)]),
                             static_cast<std::uint32_t>(b));
        };
        const double expected = transcription::chainScore(ratio, 12, 4, 0.8);
        EXPECT_NEAR(recognizer.score(newer, older, direction), expected,
                    1e-9 * (1.0 + std::abs(expected)));
        long_ones += expected > 3.0 * std::max(1.0, ratio(0).value()) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(long_ones, 20);  // n-grams of several places are among them
  const auto found = recognizer.candidates(70);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().older, 10U);
  EXPECT_EQ(found.front().score, recognizer.score(70, 10, Direction::kSame));
  const auto backwards = recognizer.candidates(110);
  ASSERT_FALSE(backwards.empty());
  EXPECT_EQ(backwards.front().older, 49U);
  EXPECT_EQ(backwards.front().direction, Direction::kReverse);
}

TEST(PlaceRecognizer, refusesParametersOutOfRange) {
  const auto refuses = [](const PlaceRecognizerParams& params) {
    EXPECT_THROW(PlaceRecognizer(SignatureModel::shipped(), params), hyselam::ParameterError);
  };
  PlaceRecognizerParams params;
  params.max_candidates = 0;
  refuses(params);
  params = {};
  params.chain_length = -1;
  refuses(params);
  params = {};
  params.chain_decay = 1.0;
  refuses(params);
}

TEST(SignaturePlaces, proposeOlderKeyframesOfTheSamePlace) {
  Rng rng(31);
  std::vector<std::shared_ptr<const hyselam::LaserScan>> scans;
  for (int i = 0; i < 240; ++i) {
    scans.push_back(std::make_shared<const hyselam::LaserScan>(randomScan(rng)));
  }
  // The same 60 m twice.
  const auto drive = [&](SignaturePlaces* places) {
    std::vector<SignatureCandidate> found;
    for (int i = 0; i < 480; ++i) {
      for (const auto& c : places->add({i,
                                        i == 0,
                                        {i == 0 ? 0.0 : 0.25, 0.0, 0.0},
                                        scans[static_cast<std::size_t>(i % 240)]})) {
        found.push_back(c);
      }
    }
    for (const auto& c : places->endRun()) found.push_back(c);
    return found;
  };
  SignaturePlaces places({});
  int right = 0, asked = -1, questions = 0;
  for (const auto& c : drive(&places)) {
    EXPECT_LT(c.keyframe_older, c.keyframe_newer);
    if (c.keyframe_newer < 280 || c.keyframe_newer > 440 || c.keyframe_newer == asked) continue;
    asked = c.keyframe_newer;  // the best
    ++questions;
    right += std::abs(c.keyframe_newer - 240 - c.keyframe_older) <= 2 ? 1 : 0;
  }
  EXPECT_GT(questions, 15);
  EXPECT_GE(10 * right, 9 * questions);
  // Nothing that odometry excludes.
  SignaturePlaces sure({}, [](double) { return 5.0; });
  EXPECT_TRUE(drive(&sure).empty());
  // Only what is new.
  SignaturePlaces later({});
  later.askFrom(300);
  const auto found = drive(&later);
  EXPECT_FALSE(found.empty());
  for (const auto& c : found) EXPECT_GE(c.keyframe_newer, 300);
}

TEST(SignaturePlaces, refuseASensorThatTheModelWasNotLearntWith) {
  SignaturePlacesParams params;
  params.sensor.half_window = 3.0;
  const std::string refusal =
      messageOf<hyselam::ParameterError>([&] { SignaturePlaces places(params); });
  EXPECT_NE(refusal.find("half_window"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("5"), std::string::npos) << refusal;
  EXPECT_NO_THROW(SignaturePlaces({}));
}
