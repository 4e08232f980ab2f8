#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <tuple>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_gr2to/octomap/octomap_compression.hpp"
#include "hyselam_gr2to/octomap/octomap_reader.hpp"
#include "hyselam_gr2to/testing/voxel_building.hpp"

namespace hyselam_topo {
namespace {

using hyselam::OccupancyGrid;
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using testing::Building;

/// Boxes and single cells of a seed.
template <typename Tree>
void fill(Tree* tree, unsigned seed) {
  std::mt19937 rng(seed);
  const auto between = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(rng);
  };
  const auto set = [&](int x, int y, int z, float log_odds) {
    const double r = tree->getResolution();
    tree->setNodeValue(octomap::point3d((x + 0.5) * r, (y + 0.5) * r, (z + 0.5) * r), log_odds);
  };
  for (int i = between(1, 300); i > 0; --i) {
    set(between(-40, 40), between(-40, 40), between(-20, 20), 0.1f * between(-19, 34));
  }
  const int x0 = between(-4, 0) * 8;
  for (int x = x0; x < x0 + 16; ++x) {
    for (int y = -8; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) set(x, y, z, -2.0f);
    }
  }
  tree->prune();
}

using Cube = std::tuple<int, int, int, int, float>;

std::set<Cube> cubesOf(const VoxelMap& map) {
  std::set<Cube> cubes;
  for (const VoxelLeaf& leaf : map.leaves) {
    cubes.insert({leaf.x, leaf.y, leaf.z, leaf.size, leaf.probability});
  }
  return cubes;
}

/// What liboctomap holds.
template <typename Tree>
std::set<Cube> cubesOf(const Tree& tree, bool binary) {
  std::set<Cube> cubes;
  for (auto it = tree.begin_leafs(); it != tree.end_leafs(); ++it) {
    const auto key = it.getIndexKey();
    const int size = 1 << (tree.getTreeDepth() - it.getDepth());
    const auto low = [&](unsigned k) { return static_cast<int>(key[k]) - 32768; };
    const float p =
        binary ? (tree.isNodeOccupied(*it) ? 1.0f : 0.0f)
               : static_cast<float>(1.0 - 1.0 / (1.0 + std::exp(double{it->getLogOdds()})));
    cubes.insert({low(0), low(1), low(2), size, p});
  }
  return cubes;
}

TEST(OctoMapReader, AgreesWithTheLibraryOnRandomTrees) {
  const TemporaryDirectory dir;
  for (unsigned seed = 0; seed < 20; ++seed) {
    octomap::OcTree tree(0.05);
    fill(&tree, seed);
    ASSERT_TRUE(tree.write(dir / "t.ot"));
    EXPECT_EQ(cubesOf(loadOctoMap(dir / "t.ot")), cubesOf(tree, false)) << seed;
    // Files of type .bt hold the most likely state; the library prunes anew for them.
    tree.toMaxLikelihood();
    tree.prune();
    ASSERT_TRUE(tree.writeBinary(dir / "t.bt"));
    EXPECT_EQ(cubesOf(loadOctoMap(dir / "t.bt")), cubesOf(tree, true)) << seed;
    EXPECT_EQ(loadOctoMap(dir / "t.bt").resolution, 0.05);

    octomap::ColorOcTree colour(0.1);
    fill(&colour, seed);
    ASSERT_TRUE(colour.write(dir / "c.ot"));
    EXPECT_EQ(cubesOf(loadOctoMap(dir / "c.ot")), cubesOf(colour, false)) << seed;
  }
}

TEST(OctoMapReader, ReadsTheDataOfMessages) {
  octomap::OcTree tree(0.05);
  fill(&tree, 7);
  std::ostringstream full;
  tree.writeData(full);
  EXPECT_EQ(cubesOf(octoMapFromData(full.str(), false, "OcTree", 0.05, "octomap")),
            cubesOf(tree, false));
  tree.toMaxLikelihood();
  tree.prune();
  std::ostringstream binary;
  tree.writeBinaryData(binary);
  EXPECT_EQ(cubesOf(octoMapFromData(binary.str(), true, "OcTree", 0.05, "octomap")),
            cubesOf(tree, true));
  EXPECT_TRUE(octoMapFromData("", true, "OcTree", 0.05, "octomap").leaves.empty());
}

