// Small things that stand about in a plan, from a file: what objects are distinguished by.
#pragma once

#include <string>
#include <vector>

#include "hyselam_sim/scene.hpp"

namespace hyselam_sim {

/// A YAML file with a list `things` of {name, kind, shape: box or cylinder, at: [x, y],
/// above_floor, size: [length, width, height], turn, colour: [red, green, blue]}; metres, degrees,
/// colours 0 .. 1. `kind` is the name unless it is given; what is not given otherwise is as in
/// Thing. @throws hyselam::InputError with file, line and key.
std::vector<Thing> loadThings(const std::string& path);

/// The same from text; `source` names it in messages.
std::vector<Thing> parseThings(const std::string& text, const std::string& source);

}  // namespace hyselam_sim
