// Features of a region from which its semantic class is determined (Maffei 2017, 6.2, 6.4).
#pragma once

#include <array>
#include <cstddef>

namespace ngram_slam {

/// Lengths are counts of observations (0.1 m each by default), densities 0..1, angles radians.
struct SemanticFeatures {
  double length = 0.0;       ///< syllable s
  double level = 0.0;        ///< smoothed density where it was steady or turned: the region's own
  double rise_before = 0.0;  ///< level minus that of the region before; 0 if there is none
  double rise_after = 0.0;   ///< the same for the region after
  double variation = 0.0;    ///< of the density: how far the region differs from its neighbours
  double density_min = 0.0;  ///< of single observations
  double density_max = 0.0;
  double frontiers = 0.0;  ///< mean number of frontiers of free space in the region's middle half
  double few_frontiers = 0.0;   ///< share of the observations with at most one
  double many_frontiers = 0.0;  ///< with at least three
  double turn = 0.0;            ///< range of the robot's headings, unwrapped, >= 0
  double angle = 0.0;           ///< |a| of Alg. 4.3
  double steady = 0.0;          ///< 1: the density was steady, 0: it only turned
};

constexpr std::size_t kSemanticFeatures = 13;

/// A feature by its name, as files of forests and of examples have it.
struct SemanticFeature {
  const char* name;
  double SemanticFeatures::*member;
};

/// In the order of the members; for learning.
constexpr std::array<SemanticFeature, kSemanticFeatures> kSemanticFeatureList{
    {{"length", &SemanticFeatures::length},
     {"level", &SemanticFeatures::level},
     {"rise_before", &SemanticFeatures::rise_before},
     {"rise_after", &SemanticFeatures::rise_after},
     {"variation", &SemanticFeatures::variation},
     {"density_min", &SemanticFeatures::density_min},
     {"density_max", &SemanticFeatures::density_max},
     {"frontiers", &SemanticFeatures::frontiers},
     {"few_frontiers", &SemanticFeatures::few_frontiers},
     {"many_frontiers", &SemanticFeatures::many_frontiers},
     {"turn", &SemanticFeatures::turn},
     {"angle", &SemanticFeatures::angle},
     {"steady", &SemanticFeatures::steady}}};

/// The values in the order of kSemanticFeatureList.
inline std::array<float, kSemanticFeatures> vectorOf(const SemanticFeatures& features) {
  std::array<float, kSemanticFeatures> values{};
  for (std::size_t i = 0; i < kSemanticFeatures; ++i) {
    values[i] = static_cast<float>(features.*kSemanticFeatureList[i].member);
  }
  return values;
}

}  // namespace ngram_slam
