// What plans do not give: paint and floors of rooms, windows and posters on walls, doors, the looks
// of furniture. Private to Scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hyselam_sim/scene.hpp"

namespace hyselam_sim {

/// Looks of a room, from the building's seed and the room's name or number.
struct RoomStyle {
  Surface paint;
  Surface floor;
  Surface ceiling;
};
RoomStyle roomStyle(std::uint64_t seed, const std::string& name);

/// Windows, posters and the like on the faces of walls, with the daylight that comes in.
struct WallDecoration {
  std::vector<Body> bodies;
  std::vector<Window> windows;
};
WallDecoration decorateWalls(const FloorPlan& plan, const FloorRegions& regions,
                             const SceneParams& params);

/// Bodies of a piece of furniture; what it looks like follows from its name.
std::vector<Body> furnitureBodies(const Furniture& furniture, std::uint64_t seed);

/// A hash of a text that is the same on all machines.
std::uint64_t hashOf(const std::string& text, std::uint64_t seed);

}  // namespace hyselam_sim
