// OctoMap compression, the first stage of Gr2To (dos Santos 2014, section 4.2, Eq. 4.1): a 3D
// occupancy map is projected to a grid map without the furniture, which does not reach from the
// floor to the ceiling as walls do.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_gr2to/octomap/octomap_reader.hpp"

namespace hyselam_topo {

/// The space between a floor and what is above it.
struct Storey {
  double floor = 0.0;    ///< height of the floor's upper side [m]
  double ceiling = 0.0;  ///< height of the ceiling's lower side, or of the highest cell known [m]
  double area = 0.0;     ///< free area 1 m above the floor [m^2]
};

/// The storeys of a building, lowest first: between layers that are occupied over a large area,
/// at least 1.8 m apart. Empty if there is no such layer (a hillside, a slice without floor).
std::vector<Storey> findStoreys(const VoxelMap& map);

struct CompressionParams {
  /// The interval of heights that is projected, [z_min, z_max] in the frame of the map [m]. What is
  /// missing comes from the storey: `floor_margin` above its floor, `ceiling_margin` below its
  /// ceiling or `max_height` above its floor.
  std::optional<double> z_min;
  std::optional<double> z_max;
  double floor_margin = 0.25;    ///< [m] 0 .. 10
  double ceiling_margin = 0.25;  ///< [m] 0 .. 10
  double max_height = 3.0;       ///< of the interval above the floor, in high halls [m] > 0
  int storey = -1;               ///< from 0 for the lowest; -1: the only one
  /// NF_max: a column with a larger free height is free. [m] 0 .. 100
  double max_free_height = 0.5;
  /// NO_min: a column is occupied with more than this occupied height, if it is not free. [m] 0 ..
  /// 100
  double min_occupied_height = 0.3;
  /// P_max: cells of up to this probability count as free. [0, 1)
  double free_below = 0.4;
  /// P_min: cells of at least this probability count as occupied. (free_below, 1]
  double occupied_from = 0.6;
  /// Isolated cells, occupied or free, without one of their kind around, become unknown.
  bool filter = true;
  std::size_t max_cells = std::size_t{1} << 26;  ///< of the grid; more are refused

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

struct Compression {
  hyselam::OccupancyGrid grid;  ///< axes and frame as of the OctoMap
  double z_min = 0.0;           ///< the interval of heights that was projected [m]
  double z_max = 0.0;
  std::vector<Storey> storeys;  ///< all of the map; empty if z_min and z_max were given
};

/// Eq. 4.1: free where the free height exceeds max_free_height, else occupied where the occupied
/// height exceeds min_occupied_height, else unknown; then the filter. @throws hyselam::InputError,
/// beginning with `source`, for a map without cells in the interval, one with several storeys of
/// which none is chosen or none at all while z_min or z_max is missing, and one that needs more
/// than max_cells; hyselam::ParameterError for parameters out of range.
Compression compress(const VoxelMap& map, const CompressionParams& params,
                     const std::string& source);

/// What a planar sensor between two heights [m] measures: occupied where any cell is, else free
/// where any cell is. For comparison. @throws as compress().
hyselam::OccupancyGrid slice(const VoxelMap& map, double z_min, double z_max,
                             const std::string& source,
                             std::size_t max_cells = std::size_t{1} << 26);

}  // namespace hyselam_topo
