// Basic colours (Eq. 6.13): black, white, and equal sectors of the hue.
#pragma once

#include <cstdint>

namespace selovis {

/// Hue and saturation are the exact ratios of the three channels, not OpenCV's rounded 8-bit
/// values, so that classes can be told by integer comparisons.
struct ColorParams {
  int colors = 8;           ///< n of the text: black, white and n - 2 hues; 3 to 16
  int value_min = 40;       ///< delta_v: black below it, 0 to 255
  int saturation_min = 40;  ///< delta_s: white below it, 0 to 255, where 255 is pure colour
};

/// Throws hyselam::ParameterError.
void validate(const ColorParams& params);

/// Brightness (77 R + 150 G + 29 B + 128) / 256 and colour 0 .. n - 1 of a row of BGR pixels.
/// `grey` and `colors` need room for 16 more values than `cols`.
void classifyRow(const std::uint8_t* bgr, int cols, const ColorParams& params, std::uint8_t* grey,
                 std::uint8_t* colors);

}  // namespace selovis
