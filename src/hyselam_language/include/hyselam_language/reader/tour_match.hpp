// Which room of a map a tour means by each name. The map says how many doors there are on each side
// of the corridor and which face each other; what was said of sides, order and neighbours tells
// which names fit where. Not one answer but the odds of all: what is not sure is asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "hyselam_language/reader/tour_evidence.hpp"

namespace hyselam_topo {

/// A door of a corridor, seen by somebody who looks along it.
struct TourSlot {
  bool is_left = false;
  double along = 0.0;  ///< [m]
};

struct TourMatchParams {
  std::uint64_t seed = 1;
  std::size_t starts = 4;
  std::size_t sweeps = 1500;     ///< of each start; in each as many names are moved as there are
  double first_temperature = 4;  ///< it cools down to 1 in the first third
  /// Odds that a name is of no door of the corridor, as a logarithm: rooms behind other rooms,
  /// people and things taken for rooms.
  double absent = 3.0;
  double facing = 2.0;  ///< doors of both sides that are this near each other face each other [m]
};

/// What is certain: slots by their numbers, names by theirs.
struct TourConstraints {
  std::vector<std::pair<std::size_t, std::size_t>> confirmed;  ///< (slot, name)
  std::vector<std::pair<std::size_t, std::size_t>> excluded;
  std::vector<std::size_t> unnamed;  ///< slots with another name than any of the tour
};

struct TourMatch {
  std::size_t names = 0;
  std::vector<double> probability;  ///< that slot s has name i, at s * names + i
  /// The name of each slot in the likeliest answer; nothing: none of the tour.
  std::vector<std::optional<std::size_t>> best;

  double of(std::size_t slot, std::size_t name) const { return probability[slot * names + name]; }
  /// Of the name of a slot in bits, over all names and none.
  double entropy(std::size_t slot) const;
  /// The slot whose name is least sure; nothing: all are sure (less than `least` bits).
  std::optional<std::size_t> question(double least = 0.2) const;
};

/// Metropolis' sampling; the same input gives the same result. Throws hyselam::InputError for
/// constraints that contradict each other or are about nothing.
TourMatch matchTour(const TourEvidence& evidence, const std::vector<TourSlot>& slots,
                    const TourMatchParams& params = {}, const TourConstraints& constraints = {});

}  // namespace hyselam_topo
