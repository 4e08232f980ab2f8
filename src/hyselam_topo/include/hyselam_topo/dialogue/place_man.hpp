// PlaceMan, the place manager (dos Santos 2014, section 3.2.2): the topological map with what
// people add to it: names (confirmed or only guessed), virtual places, glass walls and virtual
// walls. These are preserved when the map is segmented again.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_language/building/place_names.hpp"
#include "hyselam_topo/dialogue/described_wall.hpp"
#include "hyselam_topo/dialogue/place_shelf.hpp"
#include "hyselam_topological_map/carry_over.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// The generated id of a place that people read: "SS01" for rooms, "CC04" for corridors (Fig. 7.9),
/// "VV05" for virtual places; the number is Place::id.
std::string codeOf(const Place& place);

/// Whether the name of a place is confirmed, with the colours of Fig. 7.10.
enum class NameState {
  kNone,         ///< no word: green
  kUnconfirmed,  ///< guessed: red
  kConfirmed     ///< a person has said or confirmed it: blue
};
NameState nameStateOf(const Place& place);

/// The words of a place, confirmed ones only if there are any.
std::vector<std::string> namesOf(const Place& place);
/// The confirmed ones of the words of a place; none if there are only guesses.
std::vector<std::string> confirmedOf(const std::vector<PlaceTerm>& words);

class PlaceMan {
 public:
  /// Everything to save; a plain value.
  struct State {
    AugmentedTopologicalMap map;  ///< with the names; without places before the first setMap()
    std::vector<DescribedWall> walls;
    /// (place, name) pairs that a person has denied.
    std::vector<std::pair<Id, std::string>> rejected;
    Shelf shelf;  ///< names by people whose places the map does not show
  };

  /// What a new map has done to the places.
  struct MapReport : CarryOverReport {
    std::size_t shelved = 0;     ///< so many named places are out of sight now
    std::vector<Id> seen_again;  ///< these have got names from the shelf
  };

  explicit PlaceMan(PlaceNames names);

  /// Replaces the state by a saved one. @throws hyselam::InputError for a map that checkMap()
  /// rejects and for walls that are not finite.
  void restore(State state);
  const State& state() const { return state_; }
  const AugmentedTopologicalMap& map() const { return state_.map; }
  bool hasMap() const { return !state_.map.places.empty(); }

  /// A new segmentation of the grid map: ids, names, virtual places and walls are preserved, see
  /// carryOver(). map() has the ids of the first map; new places get new ids, not those of `fresh`.
  /// Names by people whose places are lost go to the shelf, and come back with a map that shows
  /// most of these places again (place_shelf.hpp); names that were told since go before them. Where
  /// most of all places are lost, it is rather another map, or only a small one of another frame:
  /// then names stay only with places that have clearly the same limits.
  /// @throws as carryOver().
  MapReport setMap(const AugmentedTopologicalMap& fresh);

  // ---- Names. Places that are not in the map throw hyselam::InputError. ----
  /// A person has stated the names: they are confirmed for this place, its guesses are removed, and
  /// the names are removed from all other places, except where confirmed for an adjacent place.
  /// Returns the places that lost a confirmed name.
  std::vector<Id> confirm(Id place, const std::vector<std::string>& names);
  /// Confirms the guessed names of a place. False if it has none.
  bool confirmGuesses(Id place);
  /// A person has denied the names: they are never guessed for this place again.
  void reject(Id place, const std::vector<std::string>& names);
  bool isRejected(Id place, const std::string& name) const;
  /// Replaces all guessed names. Confirmed and rejected names remain as they are.
  void guess(const std::vector<std::pair<Id, std::vector<std::string>>>& guesses);
  /// All that people have said of names, and what is guessed.
  struct Names {
    std::map<Id, std::vector<PlaceTerm>> words;  ///< by the place
    std::vector<std::pair<Id, std::string>> rejected;
  };
  Names names() const;
  /// Gives all places that are still there the names of before.
  void restoreNames(const Names& before);
  /// Removes all names of a place. False if it had none.
  bool forget(Id place);
  /// Removes a name from all places. Returns the places that had it.
  std::vector<Id> forgetName(const std::string& name);
  /// Whether a person gave this name to a place that is on the shelf.
  bool isShelved(const std::string& name) const;
  /// Removes a name from the shelf. False if it was not there.
  bool forgetShelved(const std::string& name);
  /// Removes all names of all places, those on the shelf, and the rejected ones.
  void forgetAllNames();
  /// confirm(), and all other names of the place are gone. Throws as it, without effect.
  std::vector<Id> rename(Id place, const std::vector<std::string>& names);

  /// The places with a name or generated id (codeOf()): those where the name is confirmed, else
  /// those where it is guessed.
  std::vector<Id> find(const std::string& name) const;
  /// Whether both may be spellings of the same name (place_names.hpp).
  bool sameName(const std::string& a, const std::string& b) const;

  // ---- Virtual places and walls ----
  /// A place that is cut out of the one around `centre`: its cells within `radius` [m]. Returns its
  /// id. Throws hyselam::InputError if the centre lies on no place, or the radius is not in
  /// (0, 100].
  Id addVirtualPlace(hyselam::Point2 centre, double radius, const std::vector<std::string>& names);
  /// Removes it; its cells are given back to the surrounding place. False if there is no such
  /// place.
  bool removeVirtualPlace(Id place);
  /// Throws hyselam::InputError for a wall that is not finite or has no length.
  void addWall(const DescribedWall& wall);
  /// The wall of that number in walls(). False if there is none.
  bool removeWall(std::size_t index);
  const std::vector<DescribedWall>& walls() const { return state_.walls; }
  /// Takes the wall of this kind between these ends away, see sameWall(). False if there is none.
  bool removeWall(const DescribedWall& wall);
  /// The doors that a virtual wall lies across: the places on both sides stay as they are, but no
  /// way leads through.
  std::vector<Id> shutDoors() const;
  /// Of each of walls() whether it shuts a door.
  std::vector<bool> wallsOnDoors() const;
  /// The door that a wall shuts; nullptr: none of the map.
  const Door* doorShutBy(const DescribedWall& wall) const;
  /// A copy of the grid map with all walls of glass and virtual walls drawn into it, but those that
  /// shut a door.
  hyselam::OccupancyGrid withWalls(const hyselam::OccupancyGrid& grid) const;

 private:
  Place& at(Id place);
  void drawVirtualPlaces();
  /// Those whose names do not go on in the new map although carryOver() has found a successor.
  std::vector<Id> takeUnclear(const AugmentedTopologicalMap& before, const CarryOverReport& report);
  std::vector<Id> takeFromShelf();
  void nameFromShelf(const Place& shelved, Id place, const std::vector<std::string>& told);
  void putWalls();
  /// sameName() without the kinds of places in two languages: what takes a name from a place.
  bool sameSpelling(const std::string& a, const std::string& b) const;
  void dropWord(Place* place, const std::string& name, bool of_kind);

  PlaceNames names_;
  State state_;
};

}  // namespace hyselam_topo
