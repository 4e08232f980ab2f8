// merge_floors: made-up floors from the plan to the names. Each plan becomes a grid map, gr2to
// finds its places, a person who knows the plan describes it from where the robot stands, TopoMerg
// gives the names. Counted: names that are right at once, and questions until all are.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <optional>
#include <set>

#include "described_floors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"
#include "hyselam_topo/topomerg/topomerg_names.hpp"

namespace {

using namespace described_floors;  // NOLINT: a program, not a header

/// Of each name: the largest place that it was given to, 0: none.
std::vector<Id> placesOf(const MatchProblem& problem, const PlaceAssignment& match) {
  std::vector<Id> out;
  for (std::size_t i = 0; i < problem.nameCount(); ++i) {
    double most = -1.0;
    Id place = 0;
    for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
      if (match.best().assignment[v] != static_cast<int>(i) || problem.area[v] <= most) continue;
      most = problem.area[v];
      place = problem.vertices[v];
    }
    out.push_back(place);
  }
  return out;
}

/// Whether a name is right: its place lies in its room or, if gr2to has joined that to another,
/// holds it; one that was left out of the map has no place.
bool isRight(const Floor& floor, Id name, Id place) {
  if (floor.in_map.count(name) > 0) {
    const auto is = floor.truth.find(place);
    return is != floor.truth.end() && is->second == name;
  }
  const auto holds = floor.covered.find(name);
  return place == 0 || (holds != floor.covered.end() && holds->second.count(place) > 0);
}

/// The true name of each place of the map; -1: none.
Assignment trueNames(const MatchProblem& problem, const std::map<Id, Id>& truth) {
  Assignment out;
  for (const Id place : problem.vertices) {
    const auto is = truth.find(place);
    int name = -1;
    for (std::size_t i = 0; is != truth.end() && i < problem.nameCount(); ++i)
      if (problem.names[i] == is->second) name = static_cast<int>(i);
    out.push_back(name);
  }
  return out;
}

/// What was described, what is true and what was found, name by name.
void show(std::ostream& out, const DescribedBuilding& building, const MatchProblem& problem,
          const FitnessParams& params, const PlaceAssignment& match,
          const std::map<Id, Id>& truth) {
  const Assignment is = trueNames(problem, truth);
  const auto places = [&](const Assignment& names, std::size_t i) {
    std::string text;
    for (std::size_t v = 0; v < names.size(); ++v)
      if (names[v] == static_cast<int>(i)) text += " " + std::to_string(problem.vertices[v]);
    return text.empty() ? std::string(" none") : text;
  };
  out << "fitness " << match.best().fitness << ", of the truth " << fitness(problem, params, is)
      << ", equally good answers " << match.equal << '\n';
  for (std::size_t i = 0; i < problem.nameCount(); ++i) {
    const Id id = problem.names[i];
    out << (places(is, i) == places(match.best().assignment, i) ? "  " : "* ")
        << building.findPlace(id)->name << " (" << problem.attributes[i].area << " m2)";
    for (const DescribedConnection& c : building.connections)
      if (c.to == id)
        out << ", " << toString(c.side) << ' ' << c.order << " of "
            << building.findPlace(c.from)->name
            << (c.rank ? ", number " + std::to_string(*c.rank) : std::string());
    out << ": is" << places(is, i) << ", found" << places(match.best().assignment, i) << '\n';
  }
}

struct Options {
  int floors = 12;
  std::uint64_t first_seed = 1;
  FloorOptions floor;
  SolverParams params;
  bool thesis = false, thesis_sides = false, show_names = false, certainty = true;
};

/// The place that tells most; if all assignments agree, that of the least certain name; 0: none.
Id placeToAsk(const MatchProblem& problem, const SolverParams& params,
              const PlaceAssignment& match) {
  if (const auto question = mostInformativeQuestion(problem, match)) return question->place;
  Id place = 0;
  double least = 1.0;
  for (const NameUncertainty& u : nameUncertainties(problem, params, match)) {
    if (u.place == 0 || u.drop >= least) continue;
    least = u.drop;
    place = u.place;
  }
  return place;
}

struct Outcome {
  std::size_t questions = 0;
  std::size_t right_at_once = 0;  ///< of those that the map has a place for
  double fitness_at_once = 0.0;
  nlohmann::json names = nlohmann::json::array();
};

