// Signatures of places: equality with plain transcriptions, what does not depend on the heading,
// the index against exact search, and what is done with input that cannot be used.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/signatures/place_recognizer.hpp"
#include "ngram_slam/signatures/signature_sensor.hpp"
#include "ngram_slam/signatures/signature_training.hpp"
#include "ngram_slam/slam/far_loops.hpp"
#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/loop_confidence.hpp"
#include "ngram_slam/slam/path_segment.hpp"
#include "ngram_slam/slam/segment_context.hpp"
#include "ngram_slam/slam/signature_places.hpp"
#include "transcription/signatures.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using fsd_localization::FreeSpaceGrid;
using hyselam::Pose2;
using hyselam::Rng;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;

namespace {

hyselam::LaserScan randomScan(Rng& rng) {
  hyselam::LaserScan scan;
  scan.angle_min = -hyselam::kPi / 2;
  scan.angle_increment = hyselam::radians(2.0);
  scan.range_min = 0.05;
  scan.range_max = 30.0;
  scan.laser_in_base = {0.1, 0.0, 0.0};
  for (int i = 0; i < 91; ++i) scan.ranges.push_back(static_cast<float>(rng.uniform(0.0, 32.0)));
  return scan;
}

Pose2 randomPose(Rng& rng, double side) {
  return {rng.uniform(-side, side), rng.uniform(-side, side), rng.uniform(-3.0, 3.0)};
}

/// Bytes that vary as much among places as they are taken to.
PlaceSignature randomSignature(Rng& rng) {
  PlaceSignature s;
  for (auto& v : s.values) {
    v = static_cast<std::int8_t>(std::clamp(rng.gaussian(0.0, 127.0 / 4.0), -127.0, 127.0));
  }
  return s;
}

/// Another visit.
PlaceSignature visited(const PlaceSignature& place, const SignatureModel& model, Rng& rng) {
  PlaceSignature s;
  for (std::size_t i = 0; i < s.values.size(); ++i) {
    const double value = place.values[i] + rng.gaussian() / static_cast<double>(model.steps()[i]);
    s.values[i] = static_cast<std::int8_t>(std::lround(std::clamp(value, -127.0, 127.0)));
  }
  return s;
}

/// Half a floor plan of walls, turned by quarters of a turn.
FreeSpaceGrid drawnView(int reach, int quarters, std::uint64_t seed) {
  FreeSpaceGrid view(2 * reach + 1, 2 * reach + 1);
  Rng rng(seed);
  std::vector<std::array<int, 3>> walls;
  for (int i = 0; i < 25; ++i) {
    walls.push_back({static_cast<int>(rng.below(100)) - 50, static_cast<int>(rng.below(100)) - 50,
                     2 + static_cast<int>(rng.below(20))});
  }
  const auto put = [&](int x, int y, bool wall) {
    for (int q = 0; q < quarters; ++q) std::tie(x, y) = std::make_pair(-y, x);
    if (std::max(std::abs(x), std::abs(y)) > reach) return;
    view.free.set(x + reach, y + reach, !wall);
  };
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) put(x, y, false);
  }
  for (const auto& [x, y, length] : walls) {
    for (int i = 0; i < length; ++i) put(x + i, y, true);
  }
  return view;
}

}  // namespace

TEST(WindowMap, showsWhatAPlainMapShowsWhereverItIs) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const double resolution = 0.2, range = 8.0;
    WindowMap map(resolution, range, 10.0);
    const Pose2 origin = randomPose(rng, 500.0);
    transcription::Counts counts;
    for (int i = 0; i < 12; ++i) {
      const Pose2 base = origin * randomPose(rng, 2.0);
      const auto scan = randomScan(rng);
      map.insert(base, scan);
      for (std::size_t b = 0; b < scan.ranges.size(); ++b) {
        const double r = static_cast<double>(scan.ranges[b]);
        if (r < scan.range_min) continue;
        const bool is_return = r < scan.range_max && r < range;
        transcription::traceBeam(base * scan.laser_in_base,
                                 scan.angle_min + static_cast<double>(b) * scan.angle_increment,
                                 std::min(r, range), is_return, resolution, &counts);
      }
    }
    FreeSpaceGrid view = map.emptyView();
    map.view({origin.x, origin.y}, &view);
    const int x0 = static_cast<int>(std::floor(origin.x / resolution)) - map.reach();
    const int y0 = static_cast<int>(std::floor(origin.y / resolution)) - map.reach();
    for (int y = 0; y <= 2 * map.reach(); ++y) {
      for (int x = 0; x <= 2 * map.reach(); ++x) {
        const auto found = counts.find({x0 + x, y0 + y});
        const auto [free, hits] = found == counts.end() ? std::make_pair(0, 0) : found->second;
        ASSERT_EQ(view.unknown.get(x, y), free + hits == 0) << x << " " << y;
        ASSERT_EQ(view.free.get(x, y), free + hits > 0 && free > 3 * hits) << x << " " << y;
      }
    }
  }
}

