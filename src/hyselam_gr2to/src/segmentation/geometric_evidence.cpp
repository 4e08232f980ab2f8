#include "geometric_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_topo {
namespace {

// Log-odds of one place, each for a border that is wholly of its kind.
constexpr double kWithinCorridor = 0.7;
constexpr double kAcrossEnd = 2.0;  // in the middle of a basin: nothing stands there
constexpr double kOnWallLine = -2.0;
constexpr double kNotNarrowed = 0.6, kEven = 0.85;          // a passage as wide as what it leads to
constexpr double kOneFurniture = 0.4, kTwoFurniture = 1.0;  // at the ends of the chord

constexpr double kAlcove = 4.0;   // [m^2] what is smaller is left to the corridor as often as not
constexpr double kShallow = 2.0;  // [m] what is less deep behind its front is a niche
constexpr double kDoor = 1.5, kDoorSpread = 0.15;  // [m] an opening is as often a door as not
/// A place this many times deeper than its square front is as often another corridor as a room.
constexpr double kDeep = 3.0;

/// How likely what opens to the side of a corridor by `front` [m] is a room: through a door, or
/// wide open. A deep one behind a wide front is another corridor, a shallow one a niche.
double likelyRoom(double front, double area) {
  const double mean_depth = area / front;
  const double likely_niche = 1.0 / (1.0 + mean_depth * mean_depth / (kShallow * kShallow));
  const double door = 1.0 / (1.0 + std::exp((front - kDoor) / kDoorSpread));
  const double depth = area / std::max(0.25, front * front) / kDeep;
  return (1.0 - likely_niche) * std::max(door, 1.0 / (1.0 + depth * depth));
}

}  // namespace

double geometricEvidence(const RegionAdjacencyGraph& graph, int a, int b) {
  const RegionBorder& border = graph.border(graph.node(a).borders.at(b));
  if (border.open <= 0.0) return 0.0;
  double odds = border.passage.furniture == 2   ? kTwoFurniture
                : border.passage.furniture == 1 ? kOneFurniture
                                                : 0.0;
  odds += kNotNarrowed * (1.0 - std::min(1.0, border.beside / border.open)) *
          std::clamp((border.passage.evenness - kEven) / (1.0 - kEven), 0.0, 1.0);
  odds += (kWithinCorridor * border.within + kAcrossEnd * border.ending) / border.open;
  if (border.beside <= 0.0) return odds;
  const RegionNode &one = graph.node(a), &two = graph.node(b);
  const double share_one = one.corridor / one.area, share_two = two.corridor / two.area;
  const double area = share_one < share_two ? one.area : two.area;
  const double room = likelyRoom(border.beside, area) * area / (area + kAlcove) *
                      (1.0 - std::min(share_one, share_two));
  return odds + kOnWallLine * room * border.beside / border.open;
}

}  // namespace hyselam_topo
