// Signatures of places: equality with plain transcriptions, what does not depend on the heading,
// the model and its learning, places along a way, and what is done with input that cannot be used.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <clocale>
#include <cmath>
#include <limits>
#include <locale>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/signatures/place_recognizer.hpp"
#include "ngram_slam/signatures/signature_sensor.hpp"
#include "ngram_slam/signatures/signature_training.hpp"
#include "random_signatures.hpp"
#include "transcription/signatures.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using fsd_localization::FreeSpaceGrid;
using hyselam::Pose2;
using hyselam::Rng;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;

namespace {

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

/// As a German user's process writes numbers.
struct Commas : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(SignatureModel, isTheSameWhereNumbersHaveCommas) {
  const std::string text = SignatureModel::shipped().text();
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new Commas));  // owned by the locale
  std::string with_commas;
  EXPECT_NO_THROW(with_commas = SignatureModel::parse(text, "shipped").text());
  std::locale::global(before);
  EXPECT_EQ(with_commas, text);
}

TEST(SignatureModel, isTheSameWhereCFunctionsWriteCommas) {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  const char* found = nullptr;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "pt_BR.UTF-8", "fr_FR.UTF-8"}) {
    if (found == nullptr) found = std::setlocale(LC_NUMERIC, name);
  }
  if (found == nullptr) GTEST_SKIP() << "no locale with a decimal comma is installed";
  const std::string text = SignatureModel::shipped().text();
  const std::string again = SignatureModel::parse(text, "shipped").text();
  std::setlocale(LC_NUMERIC, before.c_str());
  EXPECT_EQ(again, text);
  EXPECT_NE(text.find("0.5"), std::string::npos);
}

TEST(SignatureModel, refusesWhatItCouldNotReadBack) {
  const std::vector<SignatureModel::Row> rows(SignatureModel::kSize);
  const std::vector<float> zeros(SignatureModel::kSize, 0.0F);
  std::vector<float> variances(SignatureModel::kSize, 2.0F);
  EXPECT_NO_THROW(SignatureModel(rows, zeros, variances, {}, {}));
  variances[3] = 1.0000002F;  // written as 1
  EXPECT_THROW(SignatureModel(rows, zeros, variances, {}, {}), hyselam::ParameterError);
  variances[3] = 2.0F;
  std::vector<float> offsets = zeros;
  offsets[5] = 999999.9F;  // written as 1e+06
  EXPECT_THROW(SignatureModel(rows, offsets, variances, {}, {}), hyselam::ParameterError);
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
  EXPECT_NE(refusal("something else\n").find("is no 'ngram_slam place signatures 2'"),
            std::string::npos);
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