std::string exampleFile() {
  const TemporaryDirectory dir;
  octomap::OcTree tree(0.05);
  fill(&tree, 3);
  tree.writeBinary(dir / "t.bt");
  return fileBytes(dir / "t.bt");
}

std::string errorOf(const std::string& bytes, const OctoMapLimits& limits = {}) {
  return messageOf<hyselam::InputError>([&] { parseOctoMap(bytes, "t.bt", limits); });
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

void expectIn(const std::string& part, const std::string& message) {
  EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
}

TEST(OctoMapReader, DamagedFilesAreRefused) {
  const std::string good = exampleFile();
  EXPECT_EQ(errorOf(good), "");
  const std::size_t data = good.find("data\n") + 5;
  for (const std::size_t cut : {data, data + 1, data + 7, good.size() - 2}) {
    expectIn("cut off", errorOf(good.substr(0, cut)));
  }
  expectIn("after the tree", errorOf(good + "x"));
  expectIn("no line 'data'", errorOf(good.substr(0, data - 3)));
  expectIn("no OctoMap", errorOf("P5 3 3 255 "));
  expectIn("no OctoMap", errorOf(""));
  expectIn("resolution", errorOf(with(good, "res 0.05", "res 0")));
  expectIn("no number", errorOf(with(good, "res 0.05", "res nan")));
  expectIn("resolution", errorOf(with(good, "res 0.05", "res 1e9")));
  expectIn("not known", errorOf(with(good, "id OcTree", "id Quadtree")));
  expectIn("nodes", errorOf(with(good, "size ", "size 1")));
  expectIn("'colour' is not known", errorOf(with(good, "size ", "colour red\nsize ")));
  EXPECT_NE(messageOf<hyselam::InputError>([] { loadOctoMap("/nowhere/t.bt"); }), "");
}

TEST(OctoMapReader, EndlessDescentIsRefused) {
  const std::string header = "# Octomap OcTree binary file\nid OcTree\nsize 1\nres 0.1\ndata\n";
  expectIn("deeper than 16", errorOf(header + std::string(1000000, '\xff')));
  const std::string full = "# Octomap OcTree file\nid OcTree\nsize 1\nres 0.1\ndata\n";
  expectIn("deeper than 16", errorOf(full + std::string(1000000, '\x01')));
}

TEST(OctoMapReader, TooMuchIsRefused) {
  OctoMapLimits limits;
  limits.max_leaves = 10;
  expectIn("more than 10 leaves", errorOf(exampleFile(), limits));
  limits = {};
  limits.max_bytes = 100;
  expectIn("more than 100", errorOf(exampleFile(), limits));
}

TEST(OctoMapReader, RandomDamageNeverCrashes) {
  const std::string good = exampleFile();
  std::mt19937 rng(5);
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = good;
    for (int k = 0; k < 3; ++k) bytes[rng() % bytes.size()] = static_cast<char>(rng());
    if (rng() % 2 == 0) bytes.resize(rng() % bytes.size());
    errorOf(bytes);
  }
}

// ---- Compression ------------------------------------------------------------------------------

std::int8_t valueAt(const OccupancyGrid& grid, double x, double y) {
  return grid.valueOr(grid.geometry.cellAt({x, y}));
}

TEST(Compression, RemovesFurnitureKeepsWallsAndDoors) {
  Building building(0.1);
  building.addStorey(0.0);
  const Compression result = compress(building.map(), {}, "building");
  ASSERT_EQ(result.storeys.size(), 1u);
  EXPECT_NEAR(result.storeys[0].floor, 0.0, 1e-6);
  EXPECT_NEAR(result.storeys[0].ceiling, 2.6, 1e-6);
  const OccupancyGrid& grid = result.grid;
  EXPECT_EQ(valueAt(grid, 1.0, 1.0), OccupancyGrid::kFree);      // table
  EXPECT_EQ(valueAt(grid, 4.75, 2.5), OccupancyGrid::kFree);     // cupboard
  EXPECT_EQ(valueAt(grid, 3.0, 1.5), OccupancyGrid::kFree);      // door
  EXPECT_EQ(valueAt(grid, 3.0, 3.0), OccupancyGrid::kOccupied);  // wall
  EXPECT_EQ(valueAt(grid, -0.05, 2.0), OccupancyGrid::kOccupied);
  EXPECT_EQ(valueAt(grid, 9.0, 2.0), OccupancyGrid::kUnknown);
  // A planar sensor sees the furniture.
  const OccupancyGrid seen = slice(building.map(), 0.3, 1.0, "building");
  EXPECT_EQ(valueAt(seen, 1.0, 1.0), OccupancyGrid::kOccupied);
  EXPECT_EQ(valueAt(seen, 4.75, 2.5), OccupancyGrid::kOccupied);
  EXPECT_EQ(valueAt(seen, 2.0, 2.0), OccupancyGrid::kFree);
}