TEST(WindowMap, forgetsWhatIsTakenOutExactly) {
  Rng rng(7);
  WindowMap map(0.2, 20.0, 10.0), other(0.2, 20.0, 10.0);
  std::vector<std::pair<Pose2, hyselam::LaserScan>> scans;
  for (int i = 0; i < 30; ++i) scans.emplace_back(randomPose(rng, 3.0), randomScan(rng));
  for (const auto& [base, scan] : scans) map.insert(base, scan);
  for (std::size_t i = 0; i < 20; ++i) map.remove(scans[i].first, scans[i].second);
  for (std::size_t i = 20; i < 30; ++i) other.insert(scans[i].first, scans[i].second);
  FreeSpaceGrid a = map.emptyView(), b = other.emptyView();
  map.view({0.0, 0.0}, &a);
  other.view({0.0, 0.0}, &b);
  for (int y = 0; y <= 2 * map.reach(); ++y) {
    for (int x = 0; x <= 2 * map.reach(); ++x) {
      ASSERT_EQ(a.free.get(x, y), b.free.get(x, y));
      ASSERT_EQ(a.unknown.get(x, y), b.unknown.get(x, y));
    }
  }
}

TEST(WindowMap, refusesSizesThatCannotBe) {
  EXPECT_THROW(WindowMap(0.0, 20.0, 10.0), hyselam::ParameterError);
  EXPECT_THROW(WindowMap(0.2, -1.0, 10.0), hyselam::ParameterError);
  EXPECT_THROW(WindowMap(0.2, 20.0, std::numeric_limits<double>::quiet_NaN()),
               hyselam::ParameterError);
  EXPECT_THROW(WindowMap(0.001, 20.0, 10.0), hyselam::ParameterError);
}

TEST(PlaceFeatures, ofARoom) {
  const int reach = 100;
  FreeSpaceGrid view(201, 201);
  for (int y = 0; y < 201; ++y) {
    for (int x = 0; x < 201; ++x) {
      const int far = std::max(std::abs(x - reach), std::abs(y - reach));
      view.free.set(x, y, far < 15);
      view.unknown.set(x, y, far > 15);
    }
  }
  PlaceFeatures f;
  PlaceFeatureExtractor(0.2, reach).extract(&view, &f);
  EXPECT_FLOAT_EQ(f.densities[0], 1.0F);
  EXPECT_FLOAT_EQ(f.densities[2], 1.0F);
  EXPECT_LT(f.densities[3], 0.95F);
  EXPECT_NEAR(f.distances[0], 3.0, 0.21);
  EXPECT_NEAR(f.distances[9], 3.0 * std::sqrt(2.0), 0.3);
  unsigned cells = 0;
  for (const auto& column : f.context) {
    for (const auto count : column) cells += count;
  }
  EXPECT_EQ(cells, 4U * 30U);
}

TEST(PlaceFeatures, areThoseOfTheTranscription) {
  const int reach = 100;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    FreeSpaceGrid view = drawnView(reach, 0, seed);
    PlaceFeatures f;
    PlaceFeatureExtractor(0.2, reach).extract(&view, &f);
    const auto fast = SignatureFeatures::of(f);
    const auto plain = transcription::featuresOf(f);
    ASSERT_EQ(fast.size(), plain.size());
    for (std::size_t i = 0; i < fast.size(); ++i) {
      ASSERT_NEAR(static_cast<double>(fast[i]), plain[i], 1e-3) << seed << " " << i;
    }
  }
}

