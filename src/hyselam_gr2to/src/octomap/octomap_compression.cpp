#include "hyselam_gr2to/octomap/octomap_compression.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/require.hpp"

namespace hyselam_topo {
namespace {

using hyselam::formatNumber;
using hyselam::OccupancyGrid;

/// The layers of cells with lower side >= z_min and upper side <= z_max, as [first, end).
struct Layers {
  std::int32_t first = 0;
  std::int32_t end = 0;
};

Layers layersBetween(double z_min, double z_max, double resolution) {
  constexpr double kLimit = 40000.0;  // beyond the cells of any tree
  const double slack = 1e-6;          // heights that are multiples of the resolution count fully
  const double first = std::ceil(z_min / resolution - slack);
  const double end = std::floor(z_max / resolution + slack);
  return {static_cast<std::int32_t>(std::clamp(first, -kLimit, kLimit)),
          static_cast<std::int32_t>(std::clamp(end, -kLimit, kLimit))};
}

/// How many cells of a leaf lie in the layers.
std::int32_t height(const VoxelLeaf& leaf, const Layers& layers) {
  return std::min(leaf.z + leaf.size, layers.end) - std::max(leaf.z, layers.first);
}

/// Counts over columns, filled by squares: additions at the four corners, summed up at the end, so
/// that a large leaf costs as much as a small one.
class ColumnCounts {
 public:
  ColumnCounts(int width, int height)
      : stride_(static_cast<std::size_t>(width) + 1),
        rows_(static_cast<std::size_t>(height) + 1),
        counts_(stride_ * rows_, 0) {}

  void add(int x, int y, int size, std::int32_t value) {
    at(x, y) += value;
    at(x + size, y) -= value;
    at(x, y + size) -= value;
    at(x + size, y + size) += value;
  }
  void finish() {
    for (std::size_t y = 0; y < rows_; ++y) {
      std::int32_t row = 0;
      for (std::size_t x = 0; x < stride_; ++x) {
        row += counts_[y * stride_ + x];
        counts_[y * stride_ + x] = row + (y > 0 ? counts_[(y - 1) * stride_ + x] : 0);
      }
    }
  }
  std::int32_t operator()(int x, int y) const {
    return counts_[static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x)];
  }

 private:
  std::int32_t& at(int x, int y) {
    return counts_[static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x)];
  }
  std::size_t stride_, rows_;
  std::vector<std::int32_t> counts_;
};

/// Occupied and free cells of all columns in an interval of heights, and the columns that are
/// known at any height of it.
struct Columns {
  hyselam::GridGeometry geometry;
  ColumnCounts occupied{0, 0}, free{0, 0};
};

Columns countColumns(const VoxelMap& map, const Layers& layers, double free_below,
                     double occupied_from, const std::string& source, std::size_t max_cells) {
  constexpr std::int32_t kFar = std::numeric_limits<std::int32_t>::max();
  std::int32_t x0 = kFar, y0 = kFar, x1 = -kFar, y1 = -kFar;
  const auto wanted = [&](const VoxelLeaf& leaf) {
    return height(leaf, layers) > 0 &&
           (leaf.probability <= free_below || leaf.probability >= occupied_from);
  };
  for (const VoxelLeaf& leaf : map.leaves) {
    if (!wanted(leaf)) continue;
    x0 = std::min(x0, leaf.x);
    y0 = std::min(y0, leaf.y);
    x1 = std::max(x1, leaf.x + leaf.size);
    y1 = std::max(y1, leaf.y + leaf.size);
  }
  if (x0 >= x1) {
    throw hyselam::InputError(
        source, "",
        "the OctoMap has no cells between z = " + formatNumber(layers.first * map.resolution) +
            " and " + formatNumber(layers.end * map.resolution) + " m");
  }
  Columns columns;
  columns.geometry.width = x1 - x0;
  columns.geometry.height = y1 - y0;
  columns.geometry.resolution = map.resolution;
  columns.geometry.origin = {x0 * map.resolution, y0 * map.resolution, 0.0};
  if (columns.geometry.cellCount() > max_cells) {
    throw hyselam::InputError(source, "",
                              "the OctoMap is too large: " + std::to_string(x1 - x0) + " x " +
                                  std::to_string(y1 - y0) + " cells, more than " +
                                  std::to_string(max_cells));
  }
  columns.occupied = ColumnCounts(x1 - x0, y1 - y0);
  columns.free = ColumnCounts(x1 - x0, y1 - y0);
  for (const VoxelLeaf& leaf : map.leaves) {
    if (!wanted(leaf)) continue;
    ColumnCounts& counts = leaf.probability >= occupied_from ? columns.occupied : columns.free;
    counts.add(leaf.x - x0, leaf.y - y0, leaf.size, height(leaf, layers));
  }
  columns.occupied.finish();
  columns.free.finish();
  return columns;
}

/// The value of each column by a rule of (occupied cells, free cells).
template <typename Rule>
OccupancyGrid gridOf(const Columns& columns, const Rule& rule) {
  OccupancyGrid grid(columns.geometry);
  for (int y = 0; y < columns.geometry.height; ++y) {
    for (int x = 0; x < columns.geometry.width; ++x) {
      grid.at({x, y}) = rule(columns.occupied(x, y), columns.free(x, y));
    }
  }
  return grid;
}