/// What was found of each name at once, and how sure that is.
nlohmann::json recordNames(const Options& o, const Floor& floor, const MatchProblem& problem,
                           const PlaceAssignment& match) {
  nlohmann::json out = nlohmann::json::array();
  SolverParams params = o.params;
  if (!o.certainty) params.time_limit = 0.0;
  for (const NameUncertainty& u : nameUncertainties(problem, params, match)) {
    if (floor.observer.place && u.name == floor.building.robot_place) continue;  // told
    out.push_back({{"name", u.name},
                   {"seen", floor.unseen.count(u.name) == 0},
                   {"joined", floor.unseen.count(u.name) == 0 && floor.in_map.count(u.name) == 0},
                   {"placed", u.place != 0},
                   {"right", isRight(floor, u.name, u.place)},
                   {"nats", u.drop * match.scale},
                   {"probability", u.probability},
                   {"unsure", u.unsure()}});
  }
  return out;
}

/// Asks until all names are right.
Outcome askUntilRight(const Options& o, std::uint64_t seed, const Floor& floor) {
  Outcome outcome;
  MatchConstraints constraints;
  std::set<Id> told;
  for (const DescribedPlace& place : floor.building.places) told.insert(place.id);
  while (true) {
    const MatchProblem problem =
        compileMatch(floor.building, floor.map, floor.observer, constraints);
    const PlaceAssignment match = solveExact(problem, o.params);
    if (!match.found()) break;
    const std::vector<Id> places = placesOf(problem, match);
    std::size_t count = 0, all = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Id name = problem.names[i];
      if (floor.in_map.count(name) == 0) continue;
      ++all;
      count += isRight(floor, name, places[i]);
    }
    if (outcome.questions == 0) {
      outcome.right_at_once = count;
      outcome.fitness_at_once = match.best().fitness;
      outcome.names = recordNames(o, floor, problem, match);
      if (o.show_names) {
        std::cerr << "floor " << seed << ": ";
        show(std::cerr, floor.building, problem, o.params.fitness, match, floor.truth);
      }
    }
    if (count == all || !o.certainty || outcome.questions == floor.map.places.size()) break;
    const Id place = placeToAsk(problem, o.params, match);
    if (place == 0) break;
    ++outcome.questions;
    const auto answer = floor.truth.find(place);
    if (answer == floor.truth.end() || told.count(answer->second) == 0)
      constraints.unnamed.push_back(place);
    else
      constraints.confirmed.emplace_back(place, answer->second);
  }
  return outcome;
}

struct Totals {
  std::size_t names = 0, at_once = 0, questions = 0, whole = 0, lost = 0;
  std::size_t whole_map_names = 0, whole_map_right = 0;
  std::size_t all = 0, all_right = 0, silently_wrong = 0, unsure_right = 0;
};

/// Adds a floor to the totals; returns its record.
nlohmann::json count(std::uint64_t seed, const Floor& floor, const Outcome& outcome,
                     Totals* total) {
  std::size_t in_map = 0;
  const std::size_t described = floor.building.places.size();
  for (const DescribedPlace& place : floor.building.places) in_map += floor.in_map.count(place.id);
  total->names += in_map;
  total->at_once += outcome.right_at_once;
  total->questions += outcome.questions;
  total->whole += outcome.questions == 0;
  // Rooms that the map has no place for, because gr2to joined them to another.
  total->lost += described - in_map - floor.unseen.size();
  if (described == in_map + floor.unseen.size()) {
    total->whole_map_names += in_map;
    total->whole_map_right += outcome.right_at_once;
  }
  for (const nlohmann::json& name : outcome.names) {
    const bool right = name.at("right"), unsure = name.at("unsure");
    ++total->all;
    total->all_right += right;
    total->silently_wrong += !right && !unsure;
    total->unsure_right += right && unsure;
  }
  return {{"seed", seed},
          {"told", described},
          {"unseen", floor.unseen.size()},
          {"places", floor.map.places.size()},
          {"in_map", in_map},
          {"right_at_once", outcome.right_at_once},
          {"questions", outcome.questions},
          {"fitness", outcome.fitness_at_once},
          {"names", outcome.names}};
}

