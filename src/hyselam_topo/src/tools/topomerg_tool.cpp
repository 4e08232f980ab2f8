// topomerg HUMAN.xml TOPO.xml --out MERGED.xml: gives the places of a map the names of a person's
// description.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"
#include "hyselam_topo/topomerg/topomerg_names.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "place_and_name.hpp"

namespace {

using namespace hyselam_topo;  // NOLINT: a program, not a header

/// Of the searches for the uncertainty of names, all together [s].
constexpr double kUncertaintyLimit = 2.0;

/// "PLACE=NAME": the id of a place of the map and a name, or its id, of the description.
std::pair<Id, Id> namedPlace(const std::string& option, const std::string& text,
                             const DescribedBuilding& building) {
  const auto [place, name] = placeAndName(option, text);
  for (const DescribedPlace& p : building.places) {
    bool same = p.name == name || std::to_string(p.id) == name;
    for (const std::string& alias : p.aliases) same = same || alias == name;
    if (same) return {place, p.id};
  }
  std::string known;
  for (const DescribedPlace& p : building.places) known += (known.empty() ? "" : ", ") + p.name;
  throw hyselam::InputError(option, text,
                            "there is no such name in the description, which has: " + known);
}

nlohmann::json assignmentOf(const MatchProblem& problem, const DescribedBuilding& building,
                            const MatchSolution& solution) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t i = 0; i < problem.nameCount(); ++i) {
    nlohmann::json places = nlohmann::json::array();
    for (std::size_t v = 0; v < problem.vertexCount(); ++v)
      if (solution.assignment[v] == static_cast<int>(i)) places.push_back(problem.vertices[v]);
    out.push_back({{"id", problem.names[i]},
                   {"name", building.findPlace(problem.names[i])->name},
                   {"places", places}});
  }
  return out;
}

/// What a person wants to know: which place has which name, and what to ask.
void print(const nlohmann::json& result) {
  for (const nlohmann::json& name : result.at("assignment")) {
    std::cout << name.at("name").get<std::string>() << ": ";
    if (name.at("places").empty()) std::cout << "no place on the map (yet)";
    const char* before = "place ";
    for (const nlohmann::json& place : name.at("places")) {
      std::cout << before << place;
      before = ", ";
    }
    for (const nlohmann::json& each : result.value("uncertainties", nlohmann::json::array())) {
      if (each.at("id") != name.at("id") || !each.at("unsure").get<bool>()) continue;
      std::cout << " (unsure: right with a probability of "
                << std::lround(100.0 * each.at("probability").get<double>()) << " %"
                << (each.at("proven").get<bool>() ? ")" : ", too little time to rule others out)");
    }
    std::cout << '\n';
  }
  if (!result.contains("question")) return;
  const nlohmann::json& question = result.at("question");
  std::cout << "would ask: what is place " << question.at("place") << "?\n";
}

struct Options {
  std::string description_file, map_file, out, solver = "exact";
  SolverParams params;
  std::optional<Id> robot_place;
  std::optional<double> robot_heading;
  std::vector<double> robot_position;
  std::vector<std::string> confirmed, excluded;
  bool no_dummy = false, scattered = false, uncertainties = true, thesis_sides = false;
  bool equation52 = false;  ///< default weights of the thesis
};

void addInputs(CLI::App& app, Options& o) {
  app.add_option("HUMAN", o.description_file, "description (XML), as parse_description writes it")
      ->required();
  app.add_option("MAP", o.map_file, "topological map (XML), as gr2to writes it")->required();
  app.add_option("--out", o.out, "the map with the names, unconfirmed")->required();
  app.add_option("--solver", o.solver, "how the best answer is found")
      ->check(CLI::IsMember({"exact", "treesearch", "explorer"}));
  app.add_option("--robot-place", o.robot_place,
                 "id of the robot's place in the map: it has the name of the "
                 "robot's place in the description")
      ->default_str("0");
  app.add_option("--robot-heading", o.robot_heading,
                 "of the robot while the person spoke [rad]; without it the best one is taken")
      ->default_str("0");
  app.add_option(
         "--robot-position", o.robot_position,
         "where the robot stood: \"the second door on the left\" is counted from there [m m]")
      ->expected(2);
  app.add_option("--confirmed", o.confirmed, "PLACE=NAME: this place of the map has that name");
  app.add_option("--excluded", o.excluded, "PLACE=NAME: this place of the map has another name");
}

void addSearch(CLI::App& app, Options& o) {
  o.params.time_limit = 10.0;
  app.add_option("--time-limit", o.params.time_limit,
                 "of the exact solver [s]; then the best so far is taken and its gap reported")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--no-dummy", o.no_dummy, "every place of the map has a name (k_s = 0)");
  app.add_flag("--scattered", o.scattered, "places of one name need not be connected");
  app.add_option("--max-solutions", o.params.max_solutions,
                 "as many equally good answers are kept");
  app.add_option(
      "--uncertainties", o.uncertainties,
      "of the names; one more search for each, of two seconds at most for all: what they have "
      "not ruled out by then may be as good as the answer");
}

