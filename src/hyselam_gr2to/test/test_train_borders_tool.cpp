// The tool train_borders: the same data and the same command give the bytes that are stored.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "hyselam_common/map_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/temporary_directory.hpp"
#include "hyselam_gr2to/segmentation/border_model.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header
using hyselam::testing::fileBytes;

namespace {

int run(const std::string& arguments, const std::string& log) {
  const std::string command =
      std::string("\"") + HYSELAM_TOOLS + "/train_borders\" " + arguments + " >" + log + " 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST(TrainBordersTool, TrainingAgainGivesTheStoredBytes) {
  hyselam::testing::TemporaryDirectory folder;
  const std::string stored = HYSELAM_PACKAGE_DIR "/test/data/border_trees_of_two_floors.txt";
  const std::string trained = folder / "border_trees.txt", log = folder / "log";
  ASSERT_EQ(0, run("--plans 2 --rounds 2 --trees 4 --out " + trained, log)) << fileBytes(log);
  EXPECT_EQ(fileBytes(stored), fileBytes(trained));
  EXPECT_EQ(4u, BorderModel::load(trained).trees().roots().size());
}

// Given maps are examples at three scales, where a cell is no longer that of the working
// resolution.
TEST(TrainBordersTool, TrainsOnGivenMapsToo) {
  hyselam::testing::TemporaryDirectory folder;
  hyselam::GridGeometry g;
  g.width = 220;
  g.height = 120;
  g.resolution = 0.05;
  hyselam::OccupancyGrid grid(g, hyselam::OccupancyGrid::kUnknown);
  cv::Mat rooms(g.height, g.width, CV_8U, cv::Scalar(0));
  for (int y = 10; y < 110; ++y)
    for (int x = 10; x < 210; ++x) {
      const bool rim = y < 14 || y >= 106 || x < 14 || x >= 206;
      const bool wall = rim || (x >= 100 && x < 104 && (y < 50 || y >= 70));
      grid.at({x, y}) = wall ? hyselam::OccupancyGrid::kOccupied : hyselam::OccupancyGrid::kFree;
      if (!wall) rooms.at<std::uint8_t>(g.height - 1 - y, x) = x < 102 ? 1 : 2;
    }
  hyselam::saveMap(folder / "map.yaml", grid);
  cv::imwrite(folder / "rooms.png", rooms);
  std::ofstream(folder / "index.csv") << "name,map,yaml,gt,resolution,kind,building,gt_rooms\n"
                                      << "two,map.pgm,map.yaml,rooms.png,0.05,unfurnished,two,2\n";
  const std::string trained = folder / "border_trees.txt", log = folder / "log";
  ASSERT_EQ(0, run((folder / "") + " --plans 1 --rounds 1 --trees 2 --out " + trained, log))
      << fileBytes(log);
  EXPECT_NE(std::string::npos, fileBytes(trained).find("1 maps")) << fileBytes(trained);
}

TEST(TrainBordersTool, NamesWhatCannotBeUsed) {
  hyselam::testing::TemporaryDirectory folder;
  const std::string log = folder / "log";
  EXPECT_EQ(2, run((folder / "none") + " --plans 0", log));
  EXPECT_NE(std::string::npos, fileBytes(log).find("index.csv")) << fileBytes(log);
  EXPECT_EQ(2, run("--plans 1 --without width", log));
  EXPECT_NE(std::string::npos, fileBytes(log).find("width")) << fileBytes(log);
  EXPECT_EQ(2, run("--plans 0", log));
}
