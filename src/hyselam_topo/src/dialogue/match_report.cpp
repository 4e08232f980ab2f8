#include "match_report.hpp"

#include <algorithm>
#include <iterator>

#include "hyselam_topo/topomerg/topomerg_names.hpp"

namespace hyselam_topo {
namespace {

/// Answers that are as good as the best one.
struct EqualAnswers {
  std::size_t count = 0;    ///< with the best one
  std::vector<int> unsure;  ///< names that they put in different places
};

/// Answers that only give a name more places say less than the one with the fewest, which is taken:
/// they do not count.
EqualAnswers equalAnswers(const PlaceAssignment& match) {
  EqualAnswers answers;
  const MatchSolution& best = match.best();
  const std::size_t known = std::min(match.equal, match.solutions.size());
  std::set<int> unsure;
  for (std::size_t s = 0; s < known; ++s) {
    const MatchSolution& other = match.solutions[s];
    if (other.vertices != best.vertices) continue;
    ++answers.count;
    for (std::size_t v = 0; v < best.assignment.size(); ++v) {
      const int here = nameAt(best, v), there = nameAt(other, v);
      if (here == there) continue;
      if (here >= 0) unsure.insert(here);
      if (there >= 0) unsure.insert(there);
    }
  }
  answers.unsure.assign(unsure.begin(), unsure.end());
  return answers;
}

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

/// Of each name the vertices where it was guessed; empty where it was not.
std::vector<PlaceSet> verticesOf(const GuessedPlaces& guessed, const MatchProblem& problem,
                                 const DescribedBuilding& building) {
  std::vector<PlaceSet> vertices(problem.nameCount());
  for (std::size_t i = 0; i < problem.nameCount(); ++i) {
    const DescribedPlace* place = building.findPlace(problem.names[i]);
    const auto found = place == nullptr ? guessed.end() : guessed.find(place->name);
    if (found == guessed.end()) continue;
    for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
      if (found->second.count(problem.vertices[v]) != 0) vertices[i].insert(v);
    }
  }
  return vertices;
}

}  // namespace

int nameAt(const MatchSolution& solution, std::size_t vertex) {
  return solution.assignment[vertex];
}

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

void leaveWhereGuessed(const GuessedPlaces& before, const MatchProblem& problem,
                       const SolverParams& params, const DescribedBuilding& building,
                       PlaceAssignment* match) {
  if (before.empty() || !match->found() || match->equal < 2) return;
  const std::vector<PlaceSet> known = verticesOf(before, problem, building);
  const auto left = [&](const MatchSolution& solution) {
    std::size_t count = 0;
    for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
      const int name = nameAt(solution, v);
      count += name >= 0 && known[static_cast<std::size_t>(name)].contains(v);
    }
    return count;
  };
  std::vector<MatchSolution>& all = match->solutions;
  if (match->more) {
    MatchProblem as_before = problem;
    for (std::size_t i = 0; i < known.size(); ++i) {
      if (!known[i].empty()) as_before.allowed[i] &= known[i];
    }
    SolverParams one = params;
    one.max_solutions = 1;
    one.keep_within = 0.0;
    const PlaceAssignment found = solveExact(as_before, one);
    if (found.found() && found.best().fitness >= match->best().fitness - kEqualFitness &&
        std::find_if(all.begin(), all.end(), [&](const MatchSolution& s) {
          return s.assignment == found.best().assignment;
        }) == all.end()) {
      all.insert(all.begin() + 1, found.best());
      ++match->equal;
    }
  }
  auto best = all.begin();
  const auto equal = all.begin() + static_cast<std::ptrdiff_t>(match->equal);
  for (auto s = all.begin() + 1; s != equal; ++s) {
    if (s->vertices <= all.front().vertices && left(*s) > left(*best)) best = s;
  }
  std::rotate(all.begin(), best, best + 1);
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
  const std::set<std::string> elsewhere = unsure.names;
  for (const NameUncertainty& each : nameUncertainties(problem, params, match)) {
    if (each.place == 0) continue;
    if (each.unsure()) add(each.name);
    const DescribedPlace* place = building.findPlace(each.name);
    if (place == nullptr || elsewhere.count(place->name) != 0) continue;
    if (each.probability >= kLikelyProbability) unsure.likely[place->name] = each.place;
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
