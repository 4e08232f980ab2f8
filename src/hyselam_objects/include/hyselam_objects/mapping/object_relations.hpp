// Relations between detected objects, and how movable objects are.
#pragma once

#include "hyselam_common/parameters.hpp"
#include "hyselam_objects/mapping/object_map.hpp"

namespace hyselam_objects {

struct RelationParams {
  double max_contact_gap = 0.05;      ///< a stands on b: between a's underside and b's top [m]
  double max_overhang = 0.02;         ///< ... and of a's center beyond the border of b's box [m]
  double max_near_gap = 0.3;          ///< between two boxes in the plane [m]
  double max_level_difference = 0.1;  ///< of the undersides of objects side by side [m]
  int min_views = 2;                  ///< of each of the two objects, >= 0

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Updates the measured relations between objects: on, inside, under, near, left, right. Described
/// ones stay, and replace measured ones of the same two objects and the same sort. Only objects
/// with a pose that probably exist (> 0.5) and were seen at least `min_views` times take part.
///
/// - on: contact and overhang as above; of several candidates the highest.
/// - inside: a's box lies in b's; under: b's box lies over a's without touching it.
/// - near: neither on nor in each other, standing on levels of the same height, and near.
/// - left, right: near, for somebody who looks at b from the center of the place (E_R of "at"), if
/// a
///   is at least twice as far aside as before or behind b.
/// E_R and M_R of all relations are updated.
void updateRelations(ObjectMap& map, const RelationParams& params = {});

struct MovabilityParams {
  double min_move = 0.3;         ///< distance between two stays that counts as a move [m]
  double prior_weight = 1.0;     ///< of the size's prior, in visits
  double stacking_factor = 0.6;  ///< factor for each object that stands on it, 0 .. 1

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// M_R, 0 fixed .. 1 movable: (prior_weight * prior + moves) / (prior_weight + visits) *
/// stacking_factor^n. The prior falls with the volume: 0.7 for a cup (1 l), 0.5 for 10 l, 0.1 for a
/// table (0.5 m^3); visits are the stays of its history; moves are those farther than `min_move`
/// from the one before; n counts what stands on it (8.2: "an object with another one on top is less
/// movable"). The prior of an object that was only described is 0.5.
double movability(const ObjectMap& map, Id object, const MovabilityParams& params = {});

}  // namespace hyselam_objects