TEST(PlaceFeatures, doNotDependOnTheHeading) {
  const int reach = 100;
  const PlaceFeatureExtractor extractor(0.2, reach);
  const SignatureModel& model = SignatureModel::shipped();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    PlaceFeatures f;
    FreeSpaceGrid view = drawnView(reach, 0, seed);
    extractor.extract(&view, &f);
    const PlaceSignature straight = model.signatureOf(f);
    FreeSpaceGrid other_view = drawnView(reach, 0, seed + 100);
    extractor.extract(&other_view, &f);
    const double different = model.logRatio(straight, model.signatureOf(f));
    for (int quarters = 1; quarters < 4; ++quarters) {
      view = drawnView(reach, quarters, seed);
      extractor.extract(&view, &f);
      EXPECT_GT(model.logRatio(straight, model.signatureOf(f)), different + 10.0)
          << seed << " " << quarters;
    }
  }
}

TEST(SignatureModel, comparesByTheLikelihoodsOfTwoNormalDistributions) {
  Rng rng(3);
  const SignatureModel& model = SignatureModel::shipped();
  PlaceIndex index(model);
  for (int i = 0; i < 200; ++i) {
    const PlaceSignature a = randomSignature(rng);
    const PlaceSignature b = i % 2 == 0 ? randomSignature(rng) : visited(a, model, rng);
    const double plain = transcription::logRatio(model, a, b);
    EXPECT_NEAR(model.logRatio(a, b), plain, 1e-3 * (1.0 + std::abs(plain)));
    EXPECT_NEAR(model.logRatio(a, b), model.logRatio(b, a), 1e-4 * (1.0 + std::abs(plain)));
    const std::uint32_t place = index.add(b);
    EXPECT_NEAR(static_cast<double>(index.score(index.questionOf(a), place)), plain,
                0.02 * (1.0 + std::abs(plain)));
  }
}

TEST(SignatureModel, isReadAsItWasWritten) {
  const TemporaryDirectory folder;
  const SignatureModel& model = SignatureModel::shipped();
  model.save(folder / "model.txt");
  const SignatureModel again = SignatureModel::load(folder / "model.txt");
  EXPECT_EQ(again.text(), model.text());
  EXPECT_FALSE(model.origin().command.empty());
  EXPECT_FALSE(model.origin().data.empty());
}

TEST(SignatureModel, refusesWhatIsDamaged) {
  const std::string text = SignatureModel::shipped().text();
  const auto refusal = [](const std::string& given) {
    return messageOf<hyselam::InputError>([&] { SignatureModel::parse(given, "m.txt"); });
  };
  /// With the right checksum.
  const auto sealed = [](std::string body) {
    const std::size_t sum = body.rfind("\ncrc32 ");
    if (sum != std::string::npos) body.resize(sum + 1);
    return body + "crc32 " + hyselam::crc32Text(body) + "\n";
  };
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    return sealed(other);
  };
  EXPECT_NE(refusal("").find("m.txt"), std::string::npos);
  EXPECT_NE(refusal("something else\n").find("is no model"), std::string::npos);
  EXPECT_NE(refusal(text.substr(0, text.size() / 2)).find("checksum"), std::string::npos);
  EXPECT_NE(refusal(text + "more").find("checksum"), std::string::npos);
  EXPECT_NE(refusal(replaced("features: 209", "features: 210")).find("line 7"), std::string::npos);
  EXPECT_NE(refusal(replaced("half_window 5", "half_window x")).find("line 6"), std::string::npos);
  EXPECT_NE(refusal(replaced("half_window 5", "half_window -5")).find("line 6"), std::string::npos);
  EXPECT_NE(refusal(replaced("range 20", "range 30")).find("line 6"), std::string::npos);
  EXPECT_NE(refusal(replaced("data: ", "date: ")).find("line 3"), std::string::npos);
  const std::size_t row = text.find('\n', text.find("features:")) + 1;
  const std::string number = text.substr(row, text.find(' ', row) - row);
  EXPECT_NE(refusal(replaced("\n" + number + " ", "\nnan ")).find("line 8"), std::string::npos);
  EXPECT_NE(refusal(replaced("\n" + number + " ", "\n0.5 ")).find("above 1"), std::string::npos);
  EXPECT_NE(refusal(replaced("\n" + number + " ", "\n")).find("line 8"), std::string::npos);
  const std::string without_last = text.substr(0, text.rfind('\n', text.rfind("crc32 ") - 2) + 1);
  EXPECT_NE(refusal(sealed(without_last)).find("63"), std::string::npos);
}

