#include <algorithm>
#include <cmath>

#include "hyselam_language/reader/tour_evidence.hpp"

namespace hyselam_topo {
namespace {

/// Nothing is impossible: people say what cannot be meant.
constexpr double kSmallest = 0.05;

double weighed(double weight, double probability) {
  return weight * std::log(std::max(probability, kSmallest));
}

}  // namespace

TourEvidence::TourEvidence(std::size_t count)
    : rooms(count),
      left(count, 0.0),
      right(count, 0.0),
      first(count, 0.0),
      last(count, 0.0),
      inner(count, 0.0),
      before(count * count, 0.0),
      facing(count * count, 0.0),
      apart(count * count, 0.0),
      side_weight(count, 0.0),
      position_weight(count, 0.0),
      pair_weight(count * count, 0.0) {}

void TourEvidence::addSide(std::size_t room, double weight, double p_left, double p_right) {
  left[room] += weighed(weight, p_left);
  right[room] += weighed(weight, p_right);
  side_weight[room] += weight;
}

void TourEvidence::addPosition(std::size_t room, double weight, double p_first, double p_last,
                               double p_inner) {
  first[room] += weighed(weight, p_first);
  last[room] += weighed(weight, p_last);
  inner[room] += weighed(weight, p_inner);
  position_weight[room] += weight;
}

void TourEvidence::addPair(std::size_t a, std::size_t b, double weight, const Pair& p) {
  const std::size_t ab = a * rooms + b, ba = b * rooms + a;
  before[ab] += weighed(weight, p.before);
  before[ba] += weighed(weight, p.behind);
  for (const std::size_t at : {ab, ba}) {
    facing[at] += weighed(weight, p.facing);
    apart[at] += weighed(weight, p.apart);
    pair_weight[at] += weight;
  }
}

}  // namespace hyselam_topo
