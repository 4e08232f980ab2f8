// The changes of what is known, in their order: what "undo that" can take back, and what not.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"

namespace hyselam_topo {

/// What was known before a change of names, walls, virtual places or of what was told: where "undo
/// that" goes back to.
struct KnownBefore {
  /// Nothing before it can be taken back: a place that it was about is gone, or it is too long
  /// ago.
  enum class Barrier { kNone, kPlaceGone, kTooLongAgo };
  Barrier barrier = Barrier::kNone;
  PlaceMan::Names names;
  std::vector<DescribedWall> walls;
  std::vector<Id> virtual_places;
  /// Nothing: only statements, which the description takes back itself, and their names.
  std::optional<DescriptionBuilder::Memory> told;
  std::size_t statements = 0;  ///< before ...
  std::size_t after = 0;       ///< ... and after it (DescriptionBuilder::statementCount())
  Id told_at = 0;              ///< DialogueState::told_at
};

/// Whether people have confirmed and denied the same names. Guesses follow from what is known.
bool haveSameNames(const PlaceMan::Names& a, const PlaceMan::Names& b);

/// Keeps the last changes, at most 16.
class ChangeHistory {
 public:
  /// A change was made. An older one may be behind a barrier from now on.
  void add(KnownBefore before);
  /// The last change, be it a barrier; nullptr: there is none.
  const KnownBefore* last() const { return changes_.empty() ? nullptr : &changes_.back(); }
  KnownBefore* last() { return changes_.empty() ? nullptr : &changes_.back(); }
  /// It was taken back.
  void dropLast() { changes_.pop_back(); }

  /// Whether the last statement of `statements` came after the last change: the description takes
  /// it back itself. True without changes.
  bool isStatementLast(std::size_t statements) const;
  /// Why nothing can be taken back after so many statements.
  KnownBefore::Barrier barrier(std::size_t statements) const;

  /// The map has lost these places: changes of them, and all older ones, are behind a barrier, and
  /// the others forget these places. `now`: what was known while they were there.
  void forgetPlaces(const std::vector<Id>& lost, const KnownBefore& now);

 private:
  /// The changes up to that one cannot be taken back any more.
  void bar(std::size_t change, KnownBefore::Barrier why);

  std::vector<KnownBefore> changes_;  // the last one last; a barrier may be the first
};

}  // namespace hyselam_topo
