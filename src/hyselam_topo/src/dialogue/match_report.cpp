#include "match_report.hpp"

#include <algorithm>
#include <iterator>

#include "hyselam_topo/topomerg/topomerg_names.hpp"
#include "match_constraints.hpp"

namespace hyselam_topo {
namespace {

/// The places of the map that the kept answers give a name to, without repetition.
std::vector<Id> placesOf(int name, const PlaceAssignment& match, const MatchProblem& problem) {
  std::vector<Id> places;
  for (const MatchSolution& solution : match.solutions) {
    for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
      const Id place = problem.vertices[v];
      const bool new_one = std::find(places.begin(), places.end(), place) == places.end();
      if (nameAt(solution, v) == name && new_one) places.push_back(place);
    }
  }
  return places;
}

std::vector<Id> only(const std::set<Id>& a, const std::set<Id>& b) {
  std::vector<Id> difference;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(difference));
  return difference;
}

}  // namespace

GuessedPlaces guessedPlaces(const PlaceMan& places, const DescribedBuilding& building) {
  GuessedPlaces guessed;
  for (const DescribedPlace& described : building.places) {
    for (const Id id : places.find(described.name)) {
      if (nameStateOf(*places.map().findPlace(id)) == NameState::kUnconfirmed) {
        guessed[described.name].insert(id);
      }
    }
  }
  return guessed;
}

std::vector<MovedName> movedNames(const GuessedPlaces& before, const PlaceMan& places,
                                  const DescribedBuilding& building) {
  std::vector<MovedName> moved;
  const GuessedPlaces after = guessedPlaces(places, building);
  for (const auto& [name, from] : before) {
    const bool told = std::any_of(building.places.begin(), building.places.end(),
                                  [&, &known = name](const auto& p) { return p.name == known; });
    if (!told) continue;
    const auto now = after.find(name);
    if (now == after.end()) {
      const std::vector<Id> found = places.find(name);
      if (found.empty()) moved.push_back({name, {from.begin(), from.end()}, {}});
      continue;
    }
    MovedName each{name, only(from, now->second), only(now->second, from)};
    if (!each.from.empty() && !each.to.empty()) moved.push_back(std::move(each));
  }
  return moved;
}

Uncertainty uncertaintyOf(const PlaceAssignment& match, const MatchProblem& problem,
                          const SolverParams& params, const DescribedBuilding& building) {
  Uncertainty unsure;
  if (!match.found()) return unsure;
  const auto add = [&](Id name) {
    const DescribedPlace* place = building.findPlace(name);
    if (place != nullptr) unsure.names.insert(place->name);
  };
  const EqualAnswers equal = equalAnswers(match);
  if (match.equal >= 2 && equal.count >= 2) {
    unsure.answers = equal.count;
    unsure.more = match.more;
    for (const int name : equal.unsure) add(problem.names.at(static_cast<std::size_t>(name)));
  }
  for (const NameUncertainty& each : nameUncertainties(problem, params, match)) {
    if (each.place != 0 && each.unsure()) add(each.name);
  }
  for (std::size_t n = 0; n < problem.nameCount(); ++n) {
    const DescribedPlace* place = building.findPlace(problem.names[n]);
    if (place == nullptr || unsure.names.count(place->name) == 0) continue;
    std::vector<Id> places = placesOf(static_cast<int>(n), match, problem);
    if (!places.empty()) unsure.places[place->name] = std::move(places);
  }
  return unsure;
}

}  // namespace hyselam_topo
