// Where the rooms of a tour lie: of all ways in which they may lie on both sides of a corridor the
// likeliest by what was said of each and of pairs of them, and how sure it is. One sentence taken
// wrongly moves nothing that several others tell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hyselam_language/reader/tour_evidence.hpp"

namespace hyselam_topo {
namespace language {

struct TourLayoutParams {
  std::uint64_t seed = 1;
  std::size_t starts = 3;
  std::size_t sweeps = 300;      ///< of each start; in each as many rooms are moved as there are
  double first_temperature = 3;  ///< it cools down to 1 in the first third
};

struct TourLayout {
  struct Room {
    std::size_t room = 0;
    double side_certainty = 1.0;  ///< that it is on this side
    double order_certainty =
        1.0;  ///< that it lies behind the one before it in its row, if both are on this side
  };
  std::vector<Room> left, right;  ///< as they come
};

/// The likeliest layout that was found, with the shares of layouts in which the same holds
/// (Metropolis' sampling). The same evidence and seed give the same result.
TourLayout layOut(const TourEvidence& evidence, const TourLayoutParams& params = {});

}  // namespace language
}  // namespace hyselam_topo