TEST(SignatureModel, refusesNumbersThatCannotBe) {
  const std::vector<SignatureModel::Row> rows(PlaceSignature::kSize);
  const std::vector<float> offsets(PlaceSignature::kSize, 0.0F),
      variances(PlaceSignature::kSize, 2.0F);
  EXPECT_NO_THROW(SignatureModel(rows, offsets, variances));
  EXPECT_THROW(SignatureModel({}, offsets, variances), hyselam::ParameterError);
  auto bad = variances;
  bad[3] = 0.5F;
  EXPECT_THROW(SignatureModel(rows, offsets, bad), hyselam::ParameterError);
  bad[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(SignatureModel(rows, offsets, bad), hyselam::ParameterError);
  EXPECT_THROW(SignatureModel(rows, bad, variances), hyselam::ParameterError);
}

TEST(SignatureTraining, tellsPlacesApartThatWereVisitedAgain) {
  Rng rng(5);
  // Two of the features are of the place, the others of the moment.
  const auto way = [&] {
    std::vector<std::pair<float, float>> places;
    for (int i = 0; i < 60; ++i) {
      places.emplace_back(static_cast<float>(rng.gaussian()), static_cast<float>(rng.gaussian()));
    }
    std::vector<SignatureExample> examples;
    for (int i = 0; i < 180; ++i) {
      SignatureExample e;
      for (float& v : e.features) v = static_cast<float>(rng.gaussian());
      const auto& place = places[static_cast<std::size_t>(i % 60)];
      e.features[7] = place.first + 0.05F * static_cast<float>(rng.gaussian());
      e.features[90] = place.second + 0.05F * static_cast<float>(rng.gaussian());
      e.truth = Pose2{2.0 * (i % 60), 0.0, 0.0};
      examples.push_back(e);
    }
    return examples;
  };
  const std::vector<std::vector<SignatureExample>> ways{way(), way(), way()};
  const SignatureModel model = trainSignatures(ways);
  EXPECT_EQ(model.text(), trainSignatures(ways).text());
  EXPECT_GT(model.variances()[1], 3.0F * model.variances()[2]);
  auto without_truth = ways;
  for (auto& w : without_truth) {
    for (auto& e : w) e.truth.reset();
  }
  EXPECT_THROW(trainSignatures(without_truth), hyselam::InputError);
  EXPECT_THROW(trainSignatures({}), hyselam::InputError);
}

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

TEST(SignatureSensor, makesAPlaceEachHalfMeterOfEachRun) {
  Rng rng(19);
  std::vector<PlaceOnWay> places;
  SignatureSensor sensor({},
                         [&](const PlaceOnWay& p, const PlaceFeatures&) { places.push_back(p); });
  const auto scan = std::make_shared<const hyselam::LaserScan>(randomScan(rng));
  for (int i = 0; i <= 80; ++i) sensor.add(i, {0.25 * i, 0.0, 0.0}, scan);
  EXPECT_EQ(places.size(), 31U);  // 5 m are missing
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_NEAR(places[i].pose.x, 0.5 * static_cast<double>(i), 1e-9);
    EXPECT_EQ(places[i].keyframe, static_cast<std::int64_t>(2 * i));
  }
  sensor.finish();
  EXPECT_EQ(places.size(), 41U);
  sensor.add(81, {0.0, 0.0, 0.0}, scan);
  sensor.add(82, {20.0, 0.0, 0.0}, scan);  // a jump
  EXPECT_EQ(places.size(), 42U);
  sensor.finish();
  ASSERT_EQ(places.size(), 43U);
  EXPECT_EQ(places.back().keyframe, 82);
  EXPECT_EQ(places.back().way, 0.0);
  EXPECT_THROW(sensor.add(83, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, scan),
               hyselam::InputError);
  EXPECT_THROW(sensor.add(83, {}, nullptr), hyselam::InputError);
}

TEST(SignatureSensor, seesNothingOfWhatLiesFartherBackThanItsWindow) {
  Rng rng(23);
  std::vector<hyselam::LaserScan> scans;
  for (int i = 0; i < 200; ++i) scans.push_back(randomScan(rng));
  const auto featuresFrom = [&](int first) {
    std::map<int, PlaceFeatures> features;
    SignatureSensor sensor({}, [&](const PlaceOnWay& p, const PlaceFeatures& f) {
      features[static_cast<int>(p.keyframe)] = f;
    });
    for (int i = first; i < 200; ++i) {
      sensor.add(i, {0.25 * i, 0.0, 0.0},
                 std::make_shared<const hyselam::LaserScan>(scans[static_cast<std::size_t>(i)]));
    }
    sensor.finish();
    return features;
  };
  const auto whole = featuresFrom(0), part = featuresFrom(100);
  int compared = 0;
  for (const auto& [keyframe, features] : part) {
    if (keyframe < 122) continue;
    const auto found = whole.find(keyframe);
    ASSERT_NE(found, whole.end());
    EXPECT_EQ(features.context, found->second.context) << keyframe;
    EXPECT_EQ(features.densities, found->second.densities) << keyframe;
    ++compared;
  }
  EXPECT_GT(compared, 30);
}

