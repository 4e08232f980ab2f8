// Basic colors (dos Santos 2014, Eq. 6.13): black, white, and equal sectors of the hue.
#pragma once

#include <cstdint>

#include "hyselam_common/parameters.hpp"

namespace selovis {

/// Hue and saturation are the exact ratios of the three channels, not OpenCV's rounded 8-bit
/// values, so that classes are found by integer comparisons.
struct ColorParams {
  int colors = 8;           ///< n of the text: black, white and n - 2 hues; 3 to 16
  int value_min = 40;       ///< delta_v: black below it, 0 to 255
  int saturation_min = 40;  ///< delta_s: white below it, 0 to 255, where 255 is a pure color

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

/// Brightness (77 R + 150 G + 29 B + 128) / 256 and color 0 .. n - 1 of a row of BGR pixels.
/// `gray` and `colors` need room for 16 more values than `cols`.
void classifyRow(const std::uint8_t* bgr, int cols, const ColorParams& params, std::uint8_t* gray,
                 std::uint8_t* colors);

}  // namespace selovis