OccupancyGrid withoutIsolatedCells(const OccupancyGrid& grid) {
  OccupancyGrid result = grid;
  for (int y = 0; y < grid.geometry.height; ++y) {
    for (int x = 0; x < grid.geometry.width; ++x) {
      const std::int8_t value = grid.at({x, y});
      if (value == OccupancyGrid::kUnknown) continue;
      int alike = -1;  // itself
      for (int v = y - 1; v <= y + 1; ++v) {
        for (int u = x - 1; u <= x + 1; ++u) {
          if (grid.valueOr({u, v}) == value) ++alike;
        }
      }
      if (alike == 0) result.at({x, y}) = OccupancyGrid::kUnknown;
    }
  }
  return result;
}

std::string list(const std::vector<Storey>& storeys) {
  std::string text;
  for (std::size_t i = 0; i < storeys.size(); ++i) {
    char line[80];
    std::snprintf(line, sizeof line, "%s%zu: %.2f to %.2f m", i == 0 ? "" : ", ", i,
                  storeys[i].floor, storeys[i].ceiling);
    text += line;
  }
  return text;
}

/// Fills in what of z_min and z_max is not given.
void chooseStorey(const CompressionParams& params, const std::string& source, Compression& result) {
  const std::vector<Storey>& storeys = result.storeys;
  if (storeys.empty()) {
    throw hyselam::InputError(source, "", "the OctoMap has no level floor: give z_min and z_max");
  }
  if (params.storey < 0 && storeys.size() > 1) {
    throw hyselam::InputError(source, "",
                              "the OctoMap has " + std::to_string(storeys.size()) + " storeys (" +
                                  list(storeys) + "): choose a storey, or give z_min and z_max");
  }
  const int index = std::max(params.storey, 0);
  if (index >= static_cast<int>(storeys.size())) {
    throw hyselam::InputError(
        source, "",
        "there is no storey " + std::to_string(index) + " in the OctoMap, only " + list(storeys));
  }
  const Storey& storey = storeys[static_cast<std::size_t>(index)];
  result.z_min = params.z_min.value_or(storey.floor + params.floor_margin);
  result.z_max = params.z_max.value_or(
      std::min(storey.ceiling - params.ceiling_margin, storey.floor + params.max_height));
  if (!(result.z_max > result.z_min)) {
    throw hyselam::InputError(source, "", "nothing is left between z_min and z_max");
  }
}

}  // namespace

void CompressionParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("z_min", z_min, Range::between(-10000.0, 10000.0), "m",
        "lower limit of the heights that are projected; unset: that of the storey");
  visit("z_max", z_max, Range::between(-10000.0, 10000.0), "m", "upper limit");
  visit("floor_margin", floor_margin, Range::between(0.0, 10.0), "m", "kept from the floor");
  visit("ceiling_margin", ceiling_margin, Range::between(0.0, 10.0), "m", "kept from the ceiling");
  visit("max_height", max_height, Range::above(0.0), "m", "above the floor, in high halls");
  visit("storey", storey, Range::between(-1, 1000), "",
        "of the OctoMap, 0 for the lowest; -1: the only one");
  visit("max_free_height", max_free_height, Range::between(0.0, 100.0), "m",
        "NF_max: a column with more free space is free");
  visit("min_occupied_height", min_occupied_height, Range::between(0.0, 100.0), "m",
        "NO_min: else a column with more than this is occupied");
  visit("free_below", free_below, Range::fromBelow(0.0, 1.0), "",
        "P_max: voxels of up to this probability count as free");
  visit("occupied_from", occupied_from, Range::aboveUpTo(0.0, 1.0), "",
        "P_min: voxels of at least this probability count as occupied");
  visit("filter", filter, "isolated cells become unknown");
  visit("max_cells", max_cells, Range::atLeast(1.0), "", "of the grid map; more are refused");
}

void CompressionParams::validate() const {
  hyselam::checkParameters(*this);
  if (z_min && z_max) hyselam::require("z_max", *z_max, *z_max > *z_min, "greater than z_min");
  hyselam::require("occupied_from", occupied_from, occupied_from > free_below, "> free_below");
}

Compression compress(const VoxelMap& map, const CompressionParams& params,
                     const std::string& source) {
  params.validate();
  Compression result;
  if (params.z_min && params.z_max) {
    result.z_min = *params.z_min;
    result.z_max = *params.z_max;
  } else {
    result.storeys = findStoreys(map);
    chooseStorey(params, source, result);
  }
  const Layers layers = layersBetween(result.z_min, result.z_max, map.resolution);
  const Columns columns =
      countColumns(map, layers, params.free_below, params.occupied_from, source, params.max_cells);
  const double nf_max = params.max_free_height / map.resolution;
  const double no_min = params.min_occupied_height / map.resolution;
  result.grid = gridOf(columns, [&](std::int32_t occupied, std::int32_t free) {
    if (free > nf_max) return OccupancyGrid::kFree;
    return occupied > no_min ? OccupancyGrid::kOccupied : OccupancyGrid::kUnknown;
  });
  if (params.filter) result.grid = withoutIsolatedCells(result.grid);
  return result;
}

OccupancyGrid slice(const VoxelMap& map, double z_min, double z_max, const std::string& source,
                    std::size_t max_cells) {
  const CompressionParams probabilities;
  const Layers layers = layersBetween(z_min, z_max, map.resolution);
  const Columns columns = countColumns(map, layers, probabilities.free_below,
                                       probabilities.occupied_from, source, max_cells);
  return gridOf(columns, [](std::int32_t occupied, std::int32_t free) {
    if (occupied > 0) return OccupancyGrid::kOccupied;
    return free > 0 ? OccupancyGrid::kFree : OccupancyGrid::kUnknown;
  });
}

}  // namespace hyselam_topo
