// The places that names and pronouns of a statement mean.
#pragma once

#include <string>
#include <vector>

#include "statement.hpp"

namespace hyselam_topo {

/// The places that a name means; none, one, or several if it is ambiguous.
std::vector<Id> placesOf(const std::string& name, const DescriptionState& state,
                         const PlaceNames& names);

/// The place of a name, made if it is new. These throw Statement::Failed after reporting.
Id placeOf(Statement& statement, const SaidName& name);
/// The one place of a slot.
Id placeOf(Statement& statement, const std::string& slot);
/// Keeps of what kind of place the name was, for those that leave it out: "the big one".
void rememberKind(const std::string& full, const PlaceNames& names, const Grammar& grammar,
                  DescriptionContext* context);
/// All places of a slot: "they" are several.
std::vector<Id> placesOf(Statement& statement, const std::string& slot);
/// The same of places that are known; fails for others.
std::vector<Id> knownPlacesOf(Statement& statement, const std::string& slot);
/// "Two toilets": so many places of one name, those missing made.
std::vector<Id> placesOfOneName(Statement& statement, const SaidName& name, double count);
/// All places of slot `places`; "two toilets" are two of one name. Fails if another number of them
/// was announced than is named.
std::vector<Id> countedPlaces(Statement& statement);
/// The two places of slot `between`: two names, or two places of one name ("the toilets").
std::vector<Id> placesBetween(Statement& statement);
/// The name that was said, in full: "Lisa's office" for "my office", "Mary's office" for "Mary's".
std::string fullName(Statement& statement, const SaidName& name);
/// Fails for a new name that must be asked about first.
void checkName(Statement& statement, const SaidName& name, const std::string& full);
/// The candidates of "the toilet", told apart by where they lie: "the one on the left of the hall".
std::string choices(Statement& statement, const std::vector<Id>& ids);

}  // namespace hyselam_topo
