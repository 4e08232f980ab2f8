// map_server's files: meaning of every key, round trips, and every way to get them wrong.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/drawn_grid.hpp"
#include "hyselam_common/testing/files.hpp"

namespace hyselam {
namespace {

using testing::messageOf;
using testing::TemporaryDirectory;
using testing::writeFile;

constexpr char kGood[] =
    "image: m.pgm\nresolution: 0.1\norigin: [1.0, -2.0, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// 3 x 2 pixels; the upper row first.
const std::string kPgm =
    std::string("P5\n3 2\n255\n") + '\x00' + '\xcd' + '\xfe' + '\xff' + '\x32' + '\x80';

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class MapFiles : public ::testing::Test {
 protected:
  void SetUp() override { writeFile(dir / "m.pgm", kPgm); }

  OccupancyGrid load(const std::string& yaml) {
    writeFile(dir / "m.yaml", yaml);
    return loadMap(dir / "m.yaml");
  }
  /// The message must name the YAML file and hold `part`.
  ::testing::AssertionResult refused(const std::string& yaml, const std::string& part) {
    const std::string message = messageOf<InputError>([&] { load(yaml); });
    if (message.find(dir / "m.yaml") == 0 && message.find(part) != std::string::npos) {
      return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << "message is '" << message << "'";
  }

  TemporaryDirectory dir;
};

TEST_F(MapFiles, TrinaryAsMapServerReadsIt) {
  const OccupancyGrid g = load(kGood);
  EXPECT_EQ(g.geometry.width, 3);
  EXPECT_EQ(g.geometry.height, 2);
  EXPECT_DOUBLE_EQ(g.geometry.resolution, 0.1);
  EXPECT_DOUBLE_EQ(g.geometry.origin.x, 1.0);
  EXPECT_DOUBLE_EQ(g.geometry.origin.y, -2.0);
  // The lower row of the image is y = 0: 255, 50, 128; above: 0, 205, 254.
  EXPECT_EQ(g.cells, (std::vector<std::int8_t>{0, 100, -1, 100, -1, 0}));
}

TEST_F(MapFiles, NegateTurnsBlackIntoFree) {
  const OccupancyGrid g = load(replaced(kGood, "negate: 0", "negate: 1"));
  EXPECT_EQ(g.cells, (std::vector<std::int8_t>{100, -1, -1, 0, 100, 100}));
}

TEST_F(MapFiles, ScaleSpreadsValuesBetweenTheThresholds) {
  const OccupancyGrid g = load(std::string(kGood) + "mode: scale\n");
  // 128: p = 127/255 -> 1 + 98 * (0.49804 - 0.196) / 0.454 = 66.2; 205: 1 + 98 * 0.0001728 = 1.02
  EXPECT_EQ(g.cells, (std::vector<std::int8_t>{0, 100, 66, 100, 1, 0}));
}

TEST_F(MapFiles, RawKeepsGreyValuesUpTo100) {
  const OccupancyGrid g = load(std::string(kGood) + "mode: raw\n");
  EXPECT_EQ(g.cells, (std::vector<std::int8_t>{-1, 50, -1, 0, -1, -1}));
}

TEST_F(MapFiles, YawOfTheOriginIsKept) {
  const OccupancyGrid g = load(replaced(kGood, "0.0]", "1.5707963267948966]"));
  // Cell (1, 0) lies one cell along +y of the map, since the grid is turned to the left.
  const Point2 c = g.geometry.center({1, 0});
  EXPECT_NEAR(c.x, 1.0 - 0.05, 1e-9);
  EXPECT_NEAR(c.y, -2.0 + 0.15, 1e-9);
}

TEST_F(MapFiles, ColoursAreAveragedAndTransparencyMeansUnknownInScale) {
  cv::Mat rgb(1, 2, CV_8UC3);
  rgb.at<cv::Vec3b>(0, 0) = {0, 0, 255};  // average 85: p = 0.667
  rgb.at<cv::Vec3b>(0, 1) = {255, 255, 200};
  cv::imwrite(dir / "c.png", rgb);
  EXPECT_EQ(load(replaced(kGood, "m.pgm", "c.png")).cells, (std::vector<std::int8_t>{100, 0}));

  cv::Mat rgba(1, 2, CV_8UC4);
  rgba.at<cv::Vec4b>(0, 0) = {0, 0, 0, 100};
  rgba.at<cv::Vec4b>(0, 1) = {0, 0, 0, 255};
  cv::imwrite(dir / "a.png", rgba);
  EXPECT_EQ(load(replaced(kGood, "m.pgm", "a.png") + "mode: scale\n").cells,
            (std::vector<std::int8_t>{-1, 100}));
}

TEST_F(MapFiles, SixteenBitImagesAreScaledDown) {
  cv::Mat deep(1, 3, CV_16UC1);
  deep.at<std::uint16_t>(0, 0) = 0;
  deep.at<std::uint16_t>(0, 1) = 65535;
  deep.at<std::uint16_t>(0, 2) = 205 * 257;
  cv::imwrite(dir / "d.png", deep);
  EXPECT_EQ(load(replaced(kGood, "m.pgm", "d.png")).cells, (std::vector<std::int8_t>{100, 0, -1}));
}

TEST_F(MapFiles, ImageIsRelativeToTheYamlFileOrAbsolute) {
  writeFile(dir / "abs.yaml", replaced(kGood, "m.pgm", dir / "m.pgm"));
  EXPECT_EQ(loadMap(dir / "abs.yaml").cells.size(), 6U);
}

TEST_F(MapFiles, MissingKeysAreNamed) {
  for (const char* key :
       {"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"}) {
    EXPECT_TRUE(refused(replaced(kGood, std::string(key) + ":", std::string("x_") + key + ":"),
                        std::string("key '") + key + "': is missing"));
  }
}

TEST_F(MapFiles, BadNumbersAreNamed) {
  EXPECT_TRUE(refused(replaced(kGood, "0.1\n", "0\n"), "key 'resolution'"));
  EXPECT_TRUE(refused(replaced(kGood, "0.1\n", "-0.1\n"), "key 'resolution'"));
  EXPECT_TRUE(refused(replaced(kGood, "0.1\n", ".nan\n"), "key 'resolution'"));
  EXPECT_TRUE(refused(replaced(kGood, "0.1\n", ".inf\n"), "key 'resolution'"));
  EXPECT_TRUE(refused(replaced(kGood, "0.1\n", "ten\n"), "key 'resolution': 'ten'"));
  EXPECT_TRUE(refused(replaced(kGood, "0.1\n", "[1, 2]\n"), "key 'resolution'"));
  EXPECT_TRUE(refused(replaced(kGood, ", 0.0]", ", .nan]"), "key 'origin'"));
  EXPECT_TRUE(refused(replaced(kGood, ", 0.0]", "]"), "key 'origin': must be [x, y, yaw]"));
  EXPECT_TRUE(refused(replaced(kGood, "[1.0, -2.0, 0.0]", "here"), "key 'origin'"));
}

TEST_F(MapFiles, BadThresholdsAreNamed) {
  EXPECT_TRUE(refused(replaced(kGood, "0.65", "1.5"), "key 'occupied_thresh'"));
  EXPECT_TRUE(refused(replaced(kGood, "0.196", "-0.1"), "key 'free_thresh'"));
  EXPECT_TRUE(refused(replaced(kGood, "0.196", "0.7"), "must not exceed occupied_thresh"));
  EXPECT_TRUE(refused(replaced(kGood, "0.196", ".nan"), "key 'free_thresh'"));
}

TEST_F(MapFiles, BadWordsAreNamed) {
  EXPECT_TRUE(refused(replaced(kGood, "negate: 0", "negate: 2"), "key 'negate'"));
  EXPECT_TRUE(refused(std::string(kGood) + "mode: colourful\n", "key 'mode'"));
  EXPECT_TRUE(refused(replaced(kGood, "m.pgm", "[]"), "key 'image'"));
}

TEST_F(MapFiles, NonsenseInsteadOfYamlIsAnError) {
  EXPECT_TRUE(refused("", "the file is empty"));
  EXPECT_TRUE(refused("just text", "is not a YAML file of keys"));
  EXPECT_TRUE(refused("a: [1, 2\nb: }", "is not YAML"));
  EXPECT_TRUE(refused(std::string(100000, '['), ""));
  EXPECT_TRUE(refused(std::string("\x00\x01\xff\xfe\x80", 5), ""));
}

TEST_F(MapFiles, MissingYamlAndDirectoryAreErrors) {
  EXPECT_THROW(loadMap(dir / "none.yaml"), InputError);
  EXPECT_THROW(loadMap(dir.path()), InputError);
}

TEST_F(MapFiles, BadImagesAreNamed) {
  EXPECT_TRUE(refused(replaced(kGood, "m.pgm", "none.pgm"), "none.pgm: no such image"));
  EXPECT_TRUE(refused(replaced(kGood, "m.pgm", "."), "is a directory"));
  writeFile(dir / "empty.pgm", "");
  EXPECT_TRUE(refused(replaced(kGood, "m.pgm", "empty.pgm"), "is empty"));
  writeFile(dir / "text.pgm", "this is no image");
  EXPECT_TRUE(refused(replaced(kGood, "m.pgm", "text.pgm"), "is not an image"));
}

TEST_F(MapFiles, PgmAsTextWithCommentsAndOtherDepths) {
  writeFile(dir / "t.pgm", "P2 # a comment\n3 2 # another\n255\n0 205 254\n255 50 128");
  EXPECT_EQ(load(replaced(kGood, "m.pgm", "t.pgm")).cells,
            (std::vector<std::int8_t>{0, 100, -1, 100, -1, 0}));
  writeFile(dir / "d.pgm", std::string("P5 1 1 65535\n\xff\xff"));
  EXPECT_EQ(load(replaced(kGood, "m.pgm", "d.pgm")).cells, (std::vector<std::int8_t>{0}));
}

TEST_F(MapFiles, DamagedPgmIsAnError) {
  for (const char* bad : {"P5", "P5 ", "P5 3", "P5 3 2", "P5 0 2 255\n", "P5 3 x 255\n",
                          "P5 3 2 0\n      ", "P5 3 2 70000\n            ", "P5 -3 2 255\n      ",
                          "P2 3 2 255\n1 2 3 4 5", "P2 3 2 255\n1 2 3 4 5 x", "P2 2 1 9\n1 10"}) {
    writeFile(dir / "bad.pgm", bad);
    EXPECT_TRUE(refused(replaced(kGood, "m.pgm", "bad.pgm"), "bad.pgm")) << bad;
  }
}

TEST_F(MapFiles, TruncatedImageIsAnError) {
  cv::Mat noise(50, 50, CV_8UC1);
  cv::randu(noise, 0, 255);
  cv::imwrite(dir / "n.png", noise);
  const std::string png = testing::fileBytes(dir / "n.png");
  writeFile(dir / "cut.png", png.substr(0, png.size() / 2));
  EXPECT_TRUE(refused(replaced(kGood, "m.pgm", "cut.png"), "cut.png: is truncated"));
  writeFile(dir / "cut.pgm", kPgm.substr(0, kPgm.size() - 2));
  EXPECT_TRUE(refused(replaced(kGood, "m.pgm", "cut.pgm"), "cut.pgm: is truncated"));
}

TEST_F(MapFiles, HugeImageIsRefused) {
  writeFile(dir / "m.yaml", kGood);
  EXPECT_NE(messageOf<InputError>([&] { loadMap(dir / "m.yaml", {5}); }).find("3 x 2 pixels"),
            std::string::npos);
  writeFile(dir / "giant.pgm", "P5\n2000000000 2000000000\n255\nx");
  EXPECT_TRUE(refused(replaced(kGood, "m.pgm", "giant.pgm"), "giant.pgm"));
}

TEST_F(MapFiles, RandomBytesNeverCrash) {
  Rng rng(3);
  for (int round = 0; round < 300; ++round) {
    std::string yaml = kGood;
    for (int k = 0; k < 8; ++k) {
      yaml[rng.below(static_cast<std::uint32_t>(yaml.size()))] = static_cast<char>(rng.below(256));
    }
    std::string image = kPgm;
    if (round % 2 == 0) {
      image[rng.below(static_cast<std::uint32_t>(image.size()))] =
          static_cast<char>(rng.below(256));
      yaml = kGood;
    }
    writeFile(dir / "m.pgm", image);
    try {
      load(yaml);
    } catch (const InputError&) {
    }
  }
}

OccupancyGrid randomGrid(MapMode mode) {
  Rng rng(5);
  GridGeometry geometry;
  geometry.width = 37;
  geometry.height = 23;
  geometry.resolution = 0.05;
  geometry.origin = {-12.34, 5.6, 0.7};
  OccupancyGrid grid(geometry);
  for (auto& cell : grid.cells) {
    cell = mode == MapMode::kTrinary ? static_cast<std::int8_t>(rng.below(3)) * 50
                                     : static_cast<std::int8_t>(rng.below(102)) - 1;
    if (mode == MapMode::kTrinary && cell == 50) cell = -1;
  }
  return grid;
}

class MapRoundTrip : public ::testing::TestWithParam<MapMode> {};

TEST_P(MapRoundTrip, KeepsGeometryAndValues) {
  TemporaryDirectory d;
  const OccupancyGrid grid = randomGrid(GetParam());
  saveMap(d / "a map: 1.yaml", grid, GetParam());
  const OccupancyGrid back = loadMap(d / "a map: 1.yaml");
  EXPECT_EQ(back.geometry.width, grid.geometry.width);
  EXPECT_EQ(back.geometry.height, grid.geometry.height);
  EXPECT_EQ(back.geometry.resolution, grid.geometry.resolution);
  EXPECT_EQ(back.geometry.origin.x, grid.geometry.origin.x);
  EXPECT_EQ(back.geometry.origin.y, grid.geometry.origin.y);
  EXPECT_EQ(back.geometry.origin.theta, grid.geometry.origin.theta);
  ASSERT_EQ(back.cells.size(), grid.cells.size());
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    // Scale: 99 needs a grey value exactly at the threshold, which need not exist.
    const int allowed = GetParam() == MapMode::kScale && grid.cells[i] == 99 ? 1 : 0;
    ASSERT_NEAR(back.cells[i], grid.cells[i], allowed) << "cell " << i;
  }
  EXPECT_EQ(d.fileCount(), 2U);
}

INSTANTIATE_TEST_SUITE_P(Modes, MapRoundTrip,
                         ::testing::Values(MapMode::kTrinary, MapMode::kScale, MapMode::kRaw));

TEST(SaveMap, RefusesGridsThatAreNone) {
  TemporaryDirectory d;
  OccupancyGrid grid = randomGrid(MapMode::kTrinary);
  EXPECT_THROW(saveMap(d / "m.pgm", grid), InputError);
  EXPECT_THROW(saveMap(d / "none/m.yaml", grid), InputError);
  EXPECT_THROW(saveMap(d / "m.yaml", OccupancyGrid{}), InputError);
  grid.cells[3] = 101;
  EXPECT_THROW(saveMap(d / "m.yaml", grid), InputError);
  grid.cells.pop_back();
  EXPECT_THROW(saveMap(d / "m.yaml", grid), InputError);
  EXPECT_EQ(d.fileCount(), 0U);
}

TEST(DrawnGrid, FirstRowIsTheUpperOne) {
  const OccupancyGrid grid = testing::drawnGrid({"##?",  //
                                                 "#. "},
                                                0.5);
  EXPECT_EQ(grid.geometry.width, 3);
  EXPECT_EQ(grid.geometry.height, 2);
  EXPECT_EQ(grid.geometry.resolution, 0.5);
  EXPECT_EQ(grid.at({1, 0}), OccupancyGrid::kFree);
  EXPECT_EQ(grid.at({1, 1}), OccupancyGrid::kOccupied);
  EXPECT_EQ(grid.at({2, 0}), OccupancyGrid::kUnknown);
  EXPECT_EQ(testing::drawingOf(grid), (std::vector<std::string>{"##?", "#.?"}));
  EXPECT_THROW(testing::drawnGrid({"##", "#"}), std::logic_error);
  EXPECT_EQ(testing::drawingOf(testing::drawnGrid({"#.", ".#"}, 0.1, {1, 3}, {2, 1})),
            (std::vector<std::string>{"#...", "#...", ".###"}));
  EXPECT_THROW(testing::drawnGrid({"x"}), std::logic_error);
}

}  // namespace
}  // namespace hyselam
