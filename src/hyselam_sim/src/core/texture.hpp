// Patterns of surfaces, computed where they are looked at.
#pragma once

#include "hyselam_sim/scene.hpp"

namespace hyselam_sim {

/// The colour of a surface at (s, t) [m]: along and up a side, x and y of a top. `blur` [m]: what
/// one pixel covers there; detail below it is left out. `height` [m]: of the side.
Color textureAt(const Surface& surface, float s, float t, float blur, float height);

}  // namespace hyselam_sim
