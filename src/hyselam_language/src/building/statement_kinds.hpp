// One function for each kind of statement; see statementKind().
#pragma once

#include <cstddef>

#include "statement.hpp"

namespace hyselam_topo {

struct Placement;

namespace statements {

// What places are called (statement_names.cpp).
void alias(Statement& s);
void owner(Statement& s);
void ownerLocated(Statement& s);

// Of one place (statement_places.cpp).
void robotIn(Statement& s);
void kind(Statement& s);
void size(Statement& s);
void sizeWord(Statement& s);
void parts(Statement& s);
void buildingCount(Statement& s);
void exists(Statement& s);
void gone(Statement& s);

// Of several places (statement_connections.cpp).
void neighbours(Statement& s);
void contains(Statement& s);
void joined(Statement& s);
void doors(Statement& s);
void row(Statement& s);
void eachSide(Statement& s);
void larger(Statement& s);
void relation(Statement& s);

// Where a place lies in all ways at once (statement_located.cpp).
void located(Statement& s);

// ---- Shared parts ----

/// Length, width, area and word of size that the statement tells of a place.
void takeSizes(Statement& s, Id id);
void takeSizeWord(Statement& s, Id id);
/// How many doors it has; the statement must tell.
void takeDoors(Statement& s, Id id);
/// A further name of a place, unless it is one of another place.
void addAlias(Statement& s, Id id, const SaidName& name);
/// The place from which sides are seen: slot `from`, or where the robot is.
Id observer(Statement& s);
/// The side told, also "the same side"; remembers it. Fails if it is not known.
Side sideOf(Statement& s);
/// The same; false, and told as left out, where the side of the place that is named with it
/// ("after the bar, on the same side") is not known.
bool takeSide(Statement& s, Side* side);
/// "Here on your left": the nearest on that side, in no row of others.
void takeHere(Statement& s, Placement* placement);
/// Number, counted from the end if negative; nothing if not told.
std::optional<int> rankOf(Statement& s);
/// Fails: such a thing is not denied.
[[noreturn]] void refuseDenial(Statement& s);

}  // namespace statements
}  // namespace hyselam_topo
