// What keeps the robot from driving somewhere: doors that are known to be closed, described walls.
#pragma once

#include <optional>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"
#include "hyselam_topo/dialogue/route.hpp"

namespace hyselam_topo {

/// Whether the way leads through a door that the map has as closed.
bool hasClosedDoor(const AugmentedTopologicalMap& map, const RouteLeg& leg);

/// A described wall, and the places on both sides of it.
struct WallInTheWay {
  DescribedWall wall;
  Id a = 0;
  Id b = 0;
};

/// Where no way leads to any of `goals`: the first wall behind which one would, if people opened as
/// few as possible; doors that walls shut go before other walls. Nothing: it is no described wall.
std::optional<WallInTheWay> wallInTheWay(const PlaceMan& places, const hyselam::Pose2& from,
                                         const std::vector<Id>& goals);

}  // namespace hyselam_topo
