// topomerg HUMAN.xml TOPO.xml --out MERGED.xml: gives the places of a map the names that a person
// has told.
#include "hyselam_topo/topomerg/topomerg.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_topo/topomerg/topomerg_names.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace {

using namespace hyselam_topo;  // NOLINT: a program, not a header

/// Of the searches that tell how sure the names are, all together [s].
constexpr double kUncertaintyLimit = 2.0;

/// "PLACE=NAME": the id of a place of the map and a name, or its id, of the description.
std::pair<Id, Id> namedPlace(const std::string& option, const std::string& text,
                             const DescribedBuilding& building) {
  const std::size_t sign = text.find('=');
  if (sign == std::string::npos || sign == 0)
    throw hyselam::InputError(option, text, "is not PLACE=NAME");
  Id place = 0;
  for (const char c : text.substr(0, sign)) {
    if (c < '0' || c > '9' || place > 100000000)
      throw hyselam::InputError(option, text, "does not begin with the id of a place");
    place = place * 10 + static_cast<Id>(c - '0');
  }
  const std::string name = text.substr(sign + 1);
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
    if (name.at("places").empty()) std::cout << "no place";
    const char* before = "place ";
    for (const nlohmann::json& place : name.at("places")) {
      std::cout << before << place;
      before = ", ";
    }
    for (const nlohmann::json& each : result.value("uncertainties", nlohmann::json::array())) {
      if (each.at("id") != name.at("id") || each.at("drop") > 0.0) continue;
      std::cout << (each.at("proven").get<bool>()
                        ? " (unsure: another answer is as good)"
                        : " (unsure: too little time to rule others out)");
    }
    std::cout << '\n';
  }
  if (!result.contains("question")) return;
  const nlohmann::json& question = result.at("question");
  std::cout << "would ask: what is place " << question.at("place") << "?\n";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Gives the places of a topological map the names that a person has told.",
               "topomerg");
  std::string human_file, map_file, out, solver = "exact";
  MatchParams params;
  MatchObserver observer;
  double limit = 10.0, heading = 0.0;
  Id robot_place = 0;
  bool no_dummy = false, scattered = false, uncertainties = true, thesis_sides = false;
  std::vector<std::string> confirmed, excluded;
  app.option_defaults()->always_capture_default();
  app.add_option("HUMAN", human_file, "description (XML), as parse_description writes it")
      ->required();
  app.add_option("MAP", map_file, "topological map (XML), as gr2to writes it")->required();
  app.add_option("--out", out, "the map with the names, unconfirmed")->required();
  app.add_option("--solver", solver, "how the best answer is found")
      ->check(CLI::IsMember({"exact", "treesearch", "explorer"}));
  CLI::Option* place_option =
      app.add_option("--robot-place", robot_place,
                     "id of the robot's place in the map: it has the name of the "
                     "robot's place in the description");
  CLI::Option* heading_option =
      app.add_option("--robot-heading", heading,
                     "of the robot while the person spoke [rad]; without it the best one is taken");
  app.add_option("--confirmed", confirmed, "PLACE=NAME: this place of the map has that name");
  app.add_option("--excluded", excluded, "PLACE=NAME: this place of the map has another name");
  app.add_option("--time-limit", limit,
                 "of the exact solver [s]; then the best so far is taken and its gap told")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--no-dummy", no_dummy, "every place of the map has a name (k_s = 0)");
  app.add_flag("--scattered", scattered, "places of one name need not hang together");
  app.add_option("--max-solutions", params.max_solutions, "as many equally good answers are kept");
  app.add_option("--weight-vertices", params.fitness.vertices, "gamma_v");
  app.add_option("--weight-areas", params.fitness.areas, "gamma_a");
  app.add_option("--weight-edges", params.fitness.edges, "gamma_e");
  app.add_option("--weight-orientations", params.fitness.orientations, "gamma_d");
  app.add_option("--weight-orders", params.fitness.orders, "A, then B; with doors only");
  app.add_flag("--thesis-sides", thesis_sides,
               "sides by the centres of places, spread in the order told (Eq. 5.7); without it by "
               "doors");
  app.add_option("--weight-relations", params.fitness.relations, "next to, opposite, ...");
  app.add_option("--weight-parts", params.fitness.parts, "numbers of rooms");
  app.add_option("--weight-kinds", params.fitness.kinds, "corridor or room");
  app.add_option("--forgotten-edge", params.fitness.forgotten_edge,
                 "0: doors that nobody told of count as mistakes; 1: not at all");
  app.add_option("--shut-door", params.fitness.shut_door,
                 "so much is left of a door that was told and is not on the map, if the two places "
                 "share a wall");
  app.add_option(
      "--uncertainties", uncertainties,
      "of the names; one more search for each, of two seconds at most for all: what they have "
      "not ruled out by then may be as good as the answer");

  return hyselam::runTool(argc, argv, app, [&] {
    const DescribedBuilding building = loadDescription(human_file);
    const AugmentedTopologicalMap map = loadXml(map_file);
    hyselam::Progress progress("topomerg", 3);
    if (place_option->count() > 0) observer.place = robot_place;
    if (heading_option->count() > 0) observer.heading = heading;
    params.time_limit = limit;
    params.dummy = !no_dummy;
    if (thesis_sides) params.fitness.sides = SideRule::kCentres;
    params.connected = !scattered;
    MatchConstraints constraints;
    for (const std::string& text : confirmed)
      constraints.confirmed.push_back(namedPlace("--confirmed", text, building));
    for (const std::string& text : excluded)
      constraints.excluded.push_back(namedPlace("--excluded", text, building));
    const MatchProblem problem = compileMatch(building, map, observer, constraints);
    progress.update(1);
    const Match match = solver == "explorer"     ? exploreAll(problem, params)
                        : solver == "treesearch" ? treeSearch(problem, params)
                                                 : solveExact(problem, params);
    if (!match.found())
      throw hyselam::InputError(map_file, "",
                                "no answer satisfies what is confirmed, or none was found in time");
    progress.update(2);
    saveXml(out, withNames(map, building, problem, match.best()));

    nlohmann::json result{{"fitness", match.best().fitness},
                          {"solutions_equal", match.equal},
                          {"more_solutions", match.more},
                          {"optimal", match.optimal},
                          {"gap", match.gap},
                          {"solver", solver},
                          {"names", problem.nameCount()},
                          {"places", problem.vertexCount()},
                          {"heading", match.best().heading},
                          {"assignment", assignmentOf(problem, building, match.best())},
                          {"microseconds", match.microseconds},
                          {"nodes_expanded", match.nodes}};
    if (uncertainties) {
      params.time_limit = std::min(limit, kUncertaintyLimit);
      nlohmann::json list = nlohmann::json::array();
      for (const NameUncertainty& u : nameUncertainties(problem, params, match))
        list.push_back({{"id", u.name},
                        {"name", building.findPlace(u.name)->name},
                        {"place", u.place},
                        {"drop", u.drop},
                        {"proven", u.proven}});
      result["uncertainties"] = list;
    }
    if (const auto question = mostInformativeQuestion(problem, match))
      result["question"] = {{"place", question->place},
                            {"name", question->name},
                            {"probability", question->probability},
                            {"bits", question->bits}};
    progress.update(3);
    std::cout << "fitness " << match.best().fitness << " (1: the map is just as it was told), "
              << match.equal << (match.more ? "+" : "") << " equally good, " << match.nodes
              << " nodes, " << std::lround(match.microseconds) << " us -> " << out << '\n';
    print(result);
    return result;
  });
}
