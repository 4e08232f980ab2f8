// How open is a place? The share of free space that can be reached within 1 m of two cells.
#include <cstdio>

#include "fsd_localization/density/density_field.hpp"
#include "fsd_localization/density/frontier_count.hpp"

int main() {
  hyselam::GridGeometry geometry;  // a room of 8 x 8 m with a corridor of 1 m to the east
  geometry.width = 160;
  geometry.height = 80;
  geometry.resolution = 0.1;
  hyselam::OccupancyGrid map(geometry, 100);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 160; ++x) {
      if (x < 80 || (y >= 35 && y < 45)) map.at({x, y}) = 0;
    }
  }
  const fsd_localization::FreeSpaceGrid space = fsd_localization::freeSpaceOf(map);
  const fsd_localization::FreeSpaceDensity density(
      fsd_localization::Kernel({fsd_localization::KernelProfile::kUniform, 1.0}, 0.1));
  for (const hyselam::Cell cell : {hyselam::Cell{40, 40}, hyselam::Cell{120, 40}}) {
    std::printf("density %.2f, frontiers %d\n", density.soft(space, cell),
                frontierCount(density, space, cell));
  }
}
