#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include "hyselam_common/map_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"
#include "hyselam_gr2to/testing/voxel_building.hpp"

namespace hyselam_topo {
namespace {

using hyselam::OccupancyGrid;
using hyselam::testing::fileBytes;
using hyselam::testing::TemporaryDirectory;
using testing::Building;

void expectIn(const std::string& part, const std::string& message) {
  EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
}

std::int8_t valueAt(const OccupancyGrid& grid, double x, double y) {
  return grid.valueOr(grid.geometry.cellAt({x, y}));
}

/// The exit status of octomap_to_map.
int octomapToMap(const TemporaryDirectory& dir, const std::string& arguments) {
  return hyselam::testing::runProgram("'" HYSELAM_TOOLS "/octomap_to_map' " + arguments, dir)
      .status;
}

TEST(OctomapToMap, WritesMapAndPictureOrRefuses) {
  const TemporaryDirectory dir;
  octomap::OcTree tree(0.1);
  Building building(0.1);
  building.addStorey(0.0);
  for (const VoxelLeaf& leaf : building.map().leaves) {
    tree.setNodeValue(
        octomap::point3d(0.1f * (leaf.x + 0.5f), 0.1f * (leaf.y + 0.5f), 0.1f * (leaf.z + 0.5f)),
        leaf.probability > 0.5f ? 2.0f : -2.0f);
  }
  ASSERT_TRUE(tree.writeBinary(dir / "b.bt"));
  const std::string in = "'" + (dir / "b.bt") + "' ", out = "'" + (dir / "m.yaml") + "' ";
  EXPECT_EQ(octomapToMap(dir, "--help"), 0);
  EXPECT_EQ(octomapToMap(dir, in), 2);
  EXPECT_EQ(octomapToMap(dir, in + out + "--picture '" + (dir / "m.png") + "'"), 0)
      << fileBytes(dir / "stderr");
  EXPECT_EQ(valueAt(hyselam::loadMap(dir / "m.yaml"), 1.0, 1.0), OccupancyGrid::kFree);
  EXPECT_GT(fileBytes(dir / "m.png").size(), 500u);
  EXPECT_EQ(octomapToMap(dir, in + out + "--storey 3"), 2);
  expectIn("error: " + (dir / "b.bt") + ": there is no storey 3", fileBytes(dir / "stderr"));
  EXPECT_EQ(octomapToMap(dir, in + out + "--max-free-height -1"), 2);
  EXPECT_EQ(octomapToMap(dir, "/nowhere/b.bt " + out), 2);
  EXPECT_EQ(octomapToMap(dir, in + "/nowhere/m.yaml"), 2);
}

}  // namespace
}  // namespace hyselam_topo
