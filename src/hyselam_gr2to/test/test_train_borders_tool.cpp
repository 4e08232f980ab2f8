// The tool train_borders: the same data and the same command give the bytes that are stored.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

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

TEST(TrainBordersTool, NamesWhatCannotBeUsed) {
  hyselam::testing::TemporaryDirectory folder;
  const std::string log = folder / "log";
  EXPECT_EQ(2, run((folder / "none") + " --plans 0", log));
  EXPECT_NE(std::string::npos, fileBytes(log).find("index.csv")) << fileBytes(log);
  EXPECT_EQ(2, run("--plans 1 --without width", log));
  EXPECT_NE(std::string::npos, fileBytes(log).find("width")) << fileBytes(log);
  EXPECT_EQ(2, run("--plans 0", log));
}
