// Random networks of corridors, each from a seed, with the kind of every place and a way through
// all of them: to learn what corners, bifurcations, dead ends and halls look like.
#pragma once

#include <cstdint>

#include "hyselam_common/parameters.hpp"
#include "hyselam_sim/floor_plan.hpp"
#include "hyselam_sim/route.hpp"

namespace hyselam_sim {

struct CorridorParams {
  int lines = 4;             ///< corridors that may run north and as many that may run east, 2 .. 8
  double min_width = 1.8;    ///< of the corridors [m], >= 1.2; one width for the whole building
  double max_width = 3.2;    ///< [m]
  double min_spacing = 7.0;  ///< between neighbouring corridors' centre lines [m], >= max_width + 2
  double max_spacing = 18.0;  ///< [m]
  double loops = 0.45;     ///< share of the corridors that are not needed for a connected building
  double halls = 0.12;     ///< share of the meeting points with room for it that are halls
  double rooms = 0.5;      ///< share of the corridors with an open room at their side
  double max_hall = 12.0;  ///< longest side of a hall [m], >= 7.5
  /// Share of the stretches beside corridors that are offices: rooms ("dead-end") behind a door,
  /// which the route enters now and then.
  double offices = 0.0;
  double furniture = 0.0;  ///< share of the floor in halls and offices that things stand on, 0..0.4
  int legs = 80;           ///< corridors that the route passes, >= 1

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

struct CorridorBuilding {
  FloorPlan plan;  ///< with areas; `floor_kind` is "corridor"
  Route route;     ///< from corridor to corridor, turning back in dead ends only
};

/// The same on every machine. @throws hyselam::ParameterError
CorridorBuilding generateCorridors(std::uint64_t seed, const CorridorParams& params = {});

}  // namespace hyselam_sim
