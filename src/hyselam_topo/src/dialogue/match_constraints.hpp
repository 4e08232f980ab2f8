// What people have confirmed and rejected, for matching their description with the map.
#pragma once

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo {

/// Places with confirmed names are those of the description that are called so, or none of it; what
/// was rejected is excluded for the others.
MatchConstraints constraintsOf(const PlaceMan& places, const DescriptionBuilder& builder);

}  // namespace hyselam_topo
