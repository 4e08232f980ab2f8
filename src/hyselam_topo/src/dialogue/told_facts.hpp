// What follows from a description: whether a statement was told, whose a place is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {

/// Whether a statement agrees with what was told.
struct Truth {
  /// true: it was told; false: the contrary was told; nothing: not known.
  std::optional<bool> told;
  std::string reason;  ///< of false, for people
};
/// `statement`: an utterance of a kind that describes, e.g. `located`; it is not recorded.
Truth truthOf(const DescriptionBuilder& builder, Utterance statement);

/// A question about a relation as the statement that it asks for.
Utterance asStatement(const Utterance& question, const std::string& intent);

/// The places of the description of which the statement is true, put in as its slot `places`.
std::vector<std::string> placesWhere(const DescriptionBuilder& builder, const Utterance& question);

/// Names that tell whose a place is: "Lisa's office", "gabinete do Rui".
std::vector<std::string> ownersOf(const DescribedPlace& place);

/// What was told of one place, in the words of the grammar. Throws as describeChange().
std::vector<std::string> factsOf(const DescribedBuilding& building, Id place,
                                 const Grammar& grammar);

}  // namespace hyselam_topo
