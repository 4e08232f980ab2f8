// Changes of a description: what goes with a place or a connection that goes.
#pragma once

#include <optional>
#include <string>

#include "hyselam_language/building/described_building.hpp"

namespace hyselam_topo {

/// Adds a place under an id of its own. Descriptions from files come in any order of ids.
Id addPlace(const std::string& name, const std::optional<PlaceKind>& kind,
            DescribedBuilding* building);

/// The connection of two places, whichever the first was; nullptr: there is none.
const DescribedConnection* findConnection(const DescribedBuilding& building, Id a, Id b);

/// Those behind it in its row move up.
void removeConnection(const DescribedConnection& connection, DescribedBuilding* building);

/// With its connections and relations; the robot is nowhere if it was there.
void removePlace(Id place, DescribedBuilding* building);

/// All that was told of one place is of another, and the one is gone. What the other is told
/// already stays.
void joinPlaces(Id gone, Id stays, DescribedBuilding* building);

/// A number as people are told it back.
std::string shown(double value);

}  // namespace hyselam_topo
