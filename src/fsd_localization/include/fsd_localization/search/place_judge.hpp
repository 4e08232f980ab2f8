// Does another place explain the last metres better? Odds instead of an absolute share: clutter
// that the map lacks lowers the scores of all places.
#pragma once

#include "fsd_localization/search/background_search.hpp"
#include "fsd_localization/search/way.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

/// Log odds that the best place is right: bias + margin * min(margin to the best other place, 0.3)
/// + unexplained * log(max(1 - Place::seen, 0.01)) + length * log(1 + metres of the submap, turns
/// counted). Fitted by bench/place_judge, to searches where the place is on no map as well: there a
/// place leaves much unexplained, however far the others are behind.
struct PlaceOdds {
  double bias = -4.335;
  double margin = 44.186;
  double unexplained = -1.396;
  double length = 0.441;

  void describe(hyselam::ParameterVisitor& visit);
};

/// How sure it is that a place is the right one.
///
/// @param score Place::seen. @param rival of the best other place; 0 if there is none.
/// @param length of the submap [m], with turns: see lengthWithTurns().
/// @return probability, 0..1, calibrated on logs (docs/algorithms/localization.md).
double probabilityOfPlace(double score, double rival, double length, const PlaceOdds& odds = {});

/// The best place of an answer and how sure it is. The believed one is SearchAnswer::believed: the
/// pose that was asked about.
struct Verdict {
  Place best;
  double probability = 0.0;
  bool best_is_believed = false;  ///< the best place is the believed one
  /// Of the believed one, beside the best other place; 1 if none was believed.
  double believed_probability = 1.0;
  /// Places that are not much worse, the best one included, and the believed one.
  std::vector<Place> hypotheses;
};
/// Nothing if nothing was found and nothing believed.
std::optional<Verdict> judge(const SearchAnswer& answer, const PlaceOdds& odds = {});

}  // namespace fsd_localization