TEST(Compression, SeveralStoreysMustBeChosen) {
  Building building(0.1);
  for (const double z : {-3.0, 0.0, 3.0}) building.addStorey(z);
  const VoxelMap map = building.map();
  const auto storeys = findStoreys(map);
  ASSERT_EQ(storeys.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(storeys[i].floor, -3.0 + 3.0 * static_cast<double>(i), 1e-6);
    EXPECT_NEAR(storeys[i].ceiling, -0.4 + 3.0 * static_cast<double>(i), 1e-6);
  }
  const std::string message =
      messageOf<hyselam::InputError>([&] { compress(map, {}, "building.bt"); });
  expectIn("building.bt", message);
  expectIn("3 storeys (0: -3.00 to -0.40 m, 1: 0.00 to 2.60 m", message);
  CompressionParams params;
  params.storey = 1;
  EXPECT_NEAR(compress(map, params, "b").z_min, 0.25, 1e-6);
  params.storey = 3;
  expectIn("no storey 3", messageOf<hyselam::InputError>([&] { compress(map, params, "b"); }));
  params = {};
  params.z_min = 3.2;
  params.z_max = 5.4;
  EXPECT_EQ(valueAt(compress(map, params, "b").grid, 3.0, 1.5), OccupancyGrid::kFree);
}

TEST(Compression, RefusesWhatCannotBeProjected) {
  VoxelMap empty;
  expectIn("no level floor", messageOf<hyselam::InputError>([&] { compress(empty, {}, "m"); }));
  CompressionParams params;
  params.z_min = 0.0;
  params.z_max = 2.0;
  expectIn("no cells between z = 0 and 2 m",
           messageOf<hyselam::InputError>([&] { compress(empty, params, "m"); }));
  VoxelMap huge;
  huge.leaves = {{-32768, -32768, 0, 1, 1.0f}, {32767, 32767, 0, 1, 1.0f}};
  expectIn("too large: 65536 x 65536",
           messageOf<hyselam::InputError>([&] { compress(huge, params, "m"); }));
  params.z_max = -1.0;
  EXPECT_THROW(compress(huge, params, "m"), hyselam::ParameterError);
  params = {};
  params.free_below = 0.7;
  EXPECT_THROW(compress(huge, params, "m"), hyselam::ParameterError);
  params = {};
  params.max_free_height = -1.0;
  EXPECT_THROW(compress(huge, params, "m"), hyselam::ParameterError);
}

