// Learns a SignatureModel from ways on which places were visited again.
#pragma once

#include <optional>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "ngram_slam/signatures/place_signature.hpp"

namespace ngram_slam {

/// A place to learn from.
struct SignatureExample {
  SignatureFeatures::Vector features{};
  std::optional<hyselam::Pose2> truth;  ///< in a frame that is the same for the way
};

struct SignatureTrainingParams {
  SignatureSensorParams sensor;  ///< that made the places
  double max_distance = 0.75;    ///< two places nearer than this are one [m]
  std::size_t separation = 20;   ///< if the way has so many places between them
  double ridge = 0.1;            ///< part of the variance between visits that is added to it
  std::size_t max_places = 1500, max_pairs = 4000;  ///< more of a way count no more
};

/// Each way stands for a building. The same ways give the same bytes.
/// @throws hyselam::InputError if no place was visited twice.
SignatureModel trainSignatures(const std::vector<std::vector<SignatureExample>>& ways,
                               const SignatureTrainingParams& params = {},
                               const SignatureOrigin& origin = {});

}  // namespace ngram_slam