void addWeights(CLI::App& app, Options& o) {
  FitnessParams& fitness = o.params.fitness;
  app.add_flag(
      "--equation-52", o.equation52,
      "weights of the thesis instead of odds: each is shared by the statements of its type; "
      "the other options of weights have no effect");
  app.add_option("--weight-vertices", fitness.vertices, "gamma_v: a name has no place");
  app.add_option("--weight-areas", fitness.areas, "gamma_a");
  app.add_option("--weight-edges", fitness.edges, "gamma_e");
  app.add_option("--weight-orientations", fitness.orientations, "gamma_d");
  app.add_option("--weight-orders", fitness.orders, "A, then B; with doors only");
  app.add_flag(
      "--thesis-sides", o.thesis_sides,
      "sides by the centers of places, spread in the described order (Eq. 5.7); without it "
      "by doors");
  app.add_option("--weight-numbers", fitness.numbers, "the second on the left; in ten metres");
  app.add_option("--weight-relations", fitness.relations, "next to, opposite, ...");
  app.add_option("--weight-parts", fitness.parts, "numbers of rooms");
  app.add_option("--weight-doors", fitness.doors, "numbers of doors");
  app.add_option("--weight-size-words", fitness.size_words, "small, large");
  app.add_option("--weight-kinds", fitness.kinds, "corridor or room");
  app.add_option("--weight-pieces", fitness.pieces, "each further place of a name");
  app.add_option("--absent-share", fitness.absent_share,
                 "share of a statement's weight that is lost if one of its names has no place");
  app.add_option("--forgotten-edge", fitness.undescribed_edge_credit,
                 "0: doors that are not described count as errors; 1: not at all");
  app.add_option("--shut-door", fitness.closed_door_credit,
                 "share of a described door that remains where it is not on the map, but the two "
                 "places share a wall");
}

MatchProblem problemOf(const Options& o, const DescribedBuilding& building,
                       const AugmentedTopologicalMap& map) {
  MatchConstraints constraints;
  for (const std::string& text : o.confirmed)
    constraints.confirmed.push_back(namedPlace("--confirmed", text, building));
  for (const std::string& text : o.excluded)
    constraints.excluded.push_back(namedPlace("--excluded", text, building));
  MatchObserver observer{o.robot_place, o.robot_heading};
  if (o.robot_position.size() == 2)
    observer.position = hyselam::Point2{o.robot_position[0], o.robot_position[1]};
  return compileMatch(building, map, observer, constraints);
}

nlohmann::json uncertaintiesOf(const MatchProblem& problem, SolverParams params,
                               const PlaceAssignment& match, const DescribedBuilding& building) {
  params.time_limit = std::min(params.time_limit, kUncertaintyLimit);
  nlohmann::json list = nlohmann::json::array();
  for (const NameUncertainty& u : nameUncertainties(problem, params, match))
    list.push_back({{"id", u.name},
                    {"name", building.findPlace(u.name)->name},
                    {"place", u.place},
                    {"drop", u.drop},
                    {"probability", u.probability},
                    {"unsure", u.unsure()},
                    {"proven", u.proven}});
  return list;
}

nlohmann::json run(Options o) {
  const DescribedBuilding building = loadDescription(o.description_file);
  const AugmentedTopologicalMap map = loadXml(o.map_file);
  hyselam::Progress progress("topomerg", 3);
  o.params.dummy = !o.no_dummy;
  if (o.equation52) o.params.fitness = FitnessParams::equation52();
  if (o.thesis_sides) o.params.fitness.sides = SideRule::kCenters;
  o.params.connected = !o.scattered;
  const MatchProblem problem = problemOf(o, building, map);
  progress.update(1);
  const PlaceAssignment match = o.solver == "explorer"     ? exploreAll(problem, o.params)
                                : o.solver == "treesearch" ? treeSearch(problem, o.params)
                                                           : solveExact(problem, o.params);
  if (!match.found())
    throw hyselam::InputError(o.map_file, "",
                              "no answer satisfies what is confirmed, or none was found in time");
  progress.update(2);
  saveXml(o.out, withNames(map, building, problem, match.best()));

  nlohmann::json result{{"fitness", match.best().fitness},
                        {"solutions_equal", match.equal},
                        {"more_solutions", match.more},
                        {"optimal", match.optimal},
                        {"gap", match.gap},
                        {"solver", o.solver},
                        {"names", problem.nameCount()},
                        {"places", problem.vertexCount()},
                        {"heading", match.best().heading},
                        {"assignment", assignmentOf(problem, building, match.best())},
                        {"microseconds", match.microseconds},
                        {"nodes_expanded", match.nodes}};
  if (o.uncertainties)
    result["uncertainties"] = uncertaintiesOf(problem, o.params, match, building);
  if (const auto question = mostInformativeQuestion(problem, match))
    result["question"] = {{"place", question->place},
                          {"name", question->name},
                          {"probability", question->probability},
                          {"bits", question->bits}};
  progress.update(3);
  std::cout << "fitness " << match.best().fitness << " (1: the map is just as described), "
            << match.equal << (match.more ? "+" : "") << " equally good, " << match.nodes
            << " nodes, " << std::lround(match.microseconds) << " us -> " << o.out << '\n';
  print(result);
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Gives the places of a topological map the names of a person's description.",
               "topomerg");
  app.option_defaults()->always_capture_default();
  Options options;
  addInputs(app, options);
  addSearch(app, options);
  addWeights(app, options);
  return hyselam::runTool(argc, argv, app, [&] { return run(options); });
}
