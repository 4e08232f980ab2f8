// What a tour says of its rooms, whichever way they are laid out: values for a layout
// (tour_layout.hpp) or for the rooms of a map (tour_match.hpp).
#pragma once

#include <cstddef>
#include <vector>

namespace hyselam_topo {

/// Sums of weighed logarithms of what is read to be likely; of rooms 0 .. n - 1.
struct TourEvidence {
  explicit TourEvidence(std::size_t rooms = 0);

  std::size_t rooms = 0;
  std::vector<double> left, right;         ///< of each room: its side
  std::vector<double> first, last, inner;  ///< of each room: its place among those of its side
  /// Of rooms a and b at a * rooms + b: a is on the side of b and comes before it; they are on
  /// different sides, doors near each other or not.
  std::vector<double> before, facing, apart;
  /// The weights in these sums: of sides, of places in the row, and of pairs.
  std::vector<double> side_weight, position_weight, pair_weight;

  struct Pair {
    double before = 0.0, behind = 0.0, facing = 0.0, apart = 0.0;  ///< probabilities
  };
  void addSide(std::size_t room, double weight, double p_left, double p_right);
  void addPosition(std::size_t room, double weight, double p_first, double p_last, double p_inner);
  void addPair(std::size_t a, std::size_t b, double weight, const Pair& p);
};

}  // namespace hyselam_topo
