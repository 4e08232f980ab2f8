// What the decision whether two neighboring regions are one place is made from: features of the
// border between them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

namespace hyselam_topo {

/// "log" is the natural logarithm, which turns ratios of lengths into differences. Clearance: of a
/// free cell, its distance to the nearest obstacle [m]; peak: the largest clearance of a region;
/// mean: twice its mean clearance, about half the width of a corridor. "smaller", "larger": the
/// regions by area, but with peaks and means by these. Solidity: log of the area by that of the
/// convex hull; rectangularity: log of the area by that of the smallest enclosing rectangle;
/// elongation: log of that rectangle's longer side by the shorter.
enum class BorderFeature : std::size_t {
  kClearance,               ///< log of the largest clearance on the border
  kClearanceToSmallerPeak,  ///< log of its ratio to the peak of the region with the smaller peak
  kClearanceToLargerPeak,   ///< the same with the larger peak
  kClearanceToSmallerMean,  ///< the same with the smaller of the means
  kClearanceToLargerMean,   ///< the same with the larger of the means
  kSmallerArea,             ///< log [m^2]
  kLargerArea,              ///< log [m^2]
  kOpenShare,               ///< of the border's length: not along a thin wall
  kJointSolidity,           ///< of both together
  kSolidityGain,            ///< joint solidity less kPartsSolidity
  kOpenToSmallerPerimeter,  ///< open length by the perimeter of the smaller region
  kOpenToSmallerSide,       ///< open length by the root of the smaller region's area
  kSmallerAreaToPeak,       ///< log of the area by the square of the peak
  kLargerAreaToPeak,        ///< the same of the larger region
  kWeakerWall,              ///< share of solid cells on the chord's line, behind its one end
  kStrongerWall,            ///< behind the other end, where there are more
  kPassageToClearance,      ///< log of the shortest chord by twice the border's clearance
  kOpenToClearance,         ///< log of the open length by twice the border's clearance
  kWallToSmallerPerimeter,  ///< length of thin wall by the perimeter of the smaller region
  kPartsSolidity,           ///< log of the areas by the areas of both hulls
  kJointRectangularity,     ///< of both together
  kSmallerRectangularity,   ///< of the smaller region
  kLargerRectangularity,    ///< of the larger region
  kJointElongation,         ///< of both together
  kSmallerElongation,       ///< of the smaller region
  kSmallerSolidity,         ///< of the smaller region
  kOpenToLargerPerimeter,   ///< open length by the perimeter of the larger region
};
constexpr std::size_t kBorderFeatureCount = 27;

/// As it is called in files: "clearance", "clearance_to_smaller_peak"; and back, nothing for
/// another name.
const char* toString(BorderFeature feature);
std::optional<BorderFeature> borderFeatureFromString(const std::string& name);

/// The features of one border.
struct BorderFeatures {
  std::array<double, kBorderFeatureCount> values{};

  double& operator[](BorderFeature f) { return values[static_cast<std::size_t>(f)]; }
  double operator[](BorderFeature f) const { return values[static_cast<std::size_t>(f)]; }
};

/// The same border, were all lengths longer by a factor and, besides, the clearance of the border.
/// Logarithms of both factors.
BorderFeatures rescaledBorder(BorderFeatures border, double log_lengths, double log_clearance);

}  // namespace hyselam_topo
