// PlaceMan (dos Santos, section 3.2.2): keeps what people have said about the places of the robot's
// map: names that are confirmed or only guessed, virtual places, walls of glass and virtual walls.
// All of it stays when the map is segmented again.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_language/building/place_names.hpp"
#include "hyselam_topo/dialogue/glass_wall.hpp"
#include "hyselam_topological_map/carry_over.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// "SS01" for rooms, "CC04" for corridors (Fig. 7.9), "VV05" for virtual places: the code word of a
/// place, from its id.
std::string codeOf(const Place& place);

/// How sure the name of a place is (the colours of Fig. 7.10).
enum class NameState {
  kNone,         ///< no word: green
  kUnconfirmed,  ///< guessed: red
  kConfirmed     ///< a person has said or confirmed it: blue
};
NameState nameStateOf(const Place& place);

/// The words of a place, confirmed ones only if there are any.
std::vector<std::string> namesOf(const Place& place);

/// A wall that a person has described.
struct DescribedWall {
  GlassWall line;
  WallKind kind = WallKind::kGlass;  ///< or kVirtual
};
bool operator==(const DescribedWall& a, const DescribedWall& b);

class PlaceMan {
 public:
  /// All that is kept; a plain value, for files.
  struct State {
    AugmentedTopologicalMap map;  ///< with the names; no places: there was no map yet
    std::vector<DescribedWall> walls;
    /// This place does not have that name: a person has said no.
    std::vector<std::pair<Id, std::string>> rejected;
  };

  explicit PlaceMan(PlaceNames names);

  /// Goes on with a state kept before. Throws hyselam::InputError for a map that checkMap() refuses
  /// and for walls that are not finite.
  void restore(State state);
  const State& state() const { return state_; }
  const AugmentedTopologicalMap& map() const { return state_.map; }
  bool hasMap() const { return !state_.map.places.empty(); }

  /// A new segmentation of the grid map: ids, names, virtual places and walls go on (carryOver()).
  /// The ids of map() are those of the first map and then its own. Throws as carryOver().
  CarryOverReport setMap(const AugmentedTopologicalMap& fresh);

  // ---- Names. Those of places that are not in the map throw hyselam::InputError. ----
  /// A person has said so: the names are confirmed here, guesses here are dropped, and the names
  /// leave all other places that do not lie beside this one. Returns the places that had one of
  /// them confirmed and lost it.
  std::vector<Id> confirm(Id place, const std::vector<std::string>& names);
  /// The guesses of this place are right. False if it has none.
  bool confirmGuesses(Id place);
  /// A person has said no: never guessed here again.
  void reject(Id place, const std::vector<std::string>& names);
  bool isRejected(Id place, const std::string& name) const;
  /// Guesses instead of all guesses there were. Confirmed and rejected names stay as they are.
  void guess(const std::vector<std::pair<Id, std::vector<std::string>>>& guesses);
  /// All names of a place go. False if it had none.
  bool forget(Id place);
  /// A name goes, everywhere. The places that had it.
  std::vector<Id> forgetName(const std::string& name);
  /// With those that were refused.
  void forgetAllNames();
  /// All names of a place go and another one is confirmed.
  void rename(Id place, const std::string& name);

  /// The places that a name or code word means: those where it is confirmed, else those where it is
  /// guessed.
  std::vector<Id> find(const std::string& name) const;
  /// Whether both mean the same place.
  bool sameName(const std::string& a, const std::string& b) const;

  // ---- Virtual places and walls ----
  /// A place that is cut out of the one around `centre`: its cells within `radius` [m]. Returns its
  /// id. Throws hyselam::InputError if the centre lies on no place, or the radius is not in
  /// (0, 100].
  Id addVirtualPlace(hyselam::Point2 centre, double radius, const std::vector<std::string>& names);
  /// Its cells go back to the place around it. False if there is no such virtual place.
  bool removeVirtualPlace(Id place);
  /// Throws hyselam::InputError for a wall that is not finite or has no length.
  void addWall(const DescribedWall& wall);
  /// The wall of that number in walls(). False if there is none.
  bool removeWall(std::size_t index);
  const std::vector<DescribedWall>& walls() const { return state_.walls; }
  /// A copy of the grid map with all walls of glass and virtual walls drawn into it.
  hyselam::OccupancyGrid withWalls(const hyselam::OccupancyGrid& grid) const;

 private:
  Place& at(Id place);
  void drawVirtualPlaces();
  void putWalls();
  void dropWord(Place* place, const std::string& name);

  PlaceNames names_;
  State state_;
};

}  // namespace hyselam_topo
