// Random floors of offices and flats, each from a seed: rooms, corridors, halls, doors of many
// widths and open passages, furniture if wanted. All about them is known, so whatever looks for
// rooms, doors or walls can be measured on as many as are needed.
#pragma once

#include <cstdint>
#include <string>

#include "hyselam_common/parameters.hpp"
#include "hyselam_sim/floor_plan.hpp"

namespace hyselam_sim {

struct PlanParams {
  enum class Layout {
    kAny,       ///< chosen by the seed
    kCorridor,  ///< rooms on both sides of a corridor, which may end in an open hall
    kCorner,    ///< rooms along a corridor with a corner
    kFlat,      ///< rooms in a block, joined by doors and wide openings, no corridor
  };
  Layout layout = Layout::kAny;
  double min_door = 0.7;  ///< narrowest and widest door [m], 0.5 .. 2.2; most are 0.8 to 1.1
  double max_door = 2.0;
  bool openings = true;    ///< with passages wider than doors: no door, yet two places
  bool leaves = true;      ///< half of the narrow doors have a leaf that stands open
  bool furniture = false;  ///< tables, desks, cupboards, clear of the doors
  double rotation = 0.0;   ///< of the whole floor [rad]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// The name of a Door of a generated plan that is an open passage begins so; those of real doors do
/// not.
extern const char* const kOpeningPrefix;

/// Every place has its outline (the inner faces of its walls); every opening is in `doors`. The
/// same on every machine. @throws hyselam::ParameterError for a parameter out of range.
FloorPlan generatePlan(std::uint64_t seed, const PlanParams& params = {});

/// The plan in the format that loadFloorPlan() reads. Schedules of doors are kept.
std::string toYaml(const FloorPlan& plan);

}  // namespace hyselam_sim