nlohmann::json run(Options o) {
  if (o.thesis) o.params.fitness = FitnessParams::equation52();
  if (o.thesis_sides) o.params.fitness.sides = SideRule::kCenters;
  hyselam::Progress progress("merge_floors", static_cast<std::size_t>(o.floors));
  nlohmann::json records = nlohmann::json::array();
  Totals total;
  for (int k = 0; k < o.floors; ++k) {
    const std::uint64_t seed = o.first_seed + static_cast<std::uint64_t>(k);
    const Floor floor = makeFloor(o.floor, seed);
    records.push_back(count(seed, floor, askUntilRight(o, seed, floor), &total));
    progress.update(static_cast<std::size_t>(k + 1));
  }
  const auto percent = [](std::size_t part, std::size_t of) {
    return static_cast<double>(std::lround(1000.0 * static_cast<double>(part) /
                                           static_cast<double>(std::max<std::size_t>(1, of)))) /
           10.0;
  };
  std::cout << o.floors << " floors, " << total.names << " names on the map: " << total.at_once
            << " right at once (" << percent(total.at_once, total.names) << " %), " << total.whole
            << " floors without a question, " << total.questions
            << " questions until all are right\n"
            << "with names that the map has no place for: " << total.all_right << " of "
            << total.all << " right (" << percent(total.all_right, total.all) << " %), "
            << total.silently_wrong << " wrong and not told as unsure, " << total.unsure_right
            << " right and told as unsure\n";
  return {{"names", total.names},
          {"right_at_once", total.at_once},
          {"names_without_place", total.lost},
          {"names_in_whole_maps", total.whole_map_names},
          {"right_in_whole_maps", total.whole_map_right},
          {"questions", total.questions},
          {"floors_without_question", total.whole},
          {"all_names", total.all},
          {"all_right", total.all_right},
          {"silently_wrong", total.silently_wrong},
          {"unsure_right", total.unsure_right},
          {"floors", records}};
}

void addWeights(CLI::App& app, FitnessParams& fitness) {
  app.add_option("--weight-vertices", fitness.vertices, "a name has no place");
  app.add_option("--weight-areas", fitness.areas, "sizes");
  app.add_option("--weight-edges", fitness.edges, "joined as described");
  app.add_option("--weight-orientations", fitness.orientations, "on the described side");
  app.add_option("--weight-kinds", fitness.kinds, "corridor or room");
  app.add_option("--weight-orders", fitness.orders, "A, then B");
  app.add_option("--weight-numbers", fitness.numbers, "the second on the left");
  app.add_option("--weight-relations", fitness.relations, "next to");
  app.add_option("--weight-pieces", fitness.pieces, "a further place of a name");
  app.add_option("--absent-share", fitness.absent_share, "lost of a statement without a place");
  app.add_option("--forgotten-edge", fitness.undescribed_edge_credit, "as of topomerg");
  app.add_option("--shut-door", fitness.closed_door_credit, "as of topomerg");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures how many names are right on made-up floors.", "merge_floors");
  Options o;
  o.params.time_limit = 1.0;
  o.params.keep_within = 0.01;
  app.option_defaults()->always_capture_default();
  app.add_option("--floors", o.floors, "number of floors");
  app.add_option("--seed", o.first_seed, "of the first floor");
  app.add_option("--told-sizes", o.floor.speaker.told_sizes,
                 "share of the sizes that are described");
  app.add_option("--wrong-sizes", o.floor.speaker.wrong_sizes,
                 "share of those that are half or twice");
  app.add_option("--confused-sides", o.floor.speaker.confused_sides,
                 "left for right, front for back");
  app.add_option("--ordinals", o.floor.speaker.ordinals,
                 "share of the sides of the robot's place that are told by numbers of doors");
  app.add_option("--relations", o.floor.speaker.relations, "as often \"A is next to B\" is told");
  app.add_option("--unseen", o.floor.unseen, "share of the rooms that are told, not on the map");
  app.add_option("--untold", o.floor.untold, "share of the rooms that are on the map, not told");
  app.add_option("--shut-doors", o.floor.closed_doors, "doors that are closed during the mapping");
  app.add_flag("--equation-52", o.thesis, "weights of the thesis");
  app.add_flag("--thesis-sides", o.thesis_sides, "by centers, spread as described (Eq. 5.7)");
  app.add_option("--time-limit", o.params.time_limit, "of each search [s]");
  app.add_option("--know-heading", o.floor.know_heading, "the robot's heading is known");
  app.add_option("--know-position", o.floor.know_position, "where the robot stands is known");
  app.add_option("--certainty", o.certainty, "how sure each name is, by one more search for each");
  app.add_flag("--show", o.show_names, "names described, true and found, to standard error");
  addWeights(app, o.params.fitness);
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