TEST(SegmentContext, tellsByHowMuchWhatIsSeenIsTurned) {
  Rng rng(29);
  for (int i = 0; i < 50; ++i) {
    hyselam_scan_matching::SurfacePoints points;
    for (int wall = 0; wall < 6; ++wall) {
      const double x = rng.uniform(-15.0, 15.0), y = rng.uniform(-15.0, 15.0),
                   bearing = rng.uniform(-3.0, 3.0);
      for (int k = 0; k < 60; ++k) {
        points.push_back({x + 0.1 * k * std::cos(bearing), y + 0.1 * k * std::sin(bearing)});
      }
    }
    const double turn = rng.uniform(-3.1, 3.1);
    // What was seen at heading 0 is seen at heading `turn`.
    const auto turned = hyselam_scan_matching::transformed({0.0, 0.0, -turn}, points);
    const auto turns = likelyTurns(points, turned, 2);
    ASSERT_EQ(turns.size(), 2U);
    EXPECT_LT(std::abs(hyselam::normalizeAngle(turns[0] - turn)), hyselam::radians(6.5)) << i;
  }
  EXPECT_EQ(likelyTurns({}, {}, 3).size(), 3U);
}

TEST(LoopCompany, outweighsALoopThatContradictsIt) {
  std::vector<SlamKeyframe> keyframes;
  for (int i = 0; i < 200; ++i) {
    SlamKeyframe k;
    k.pose = {static_cast<double>(i), 0.0, 0.0};
    k.path_length = i;
    keyframes.push_back(k);
  }
  const auto loop = [](int older, int newer) {
    SlamLoop l;
    l.older = older;
    l.newer = newer;
    l.inlier_ratio = 0.8;
    return l;
  };
  const std::vector<SlamLoop> others{loop(10, 150), loop(12, 152), loop(14, 154)};
  const LoopParams params;
  EXPECT_TRUE(companyOf(loop(16, 156), others, keyframes, params).isTrusted(params));
  const LoopCompany alias = companyOf(loop(46, 156), others, keyframes, params);
  EXPECT_FALSE(alias.isTrusted(params));
  EXPECT_NEAR(alias.contradiction, 3 * 0.8, 1e-9);
  EXPECT_NEAR(alias.support, 0.8, 1e-9);
  // Far along the way nobody is asked.
  EXPECT_TRUE(companyOf(loop(46, 190), others, keyframes, params).isTrusted(params));
}

namespace {

/// A straight way of keyframes a metre apart.
std::vector<SlamKeyframe> straightWay(int n) {
  std::vector<SlamKeyframe> keyframes;
  for (int i = 0; i < n; ++i) {
    SlamKeyframe k;
    k.pose = {static_cast<double>(i), 0.0, 0.0};
    k.path_length = i;
    k.scan = std::make_shared<const hyselam::LaserScan>();
    k.points = std::make_shared<const hyselam_scan_matching::SurfacePoints>();
    keyframes.push_back(k);
  }
  return keyframes;
}

SlamLoop signatureLoop(int older, int newer) {
  SlamLoop l;
  l.older = older;
  l.newer = newer;
  l.source = LoopSource::kSignature;
  l.far = true;
  l.inlier_ratio = 0.8;
  l.fit = 0.97;
  return l;
}

}  // namespace

