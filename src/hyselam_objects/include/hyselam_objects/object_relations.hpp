// How seen objects lie to each other, and how movable they are.
#pragma once

#include "hyselam_objects/object_map.hpp"

namespace hyselam_objects {

struct RelationParams {
  double contact = 0.05;    ///< a stands on b: its underside is that near to b's top [m]
  double overhang = 0.02;   ///< ... and its middle lies above b's box, or this far beside it [m]
  double near = 0.3;        ///< gap between two boxes in the plane [m]
  double same_level = 0.1;  ///< things side by side stand on levels that differ by less [m]
};

/// Makes the measured relations between objects anew: on, inside, under, near, left, right. Told
/// ones stay, unless a measured one of the same two objects speaks of the same thing. Only objects
/// with a pose that probably exist (> 0.5) take part.
///
/// - on: contact and overhang as above; of several candidates the highest.
/// - inside: a's box lies in b's; under: b's box lies over a's without touching it.
/// - near: neither on nor in each other, standing on levels of the same height, and near.
/// - left, right: near, for somebody who looks at b from the middle of the place (E_R of "at"
///   tells it), if a is at least twice as far aside as before or behind b.
/// E_R and M_R of all relations are brought up to date.
void updateRelations(ObjectMap* map, const RelationParams& params = {});

struct MovabilityParams {
  double moved = 0.3;         ///< a stay ends when it is seen farther away than this [m]
  double prior_weight = 1.0;  ///< of what size tells, in visits
  double stacked = 0.6;       ///< factor for each thing that stands on it, 0 .. 1
};

/// M_R, 0 fixed .. 1 movable: (prior_weight * prior + moves) / (prior_weight + visits) *
/// stacked^n. The prior falls with the volume: 0.7 for a cup (1 l), 0.5 for 10 l, 0.1 for a table
/// (0.5 m^3); visits are the stays of its history; moves are those farther from the one before than
/// `moved`; n counts what stands on it (8.2: "an object with another one on top is
/// less movable"). Of something only told: its prior is 0.5.
double movability(const ObjectMap& map, Id object, const MovabilityParams& params = {});

}  // namespace hyselam_objects
