// The tool gr2to as a shell sees it: the files it promises, exit codes, one line of error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "hyselam_common/map_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"
#include "hyselam_gr2to/overview.hpp"
#include "hyselam_gr2to/segmentation/border_model.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header
using hyselam::OccupancyGrid;
using hyselam::testing::fileBytes;

namespace {

/// Two rooms of 5 x 4 m with a door of 1 m, the larger one on the right and higher up.
OccupancyGrid twoRooms() {
  hyselam::GridGeometry g;
  g.width = 260;
  g.height = 140;
  g.resolution = 0.05;
  g.origin = {2.0, -1.0, 0.0};
  OccupancyGrid grid(g);
  const auto fill = [&](int x0, int y0, int x1, int y1, std::int8_t value) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) grid.at({x, y}) = value;
  };
  fill(10, 10, 118, 98, OccupancyGrid::kOccupied);
  fill(114, 10, 250, 130, OccupancyGrid::kOccupied);
  fill(14, 14, 114, 94, OccupancyGrid::kFree);
  fill(118, 14, 246, 126, OccupancyGrid::kFree);
  fill(114, 40, 118, 60, OccupancyGrid::kFree);
  return grid;
}

class Gr2ToTool : public testing::Test {
 protected:
  int run(const std::string& arguments) {
    return hyselam::testing::runProgram(std::string("\"") + HYSELAM_TOOLS + "/gr2to\" " + arguments,
                                        folder_)
        .status;
  }
  /// Of the run that was last.
  void expectError(int status, const std::string& part) {
    EXPECT_TRUE(hyselam::testing::refused({status, "", fileBytes(folder_ / "stderr")}, part));
  }

  hyselam::testing::TemporaryDirectory folder_;
};

}  // namespace

