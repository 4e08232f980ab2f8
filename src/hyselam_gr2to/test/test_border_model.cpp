// The border model as a file: what is read is written again, and what is no model is refused with
// the line.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/temporary_directory.hpp"
#include "hyselam_gr2to/segmentation/border_model.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;

namespace {

const std::string kFile = HYSELAM_PACKAGE_DIR "/models/border_trees.txt";

/// The text with its checksum made right.
std::string sealed(const std::string& text) {
  const std::string body = text.substr(0, text.rfind("checksum "));
  return body + "checksum " + hyselam::crc32Text(body) + "\n";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(std::string::npos, at) << from;
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  return messageOf<hyselam::InputError>([&] { BorderModel::fromText(text, "model"); });
}

}  // namespace

TEST(BorderModel, ShippedIsTheFileOfThePackage) {
  EXPECT_EQ(fileBytes(kFile), BorderModel::shipped().toText());
  EXPECT_EQ(fileBytes(kFile), BorderModel::load(kFile).toText());
}

TEST(BorderModel, ShippedTellsWhereItComesFrom) {
  const hyselam::ModelOrigin& origin = BorderModel::shipped().origin();
  EXPECT_EQ("train_borders GRIDMAPS", origin.command);
  EXPECT_NE(std::string::npos, origin.data.find("28 maps")) << origin.data;
  EXPECT_NE(std::string::npos, origin.data.find("24 generated floors")) << origin.data;
  for (const std::string& scores : {origin.in_sample, origin.left_out}) {
    for (const char* kind : {"furnished MCC 0.", "robot MCC 0.", "unfurnished MCC 0."}) {
      EXPECT_NE(std::string::npos, scores.find(kind)) << scores;
    }
  }
}

TEST(BorderModel, NamesOfFeaturesAreThoseOfTheFile) {
  const std::string text = fileBytes(kFile);
  std::string names = "features " + std::to_string(kBorderFeatureCount) + "\n";
  std::set<std::string> distinct;
  for (std::size_t i = 0; i < kBorderFeatureCount; ++i) {
    const auto feature = static_cast<BorderFeature>(i);
    names += std::string(toString(feature)) + "\n";
    distinct.insert(toString(feature));
    EXPECT_EQ(feature, borderFeatureFromString(toString(feature)));
  }
  EXPECT_EQ(kBorderFeatureCount, distinct.size());
  EXPECT_NE(std::string::npos, text.find("\n" + names + "trees "));
  EXPECT_FALSE(borderFeatureFromString("no feature"));
}

TEST(BorderModel, WiderBordersNeverLowerTheOdds) {
  const BorderModel& model = BorderModel::shipped();
  BorderFeatures border;
  double last = -1e9;
  for (double ratio = -3.0; ratio <= 0.0; ratio += 0.01) {
    border[BorderFeature::kClearanceToSmallerPeak] = ratio;
    const double odds = model.oddsOfOnePlace(border);
    ASSERT_GE(odds, last - 1e-12) << ratio;
    last = odds;
  }
}

// As it is meant, without walking through the trees together.
TEST(BorderModel, TheOddsAreTheWeightedMeanOverLengthsAndClearances) {
  const BorderModel& model = BorderModel::shipped();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-3.0, 3.0);
  for (int round = 0; round < 500; ++round) {
    BorderFeatures border;
    for (double& v : border.values) v = value(random);
    double sum = 0.0, weights = 0.0;
    for (int i = -2; i <= 2; ++i)
      for (int j = -1; j <= 1; ++j) {
        const double weight = (3 - std::abs(i)) * (2 - std::abs(j));
        sum += weight * model.trees()(rescaledBorder(border, 0.1 * i, 0.1 * j).values.data());
        weights += weight;
      }
    ASSERT_EQ(sum / weights, model.oddsOfOnePlace(border));
  }
}

TEST(BorderModel, RefusesDamagedFilesWithTheLine) {
  const std::string text = fileBytes(kFile);
  EXPECT_NE(std::string::npos, refusal("").find("checksum"));
  EXPECT_NE(std::string::npos, refusal(text.substr(0, text.size() / 2)).find("cut short"));
  EXPECT_NE(std::string::npos, refusal(replaced(text, "leaf ", "leaf 1")).find("checksum"));
  EXPECT_NE(std::string::npos, refusal(text + "\n").find("checksum"));
  const auto changed = [&](const char* from, const char* to) {
    return refusal(sealed(replaced(text, from, to)));
  };
  EXPECT_NE(std::string::npos, changed("trees 1\n", "trees 2\n").find("line 1: "));
  EXPECT_NE(std::string::npos, changed("\ncommand ", "\ncommands ").find("line 2: "));
  EXPECT_NE(std::string::npos, changed("features 27", "features 28").find("27"));
  EXPECT_NE(std::string::npos, changed("\nclearance\n", "\nwidth\n").find("'clearance'"));
  EXPECT_NE(std::string::npos, changed("\nleaf ", "\nleaf x").find("is no number"));
  EXPECT_NE(std::string::npos, changed("\nleaf ", "\nleaf nan ").find("line "));
  EXPECT_NE(std::string::npos, changed("\ntrees 120", "\ntrees 119").find("more than the trees"));
  EXPECT_NE(std::string::npos, changed("\ntrees 120", "\ntrees 121").find("too early"));
  EXPECT_NE(std::string::npos, changed("\ntree 11", "\ntree 0").find("tree must be"));
}

TEST(BorderModel, RefusesTreesThatAreNone) {
  const std::string head = [] {
    const std::string text = fileBytes(kFile);
    return text.substr(0, text.find("\ntrees ") + 1);
  }();
  const auto tree = [&](const std::string& nodes) { return sealed(head + "trees 1\n" + nodes); };
  EXPECT_EQ("", refusal(tree("tree 1\nleaf 0.5\n")));
  EXPECT_EQ("", refusal(tree("tree 3\nclearance 0.5 1\nleaf 1\nleaf -1\n")));
  for (const char* child : {"0", "2", "-1", "1.5", "1e9"}) {
    const std::string nodes = std::string("tree 3\nclearance 0.5 ") + child + "\nleaf 1\nleaf -1\n";
    EXPECT_NE(std::string::npos, refusal(tree(nodes)).find("children")) << child;
  }
  EXPECT_NE(std::string::npos,
            refusal(tree("tree 3\nwidth 0.5 1\nleaf 1\nleaf -1\n")).find("no feature 'width'"));
}

TEST(BorderModel, NamesTheFileThatCannotBeRead) {
  hyselam::testing::TemporaryDirectory folder;
  const std::string missing = folder / "none.txt";
  EXPECT_NE(std::string::npos,
            messageOf<hyselam::InputError>([&] { BorderModel::load(missing); }).find(missing));
}
