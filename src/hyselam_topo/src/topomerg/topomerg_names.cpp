#include "hyselam_topo/topomerg/topomerg_names.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/odds.hpp"
#include "hyselam_topo/topomerg/place_words.hpp"
#include "solutions.hpp"

namespace hyselam_topo {
namespace {

/// The largest vertex of a name; nothing if it has none.
std::optional<std::size_t> mainVertex(const MatchProblem& problem, const Assignment& assignment,
                                      std::size_t name) {
  std::optional<std::size_t> best;
  for (std::size_t v = 0; v < assignment.size(); ++v) {
    if (assignment[v] != static_cast<int>(name)) continue;
    if (!best || problem.area[v] > problem.area[*best]) best = v;
  }
  return best;
}

/// The probability that a name is right, from the logarithm x of the odds of the best answer
/// against the best one where it is not: 1 / (1 + exp(-(offset + factor x))), fitted on generated
/// floors.
struct Calibration {
  double offset, factor;
};
constexpr Calibration kPlaced{0.23, 1.61};
/// Of names without a place: where places of the map are in pieces or joined, none may fit.
constexpr Calibration kAbsent{0.14, 0.60};
/// Where the weights say nothing of odds, this drop is taken for one of e times.
constexpr double kDropOfShares = 0.01;

double probabilityOf(double drop, double scale, bool placed) {
  const double nats = scale > 0.0 ? drop * scale : drop / kDropOfShares;
  const Calibration& fitted = placed ? kPlaced : kAbsent;
  return hyselam::probabilityOf(fitted.offset + fitted.factor * nats);
}

/// The best fitness among kept assignments that have the name elsewhere; -1: none.
double keptElsewhere(const PlaceAssignment& match, std::size_t name,
                     const std::optional<std::size_t>& main) {
  const int i = static_cast<int>(name);
  double other = -1.0;
  for (const MatchSolution& s : match.solutions) {
    const bool elsewhere =
        main ? s.assignment[*main] != i
             : std::find(s.assignment.begin(), s.assignment.end(), i) != s.assignment.end();
    if (elsewhere) other = std::max(other, s.fitness);
  }
  return other;
}

/// Share of the equally good assignments that have the name at `main`, or nowhere if it is nothing.
double shareOfEqual(const PlaceAssignment& match, std::size_t name,
                    const std::optional<std::size_t>& main) {
  const int i = static_cast<int>(name);
  std::size_t same = 0;
  for (std::size_t k = 0; k < match.equal; ++k) {
    const Assignment& a = match.solutions[k].assignment;
    same += main ? a[*main] == i : std::find(a.begin(), a.end(), i) == a.end();
  }
  return static_cast<double>(same) / static_cast<double>(std::max<std::size_t>(1, match.equal));
}

/// The problem in which the name is not at `main`, or has a place if that is nothing.
MatchProblem otherwise(const MatchProblem& problem, std::size_t name,
                       const std::optional<std::size_t>& main) {
  MatchProblem without = problem;
  if (main)
    without.allowed[name].erase(*main);
  else
    without.attributes[name].needs_place = true;
  return without;
}

}  // namespace

std::size_t nearEqual(const PlaceAssignment& match, double odds) {
  if (!match.found() || !(match.scale > 0.0)) return match.equal;
  const double least = match.best().fitness - std::log(std::max(1.0, odds)) / match.scale;
  return static_cast<std::size_t>(std::count_if(
      match.solutions.begin(), match.solutions.end(),
      [least](const MatchSolution& s) { return s.fitness >= least - kEqualFitness; }));
}

std::vector<NameUncertainty> nameUncertainties(const MatchProblem& problem,
                                               const SolverParams& params,
                                               const PlaceAssignment& match) {
  std::vector<NameUncertainty> out;
  if (!match.found()) return out;
  const MatchSolution& best = match.best();
  SolverParams again = params;
  again.keep_within = 0.0;
  again.max_solutions = 1;
  const merging::Stopwatch watch;
  for (std::size_t i = 0; i < problem.nameCount(); ++i) {
    NameUncertainty u;
    u.name = problem.names[i];
    const auto main = mainVertex(problem, best.assignment, i);
    if (main) u.place = problem.vertices[*main];
    const bool confirmed = main && problem.confirmed_name[*main] == static_cast<int>(i);
    if (confirmed || problem.attributes[i].elsewhere) {
      u.drop = u.probability = 1.0;
      out.push_back(u);
      continue;
    }
    double other = keptElsewhere(match, i, main);
    if (other < best.fitness - kEqualFitness) {
      again.time_limit = std::max(0.0, params.time_limit - watch.seconds()) /
                         static_cast<double>(problem.nameCount() - i);
      const PlaceAssignment second = solveExact(otherwise(problem, i, main), again);
      if (second.found()) other = std::max(other, second.best().fitness);
      // What was not looked at in time may be as good as the gap says.
      u.proven = second.optimal;
      if (!second.optimal)
        other = std::max(other, second.gap + (second.found() ? second.best().fitness : 0.0));
    }
    u.drop = other < 0.0 ? best.fitness : std::max(0.0, best.fitness - other);
    u.probability = std::min(probabilityOf(u.drop, match.scale, main.has_value()),
                             shareOfEqual(match, i, main));
    out.push_back(u);
  }
  return out;
}

std::optional<MatchQuestion> mostInformativeQuestion(const MatchProblem& problem,
                                                     const PlaceAssignment& match,
                                                     const QuestionParams& params) {
  if (!(params.tolerance > 0.0))
    throw hyselam::ParameterError("tolerance", params.tolerance, "> 0");
  if (!match.found()) return std::nullopt;
  const double scale = match.scale > 0.0 ? match.scale : 1.0 / params.tolerance;
  std::vector<double> likely;
  double sum = 0.0;
  for (const MatchSolution& s : match.solutions) {
    likely.push_back(std::exp((s.fitness - match.best().fitness) * scale));
    sum += likely.back();
  }
  std::optional<MatchQuestion> best;
  for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
    if (problem.confirmed_name[v] >= 0) continue;
    std::map<int, double> share;
    for (std::size_t k = 0; k < likely.size(); ++k)
      share[match.solutions[k].assignment[v]] += likely[k] / sum;
    double bits = 0.0;
    for (const auto& [name, p] : share) bits -= p * std::log2(p);
    if (bits < 1e-9 || (best && bits <= best->bits + 1e-12)) continue;
    const auto top = std::max_element(share.begin(), share.end(), [](const auto& a, const auto& b) {
      return a.second < b.second;
    });
    best = MatchQuestion{problem.vertices[v],
                         top->first < 0 ? 0 : problem.names[static_cast<std::size_t>(top->first)],
                         top->second, bits};
  }
  return best;
}

AugmentedTopologicalMap withNames(const AugmentedTopologicalMap& map,
                                  const DescribedBuilding& building, const MatchProblem& problem,
                                  const MatchSolution& solution) {
  AugmentedTopologicalMap out = map;
  for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
    const int i = solution.assignment[v];
    Place* place = out.findPlace(problem.vertices[v]);
    const DescribedPlace* described =
        i < 0 ? nullptr : building.findPlace(problem.names[static_cast<std::size_t>(i)]);
    if (place == nullptr || described == nullptr) continue;
    giveWords(allNamesOf(*described), problem.confirmed_name[v] >= 0, place);
  }
  return out;
}

}  // namespace hyselam_topo
