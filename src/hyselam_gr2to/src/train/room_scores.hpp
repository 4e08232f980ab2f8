// How well places agree with rooms, in the manner of the published evaluators.
#pragma once

#include <vector>

namespace hyselam_topo {

/// All 0 .. 1 but for the count.
struct RoomScores {
  double precision = 0.0;  ///< mean share of a place that lies in its main room
  double recall = 0.0;     ///< mean share of a room that its main place covers
  double mcc = 0.0;        ///< mean over pairs by largest overlap, what is left alone counts 0
  double f1 = 0.0;         ///< of rooms found, intersection over union at least a half
  double places = 0.0;
};

/// `cells[place][room]`, room 0: none; over cells in a room. Places of 100 cells or less are left
/// out.
RoomScores scoreRooms(const std::vector<std::vector<int>>& cells, int rooms);

}  // namespace hyselam_topo