TEST(FarLoops, waitForTwoOthersThatAgree) {
  const auto keyframes = straightWay(200);
  const LoopParams params;
  std::vector<SlamLoop> waiting;
  EXPECT_TRUE(believeFarLoops(signatureLoop(10, 150), {}, keyframes, params, &waiting).empty());
  EXPECT_TRUE(believeFarLoops(signatureLoop(12, 152), {}, keyframes, params, &waiting).empty());
  EXPECT_EQ(waiting.size(), 2U);
  const auto believed = believeFarLoops(signatureLoop(14, 154), {}, keyframes, params, &waiting);
  ASSERT_EQ(believed.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(believed[i].newer, 154 - 2 * static_cast<int>(i));
  EXPECT_TRUE(waiting.empty());
  // From one spot they are one opinion, and the same loop twice is one.
  for (const int newer : {150, 151, 151}) {
    EXPECT_TRUE(believeFarLoops(signatureLoop(newer - 140, newer), {}, keyframes, params, &waiting)
                    .empty());
  }
  // With an accepted one no other is needed.
  waiting.clear();
  EXPECT_EQ(
      believeFarLoops(signatureLoop(20, 160), {signatureLoop(14, 154)}, keyframes, params, &waiting)
          .size(),
      1U);
}

TEST(FarLoops, areEachAskedForTheirCompany) {
  const auto keyframes = straightWay(200);
  LoopParams params;
  params.company_half_length = 3.0;
  // Three that agree, the first of which two others contradict: it neither counts nor is believed.
  std::vector<SlamLoop> waiting{signatureLoop(60, 148), signatureLoop(61, 149)};
  EXPECT_TRUE(believeFarLoops(signatureLoop(10, 150), {}, keyframes, params, &waiting).empty());
  EXPECT_TRUE(believeFarLoops(signatureLoop(14, 154), {}, keyframes, params, &waiting).empty());
  EXPECT_TRUE(believeFarLoops(signatureLoop(17, 157), {}, keyframes, params, &waiting).empty());
  const auto believed = believeFarLoops(signatureLoop(20, 160), {}, keyframes, params, &waiting);
  ASSERT_EQ(believed.size(), 3U);
  for (const SlamLoop& l : believed) EXPECT_GE(l.newer, 154);
  EXPECT_EQ(waiting.size(), 3U);
}

TEST(FarLoops, waitWhileTheyAreImprobable) {
  const auto keyframes = straightWay(200);
  LoopParams params;
  std::vector<SlamLoop> waiting;
  params.min_signature_probability = 1.0;
  for (const int newer : {150, 152, 154, 156}) {
    EXPECT_TRUE(believeFarLoops(signatureLoop(newer - 140, newer), {}, keyframes, params, &waiting)
                    .empty());
  }
  params.min_signature_probability = 0.5;
  EXPECT_EQ(believeFarLoops(signatureLoop(18, 158), {}, keyframes, params, &waiting).size(), 5U);
}

TEST(LoopProbability, risesWithFitAndCompanyAndFallsWithContradiction) {
  SlamLoop loop = signatureLoop(1, 2);
  const auto probability = [&](double fit, double others, double contradiction) {
    loop.fit = fit;
    return loopProbability(loop, {loop.inlier_ratio + others, contradiction});
  };
  for (const double fit : {0.85, 0.9, 0.99, 1.0}) {
    for (const double others : {0.0, 1.0, 5.0}) {
      const double p = probability(fit, others, 0.5);
      EXPECT_GT(p, 0.0);
      EXPECT_LT(p, 1.0);
      EXPECT_GT(probability(fit, others + 1.0, 0.5), p);
      EXPECT_LT(probability(fit, others, 2.0), p);
      if (fit < 0.99) {
        EXPECT_GT(probability(fit + 0.01, others, 0.5), p);
      }
    }
  }
  // One alone that barely fits is likelier wrong than right; one of six that fit well is right.
  EXPECT_LT(probability(0.86, 0.0, 0.0), 0.6);
  EXPECT_GT(probability(0.97, 4.0, 0.0), 0.98);
}

TEST(SegmentAround, keepsToItsRunAndToThePath) {
  auto keyframes = straightWay(60);
  for (std::size_t i = 40; i < 60; ++i) keyframes[i].run = 1;
  const double all = std::numeric_limits<double>::infinity();
  const auto middle = segmentAround(keyframes, 20, 5.0, all);
  ASSERT_EQ(middle.size(), 11U);
  EXPECT_NEAR(middle.front().pose.x, -5.0, 1e-9);
  EXPECT_NEAR(middle.back().pose.x, 5.0, 1e-9);
  EXPECT_EQ(segmentAround(keyframes, 38, 5.0, all).size(), 7U);
  EXPECT_EQ(segmentAround(keyframes, 41, 5.0, all).size(), 7U);
  EXPECT_EQ(segmentAround(keyframes, 20, 5.0, 22.0).size(), 8U);
  EXPECT_TRUE(segmentAround(keyframes, 20, 5.0, 10.0).empty());
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
