// The free-space density of every cell of a map (thesis 3.2.3 and 3.3.1), and its gradient.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "fsd_localization/density/free_space_density.hpp"
#include "fsd_localization/density/occupancy_thresholds.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

/// @throws hyselam::InputError for a grid whose cell count does not fit its size.
FreeSpaceGrid freeSpaceOf(const hyselam::OccupancyGrid& map,
                          const OccupancyThresholds& thresholds = {});

/// Density of each cell, row-major, in [0, 1]; 0 where the cell is not free.
struct DensityField {
  int width = 0;
  int height = 0;
  std::vector<float> values;

  float at(int x, int y) const {
    return x < 0 || y < 0 || x >= width || y >= height
               ? 0.0F
               : values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x)];
  }
};

/// Soft density of every free cell: on a fully known map the hard one (3.3.1).
/// @param threads 0: as many as the machine has cores. The result does not depend on it.
/// @param progress called repeatedly with the share done, 0..1, from the calling thread; may be
/// empty.
DensityField densityField(const FreeSpaceGrid& space, const Kernel& kernel, int threads = 0,
                          const std::function<void(double)>& progress = {});

struct GradientParams {
  double max_direction_spread = hyselam::radians(20.0);  ///< to the 8 neighbours [rad]
  double min_slope = 0.02;  ///< density change per metre below which there is no direction [1/m]

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError naming the first value out of range.
  void validate() const;
};

/// Where the density falls steepest at the centre of a 5x5 patch of densities (row-major, y
/// upwards), by the Sobel operator; empty unless the direction is stable: slope above the floor,
/// and direction within the spread, for the centre and each of its 8 neighbours. [rad], in the
/// grid's axes.
std::optional<double> stableDescent(const float* patch, int row_stride, double resolution,
                                    const GradientParams& params);

}  // namespace fsd_localization
