#include "hyselam_gr2to/segmentation/border_features.hpp"

namespace hyselam_topo {
namespace {

// In the order of BorderFeature.
constexpr std::array<const char*, kBorderFeatureCount> kNames = {"clearance",
                                                                 "clearance_to_smaller_peak",
                                                                 "clearance_to_larger_peak",
                                                                 "clearance_to_smaller_mean",
                                                                 "clearance_to_larger_mean",
                                                                 "smaller_area",
                                                                 "larger_area",
                                                                 "open_share",
                                                                 "joint_solidity",
                                                                 "solidity_gain",
                                                                 "open_to_smaller_perimeter",
                                                                 "open_to_smaller_side",
                                                                 "smaller_area_to_peak",
                                                                 "larger_area_to_peak",
                                                                 "weaker_wall",
                                                                 "stronger_wall",
                                                                 "passage_to_clearance",
                                                                 "open_to_clearance",
                                                                 "wall_to_smaller_perimeter",
                                                                 "parts_solidity",
                                                                 "joint_rectangularity",
                                                                 "smaller_rectangularity",
                                                                 "larger_rectangularity",
                                                                 "joint_elongation",
                                                                 "smaller_elongation",
                                                                 "smaller_solidity",
                                                                 "open_to_larger_perimeter"};

static_assert(static_cast<std::size_t>(BorderFeature::kOpenToLargerPerimeter) + 1 ==
              kBorderFeatureCount);

}  // namespace

const char* toString(BorderFeature feature) {
  return kNames[static_cast<std::size_t>(feature)];
}

std::optional<BorderFeature> borderFeatureFromString(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<BorderFeature>(i);
  }
  return std::nullopt;
}

BorderFeatures rescaledBorder(BorderFeatures border, double log_lengths, double log_clearance) {
  for (const BorderFeature ratio :
       {BorderFeature::kClearance, BorderFeature::kClearanceToSmallerPeak,
        BorderFeature::kClearanceToLargerPeak, BorderFeature::kClearanceToSmallerMean,
        BorderFeature::kClearanceToLargerMean}) {
    border[ratio] += log_clearance;
  }
  border[BorderFeature::kOpenToClearance] -= log_clearance;
  border[BorderFeature::kClearance] += log_lengths;
  border[BorderFeature::kSmallerArea] += 2.0 * log_lengths;
  border[BorderFeature::kLargerArea] += 2.0 * log_lengths;
  return border;
}

}  // namespace hyselam_topo
