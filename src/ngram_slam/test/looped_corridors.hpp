// Made-up corridors that come back to themselves, as tests of mapping drive through them.
#pragma once

#include <cstdint>

#include "hyselam_sim/generate_corridors.hpp"
#include "hyselam_sim/simulation.hpp"

namespace ngram_slam {

inline hyselam_sim::CorridorBuilding loopedCorridors(std::uint64_t seed, int lines, int legs) {
  hyselam_sim::CorridorParams corridors;
  corridors.lines = lines;
  corridors.loops = 1.0;
  corridors.legs = legs;
  return hyselam_sim::generateCorridors(seed, corridors);
}

/// Few scans a second [1/s], so that tests take less time.
inline hyselam_sim::SimulationParams atScanRate(double rate) {
  hyselam_sim::SimulationParams params;
  params.scan_rate = rate;
  return params;
}

}  // namespace ngram_slam
