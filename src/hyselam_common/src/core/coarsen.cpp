#include "hyselam_common/coarsen.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam {

OccupancyGrid coarsen(const OccupancyGrid& map, int factor) {
  if (factor < 1) throw ParameterError("factor", factor, ">= 1");
  GridGeometry g = map.geometry;
  g.width = (g.width + factor - 1) / factor;
  g.height = (g.height + factor - 1) / factor;
  g.resolution *= factor;
  OccupancyGrid coarse(g);
  for (int y = 0; y < map.geometry.height; ++y)
    for (int x = 0; x < map.geometry.width; ++x) {
      std::int8_t& block = coarse.at({x / factor, y / factor});
      block = std::max(block, map.at({x, y}));
    }
  return coarse;
}

int coarseningFactor(double resolution, double wanted) {
  return std::max(1, static_cast<int>(std::floor(wanted / resolution + 1e-6)));
}

}  // namespace hyselam