/// Eq. 4.1 cell by cell, with the filter.
OccupancyGrid projectedByHand(const VoxelMap& map, const CompressionParams& p,
                              const hyselam::GridGeometry& geometry) {
  OccupancyGrid grid(geometry);
  const auto base = [&](double v) { return static_cast<int>(std::lround(v / map.resolution)); };
  std::map<std::pair<int, int>, std::pair<int, int>> columns;
  for (const VoxelLeaf& leaf : map.leaves) {
    for (int x = leaf.x; x < leaf.x + leaf.size; ++x) {
      for (int y = leaf.y; y < leaf.y + leaf.size; ++y) {
        for (int z = leaf.z; z < leaf.z + leaf.size; ++z) {
          if (z < base(*p.z_min) || z >= base(*p.z_max)) continue;
          auto& [occupied, free] = columns[{x, y}];
          if (leaf.probability >= p.occupied_from) ++occupied;
          if (leaf.probability <= p.free_below) ++free;
        }
      }
    }
  }
  for (const auto& [column, counts] : columns) {
    const hyselam::Cell c{column.first - base(geometry.origin.x),
                          column.second - base(geometry.origin.y)};
    if (!geometry.contains(c)) continue;
    if (counts.second * map.resolution > p.max_free_height + 1e-9) {
      grid.at(c) = OccupancyGrid::kFree;
    } else if (counts.first * map.resolution > p.min_occupied_height + 1e-9) {
      grid.at(c) = OccupancyGrid::kOccupied;
    }
  }
  const OccupancyGrid raw = grid;
  for (int y = 0; y < geometry.height; ++y) {
    for (int x = 0; x < geometry.width; ++x) {
      bool lonely = true;
      for (int k = 0; k < 9; ++k) {
        if (k != 4 && raw.valueOr({x + k % 3 - 1, y + k / 3 - 1}) == raw.at({x, y})) lonely = false;
      }
      if (lonely) grid.at({x, y}) = OccupancyGrid::kUnknown;
    }
  }
  return grid;
}

TEST(Compression, AgreesWithCountingByHand) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    octomap::OcTree tree(0.1);
    fill(&tree, seed);
    std::ostringstream data;
    tree.writeData(data);
    const VoxelMap map = octoMapFromData(data.str(), false, "OcTree", 0.1, "m");
    CompressionParams params;
    params.z_min = -0.5 - 0.1 * (seed % 3);
    params.z_max = 0.4 + 0.1 * (seed % 7);
    params.max_free_height = 0.1 * (seed % 5);
    params.min_occupied_height = 0.1 * (seed % 2);
    const OccupancyGrid grid = compress(map, params, "m").grid;
    EXPECT_EQ(grid.cells, projectedByHand(map, params, grid.geometry).cells) << seed;
  }
}

std::size_t count(const OccupancyGrid& grid, std::int8_t value) {
  return static_cast<std::size_t>(std::count(grid.cells.begin(), grid.cells.end(), value));
}

TEST(Compression, RemovesFurnitureOfRealOctoMaps) {
  HYSELAM_NEED_DATA(data);
  for (const char* name : {"geb079.bt", "fr_079.bt"}) {
    const VoxelMap map = loadOctoMap(data + "/octomaps/" + name);
    const Compression result = compress(map, {}, name);
    ASSERT_EQ(result.storeys.size(), 1u);
    EXPECT_NEAR(result.storeys[0].ceiling - result.storeys[0].floor, 2.65, 0.15) << name;
    const OccupancyGrid before = slice(map, result.z_min + 0.1, result.z_min + 1.0, name);
    // Furniture takes most of the occupied cells at the height of a table.
    EXPECT_LT(2 * count(result.grid, OccupancyGrid::kOccupied),
              count(before, OccupancyGrid::kOccupied))
        << name;
    EXPECT_GT(count(result.grid, OccupancyGrid::kFree),
              count(before, OccupancyGrid::kFree) * 8 / 10)
        << name;
  }
}

TEST(Compression, RealOctoMapsOfOtherKinds) {
  HYSELAM_NEED_DATA(data);
  const auto load = [&](const char* name) { return loadOctoMap(data + "/octomaps/" + name); };
  // One office, a ColorOcTree of which only the bits are there.
  const Compression office = compress(load("freiburg1_360.bt"), {}, "office");
  EXPECT_NEAR(office.storeys.at(0).floor, 0.05, 0.1);
  EXPECT_NEAR(office.storeys.at(0).ceiling, 2.9, 0.1);
  // A room whose floor is not level in the map.
  const VoxelMap room = load("fr_078_tidyup.bt");
  expectIn("no level floor: give z_min and z_max",
           messageOf<hyselam::InputError>([&] { compress(room, {}, "room"); }));
  CompressionParams params;
  params.z_min = 0.1;
  params.z_max = 2.2;
  EXPECT_GT(count(compress(room, params, "room").grid, OccupancyGrid::kFree), 10000u);
  // Out of doors: large, but it can be projected.
  EXPECT_GT(compress(load("fr_campus.bt"), {}, "campus").grid.cells.size(), 1000000u);
}

}  // namespace
}  // namespace hyselam_topo
