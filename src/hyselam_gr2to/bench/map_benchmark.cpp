// What is done with a topological map once it is there: files, new segmentations, look-ups.
#include <benchmark/benchmark.h>

#include <string>

#include "hyselam_gr2to/octomap/octomap_compression.hpp"
#include "hyselam_topological_map/carry_over.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace {

using namespace hyselam_topo;  // NOLINT: a program, not a header

/// `side` x `side` cells of 5 cm in rooms of 5 m x 5 m with walls and doors.
AugmentedTopologicalMap building(int side) {
  constexpr int kRoom = 100;
  AugmentedTopologicalMap map;
  PlaceGrid grid;
  grid.geometry.width = grid.geometry.height = side;
  grid.geometry.resolution = 0.05;
  grid.labels.resize(grid.geometry.cellCount());
  const int rooms = side / kRoom;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const bool wall = x % kRoom < 2 || y % kRoom < 2;
      grid.labels[grid.geometry.index({x, y})] =
          wall ? std::uint16_t{0} : static_cast<std::uint16_t>(1 + x / kRoom + rooms * (y / kRoom));
    }
  }
  for (int r = 0; r < rooms * rooms; ++r) {
    const int column = r % rooms, row = r / rooms;
    const double x = 5.0 * column, y = 5.0 * row;
    Place place;
    place.id = map.next_place_id++;
    place.area = 24.0;
    place.centre = Point3{x + 2.5, y + 2.5, 0.0};
    place.outline = {{x, y}, {x + 5, y}, {x + 5, y + 5}, {x, y + 5}};
    for (std::size_t k = 0; k < 4; ++k) {
      Wall wall = straightWall(place.outline[k], place.outline[(k + 1) % 4]);
      wall.id = map.next_wall_id++;
      wall.position_covariance = Covariance3{1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 0};
      place.walls.push_back(wall);
    }
    grid.places.push_back(place.id);
    map.places.push_back(place);
    if (r % rooms > 0) {
      Edge edge;
      edge.a = place.id - 1;
      edge.b = place.id;
      Door door = doorBetween({x, y + 2}, {x, y + 3});
      door.id = map.next_door_id++;
      edge.doors = {door};
      map.edges.push_back(edge);
    }
  }
  map.grid = grid;
  normalize(map);
  return map;
}

void writeXml(benchmark::State& state) {
  const auto map = building(static_cast<int>(state.range(0)));
  std::size_t bytes = 0;
  for (auto _ : state) benchmark::DoNotOptimize(bytes = toXml(map).size());
  state.counters["bytes"] = static_cast<double>(bytes);
  state.counters["places"] = static_cast<double>(map.places.size());
}
BENCHMARK(writeXml)->Arg(1000)->Arg(4000)->Unit(benchmark::kMillisecond);

void readXml(benchmark::State& state) {
  const std::string text = toXml(building(static_cast<int>(state.range(0))));
  for (auto _ : state) benchmark::DoNotOptimize(fromXml(text));
}
BENCHMARK(readXml)->Arg(1000)->Arg(4000)->Unit(benchmark::kMillisecond);

void carryOverIds(benchmark::State& state) {
  const auto map = building(static_cast<int>(state.range(0)));
  auto moved = map;
  moved.grid->geometry.origin = {0.03, -0.02, 0.001};
  for (auto _ : state) benchmark::DoNotOptimize(carryOver(map, moved));
}
BENCHMARK(carryOverIds)->Arg(1000)->Arg(4000)->Unit(benchmark::kMillisecond);

void findPlaceAtPoint(benchmark::State& state) {
  const auto map = building(1000);
  double x = 0.0;
  for (auto _ : state) {
    x = x > 49.0 ? 0.0 : x + 0.37;
    benchmark::DoNotOptimize(placeAt(map, {x, 12.3}, 0.5));
  }
}
BENCHMARK(findPlaceAtPoint);

/// A storey of one-cell leaves, as after a drive: floor, ceiling, walls each 5 m, free between.
VoxelMap storey(int side) {
  VoxelMap map;
  map.resolution = 0.05;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const bool wall = x % 100 < 2 || y % 100 < 2;
      for (int z = -1; z < 52; ++z) {
        map.leaves.push_back({x, y, z, 1, wall || z < 0 || z == 51 ? 1.0f : 0.0f});
      }
    }
  }
  return map;
}

void pressStorey(benchmark::State& state) {
  const VoxelMap map = storey(300);
  for (auto _ : state) benchmark::DoNotOptimize(compress(map, {}, "storey"));
  state.counters["leaves"] = static_cast<double>(map.leaves.size());
}
BENCHMARK(pressStorey)->Unit(benchmark::kMillisecond);

}  // namespace
