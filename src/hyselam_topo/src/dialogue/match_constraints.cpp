#include "match_constraints.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

namespace hyselam_topo {

MatchConstraints constraintsOf(const PlaceMan& places, const DescriptionBuilder& builder) {
  MatchConstraints constraints;
  const auto described = [&](const std::string& name) -> Id {
    const std::vector<Id> found = builder.find(name);
    return found.size() == 1 ? found.front() : 0;
  };
  for (const Place& place : places.map().places) {
    // Told of under the map's own name for it.
    Id id = described(codeOf(place));
    if (id != 0) constraints.confirmed.emplace_back(place.id, id);
    if (id != 0 || nameStateOf(place) != NameState::kConfirmed) continue;
    for (const std::string& name : namesOf(place)) {
      if (id == 0) id = described(name);
    }
    if (id != 0) {
      constraints.confirmed.emplace_back(place.id, id);
    } else {
      constraints.unnamed.push_back(place.id);
    }
  }
  std::set<std::pair<Id, Id>> excluded;
  for (const auto& [place, name] : places.state().rejected) {
    const Id id = described(name);
    const std::pair<Id, Id> pair{place, id};
    const bool settled =
        std::any_of(constraints.confirmed.begin(), constraints.confirmed.end(),
                    [&](const auto& c) { return c.first == pair.first; }) ||
        std::count(constraints.unnamed.begin(), constraints.unnamed.end(), pair.first) > 0;
    if (id != 0 && !settled) excluded.insert(pair);
  }
  constraints.excluded.assign(excluded.begin(), excluded.end());
  return constraints;
}

}  // namespace hyselam_topo
