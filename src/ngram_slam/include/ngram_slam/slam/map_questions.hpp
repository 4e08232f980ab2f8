// Places of one map that may be in another: candidates for loops between maps, by signatures.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "ngram_slam/slam/signature_places.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// Keyframes that may show the same place, of which the scans were not asked before.
class MapQuestions {
 public:
  /// Signs all keyframes of a state.
  /// @throws hyselam::ParameterError, hyselam::InputError as SignaturePlaces.
  MapQuestions(const SlamState& state, const SignaturePlacesParams& params);

  /// Whether a loop between two keyframes would say something new.
  using IsOpen = std::function<bool(int older, int newer)>;
  /// Whether the place at a keyframe is asked for.
  using IsAsked = std::function<bool(int keyframe)>;
  /// The best `candidates` earlier places of each place, one of `interval` m of path of those that
  /// are asked for. Counts them in `asked`.
  std::vector<SignatureCandidate> ask(double interval, int candidates, const IsAsked& is_asked,
                                      const IsOpen& is_open, int* asked);

 private:
  SignaturePlaces places_;
  double spacing_;
  std::set<std::pair<int, int>> told_;  // keyframes
};

}  // namespace ngram_slam
