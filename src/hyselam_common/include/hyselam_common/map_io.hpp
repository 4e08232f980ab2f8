// Occupancy grids in the file format of map_server: a YAML file beside an image.
#pragma once

#include <cstddef>
#include <string>

#include "hyselam_common/occupancy_grid.hpp"

namespace hyselam {

struct MapIoOptions {
  std::size_t max_cells = std::size_t{1} << 28;  ///< an image with more pixels is refused
};

/// Reads a map as map_server does.
///
/// Keys: `image` (relative to the YAML file, anything OpenCV reads: PGM, PNG, ...), `resolution`
/// [m/cell] > 0, `origin` [x, y, yaw] (the yaw is kept in `geometry.origin.theta`), `negate` 0 or
/// 1, `occupied_thresh` and `free_thresh` in [0, 1] with free <= occupied, `mode` trinary
/// (default), scale or raw. With p = (255 - grey) / 255, or grey / 255 if negated (colours are
/// averaged): trinary: p > occupied_thresh occupied, p < free_thresh free, else unknown; scale:
/// between the thresholds 1 .. 99 in proportion, and unknown where an alpha channel is less than
/// opaque; raw: the grey value itself where <= 100, else unknown. @throws InputError naming the
/// file and the key for everything that cannot be used.
OccupancyGrid loadMap(const std::string& yaml_path, const MapIoOptions& options = {});

enum class MapMode { kTrinary, kScale, kRaw };

/// Writes NAME.yaml and, beside it, NAME.pgm (raw, 8 bit); each replaces its predecessor at once,
/// the image first. Trinary: free 254, occupied 0, unknown 205, values between them unknown, as
/// map_saver does. Scale and raw keep 0 .. 100; in scale mode unknown needs an alpha channel, so
/// the image is NAME.png then. @throws InputError if a file cannot be written, the grid is empty,
/// its resolution is not positive, its cells do not match its size, or a value lies outside
/// -1 .. 100.
void saveMap(const std::string& yaml_path, const OccupancyGrid& grid,
             MapMode mode = MapMode::kTrinary);

}  // namespace hyselam