TEST_F(Gr2ToTool, WritesAllFiles) {
  hyselam::saveMap(folder_ / "map.yaml", twoRooms());
  const std::string out = folder_ / "a/b";
  ASSERT_EQ(0, run((folder_ / "map.yaml") + " --graphml --out " + out))
      << fileBytes(folder_ / "stderr");
  EXPECT_EQ("", fileBytes(folder_ / "stderr"));

  const AugmentedTopologicalMap map = loadXml(out + "/topo.xml");
  ASSERT_EQ(2u, map.places.size());
  const cv::Mat labels = cv::imread(out + "/labels.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(CV_16UC1, labels.type());
  ASSERT_EQ(cv::Size(260, 140), labels.size());
  // Row 0 of the image is the highest: the upper left belongs to no place, the upper right does.
  EXPECT_EQ(0, labels.at<std::uint16_t>(20, 60));
  EXPECT_NE(0, labels.at<std::uint16_t>(20, 180));
  EXPECT_NE(0, labels.at<std::uint16_t>(120, 60));
  EXPECT_NE(labels.at<std::uint16_t>(20, 180), labels.at<std::uint16_t>(120, 60));

  std::istringstream doors(fileBytes(out + "/doors.csv"));
  std::string line;
  std::getline(doors, line);
  EXPECT_EQ("x,y,width,real", line);
  ASSERT_TRUE(std::getline(doors, line));
  double x = 0, y = 0, width = 0;
  int real = -1;
  ASSERT_EQ(4, std::sscanf(line.c_str(), "%lf,%lf,%lf,%d", &x, &y, &width, &real)) << line;
  EXPECT_NEAR(2.0 + 0.05 * 116, x, 0.15);
  EXPECT_NEAR(-1.0 + 0.05 * 50, y, 0.1);
  EXPECT_NEAR(1.0, width, 0.1);
  EXPECT_EQ(1, real);
  EXPECT_FALSE(std::getline(doors, line));

  const cv::Mat picture = cv::imread(out + "/overview.png");
  EXPECT_GE(picture.cols, 2000);
  const nlohmann::json summary = nlohmann::json::parse(fileBytes(out + "/summary.json"));
  EXPECT_EQ(2, summary.at("places"));
  EXPECT_EQ(1, summary.at("doors"));
  EXPECT_GT(summary.at("seconds").at("total").get<double>(), 0.0);
  EXPECT_NE(std::string::npos, fileBytes(out + "/topo.graphml").find("<graphml"));
}

TEST_F(Gr2ToTool, SameMapGivesTheSameBytes) {
  hyselam::saveMap(folder_ / "map.yaml", twoRooms());
  for (const char* out : {"a", "b"})
    ASSERT_EQ(0, run((folder_ / "map.yaml") + " --out " + (folder_ / out)));
  for (const char* name : {"topo.xml", "labels.png", "doors.csv", "overview.png"})
    EXPECT_EQ(fileBytes(folder_ / "a" + "/" + name), fileBytes(folder_ / "b" + "/" + name)) << name;
}

TEST_F(Gr2ToTool, RunsThesisMode) {
  hyselam::saveMap(folder_ / "map.yaml", twoRooms());
  ASSERT_EQ(0, run((folder_ / "map.yaml") + " --mode thesis --out " + (folder_ / "out")));
  const nlohmann::json summary =
      nlohmann::json::parse(fileBytes(folder_ / "out" + "/summary.json"));
  EXPECT_EQ("thesis", summary.at("mode"));
}

TEST_F(Gr2ToTool, WidthsOfDoorsOfThesisMode) {
  hyselam::saveMap(folder_ / "map.yaml", twoRooms());
  const auto doors = [&](const std::string& options) {
    EXPECT_EQ(0, run((folder_ / "map.yaml") + " --mode thesis " + options + " --out " +
                     (folder_ / "out")))
        << fileBytes(folder_ / "stderr");
    return nlohmann::json::parse(fileBytes(folder_ / "out" + "/summary.json")).at("doors");
  };
  EXPECT_EQ(1, doors(""));
  EXPECT_EQ(0, doors("--door-max 0.8"));
  EXPECT_EQ(0, doors("--door-min 1.2 --door-max 1.5"));
}

TEST_F(Gr2ToTool, BorderModelOfAFile) {
  hyselam::saveMap(folder_ / "map.yaml", twoRooms());
  const std::string map = folder_ / "map.yaml", model = folder_ / "model.txt";
  hyselam::testing::writeFile(model, BorderModel::shipped().toText());
  ASSERT_EQ(0, run(map + " --out " + (folder_ / "a")));
  ASSERT_EQ(0, run(map + " --border-model " + model + " --out " + (folder_ / "b")));
  EXPECT_EQ(fileBytes(folder_ / "a" + "/topo.xml"), fileBytes(folder_ / "b" + "/topo.xml"));
  // Trees to whom everything is one place.
  const BorderModel joins_all(BoostedTrees({{-1, 1.0, 0}}, {0}), {"-", "-", "-", "-"});
  hyselam::testing::writeFile(model, joins_all.toText());
  ASSERT_EQ(0, run(map + " --border-model " + model + " --out " + (folder_ / "b")));
  EXPECT_EQ(1u, loadXml(folder_ / "b" + "/topo.xml").places.size());
}

TEST_F(Gr2ToTool, RefusesWithOneLine) {
  expectError(run("--out " + (folder_ / "out")), "MAP");
  expectError(run((folder_ / "none.yaml") + " --out " + (folder_ / "out")), "none.yaml");
  expectError(run((folder_ / "none.bt") + " --out " + (folder_ / "out")), "none.bt");
  hyselam::saveMap(folder_ / "map.yaml", twoRooms());
  const std::string map = folder_ / "map.yaml";
  expectError(run(map), "--out");
  expectError(run(map + " --mode best --out " + (folder_ / "out")), "best");
  expectError(run(map + " --clutter -1 --out " + (folder_ / "out")), "clutter");
  expectError(run(map + " --door-max 0.5 --mode thesis --out " + (folder_ / "out")), "door_max");
  expectError(run(map + " --border-model " + map + " --out " + (folder_ / "out")), "map.yaml");
  expectError(run(map + " --picture-side 5 --out " + (folder_ / "out")), "side");
  expectError(run(map + " --out " + map), "map.yaml");
  expectError(run(map + " --max-cells 36399 --out " + (folder_ / "out")), "limit of 36399");
  EXPECT_EQ(0, run(map + " --max-cells 36400 --out " + (folder_ / "out")));
  hyselam::testing::writeFile(folder_ / "bad.yaml", "image: map.pgm\nresolution: zero\n");
  expectError(run((folder_ / "bad.yaml") + " --out " + (folder_ / "out")), "resolution");
  EXPECT_EQ(0, run("--help"));
}

TEST(Overview, MapsOfAnySizeAndWithoutPlaces) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 400}, {900, 2}}) {
    hyselam::GridGeometry g;
    g.width = width;
    g.height = height;
    g.resolution = 0.05;
    const OccupancyGrid grid(g, OccupancyGrid::kFree);
    const cv::Mat picture = drawOverview(grid, gr2to(grid));
    EXPECT_FALSE(picture.empty());
    EXPECT_LT(picture.total(), 30e6);
  }
}

TEST_F(Gr2ToTool, SaysWhatAPersonMayWonderAt) {
  const auto said = [&](const OccupancyGrid& grid) {
    hyselam::saveMap(folder_ / "map.yaml", grid);
    EXPECT_EQ(0, run((folder_ / "map.yaml") + " --out " + (folder_ / "out")));
    return fileBytes(folder_ / "stderr");
  };
  OccupancyGrid grid = twoRooms();
  EXPECT_EQ("", said(grid));
  grid.geometry.resolution = 5.0;
  EXPECT_NE(std::string::npos, said(grid).find("is the resolution of 5 m right?"));
  grid = twoRooms();
  for (std::int8_t& cell : grid.cells)
    if (cell < 0) cell = OccupancyGrid::kOccupied;
  EXPECT_NE(std::string::npos, said(grid).find("no unknown cells"));
  for (std::int8_t& cell : grid.cells) cell = OccupancyGrid::kUnknown;
  EXPECT_NE(std::string::npos, said(grid).find("no cell of the map is free"));
}
