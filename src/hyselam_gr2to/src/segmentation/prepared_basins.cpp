#include "prepared_basins.hpp"

#include <future>
#include <vector>

#include "alongside.hpp"
#include "chamfer_distance.hpp"
#include "furniture.hpp"
#include "straight_corridors.hpp"

namespace hyselam_topo {

PreparedBasins prepareBasins(const hyselam::OccupancyGrid& grid, const SegmentationParams& params,
                             Preparation preparation) {
  PreparedBasins prepared;
  const bool full = preparation == Preparation::kFull;
  prepared.space = findFreeSpace(grid, params, full);
  if (prepared.space.free.empty()) return prepared;
  // The free space alone tells where furniture and corridors are, and where basins.
  std::future<std::vector<StraightCorridor>> corridors;
  if (full) {
    corridors = alongside([&space = prepared.space, &furniture = prepared.context.furniture] {
      furniture = findFurniture(space);
      return findStraightCorridors(space, furniture);
    });
  }
  prepared.clearance = chamferDistance(prepared.space.free);
  BasinParams basins;
  basins.smallest = params.min_place_area;
  prepared.basins = findBasins(prepared.clearance, prepared.space.resolution, basins);
  if (!full) return prepared;
  prepared.context.corridors = cutAlongCorridors(corridors.get(), prepared.clearance,
                                                 prepared.space.resolution, prepared.basins);
  return prepared;
}

}  // namespace hyselam_topo
