// name_tour TEXT MAP --out MAP: gives the rooms beside a corridor of the map the names that
// somebody tells who shows the robot round.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <map>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_topo/topomerg/topomerg_names.hpp"
#include "hyselam_topo/topomerg/tour_names.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "place_and_name.hpp"

namespace {

using namespace hyselam_topo;  // NOLINT: a program, not a header
using nlohmann::json;

constexpr std::size_t kMaxBytes = 1u << 20;

struct Options {
  std::string text, map_file, out, language = "auto";
  Id robot_place = 0;
  double robot_heading = 0.0;
  std::vector<std::string> confirmed;
  double least = 0.5;
};

std::string textOf(const std::string& argument) {
  if (argument == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::error_code ignored;
  if (!std::filesystem::exists(argument, ignored))
    throw hyselam::InputError(argument, "", "there is no such file");
  return hyselam::readTextFile(argument, kMaxBytes);
}

/// What a person answered to "what is this place?": on the map as it was said.
using Answers = std::map<Id, std::string>;

Answers answersOf(const Options& o, const TourDoors& doors) {
  Answers answers;
  for (const std::string& text : o.confirmed) {
    const auto answer = placeAndName("--confirmed", text);
    if (std::find(doors.places.begin(), doors.places.end(), answer.first) == doors.places.end())
      throw hyselam::InputError("--confirmed", text, "the place is not beside the corridor");
    answers.insert(answer);
  }
  return answers;
}

/// A name of the tour, or another one.
TourConstraints constraintsOf(const Answers& answers, const TourReader& reader,
                              const ToldTour& tour, const TourDoors& doors) {
  TourConstraints known;
  for (std::size_t slot = 0; slot < doors.places.size(); ++slot) {
    const auto answer = answers.find(doors.places[slot]);
    if (answer == answers.end()) continue;
    if (const auto name = reader.find(tour, answer->second)) {
      known.confirmed.emplace_back(slot, *name);
    } else {
      known.unnamed.push_back(slot);
    }
  }
  return known;
}

AugmentedTopologicalMap withAnswers(AugmentedTopologicalMap map, const Answers& answers) {
  for (const auto& [id, name] : answers) {
    std::vector<PlaceTerm>& words = map.findPlace(id)->words;
    words.erase(std::remove_if(words.begin(), words.end(),
                               [](const PlaceTerm& word) { return !word.confirmed; }),
                words.end());
    words.insert(words.begin(), {name, true});
  }
  return map;
}

json roomsOf(const ToldTour& tour, const TourDoors& doors, const TourMatch& match,
             const Answers& answers) {
  json rooms = json::array();
  for (std::size_t slot = 0; slot < doors.places.size(); ++slot) {
    json room{{"place", doors.places[slot]},
              {"side", doors.slots[slot].is_left ? "left" : "right"},
              {"name", nullptr},
              {"probability", 0.0},
              {"bits", match.entropy(slot)}};
    const auto name = match.best[slot];
    if (name && tour.names[*name].is_name) {
      room["name"] = tour.names[*name].name;
      room["aliases"] = tour.names[*name].aliases;
      room["probability"] = match.of(slot, *name);
    }
    const auto answer = answers.find(doors.places[slot]);
    if (answer != answers.end()) room.update({{"name", answer->second}, {"probability", 1.0}});
    room["unsure"] = room["probability"] < kSureProbability;
    rooms.push_back(room);
  }
  return rooms;
}

void print(const json& result) {
  for (const json& room : result.at("rooms")) {
    std::cout << "place " << room.at("place") << ", " << room.at("side").get<std::string>() << ": ";
    if (room.at("name").is_null()) {
      std::cout << "nobody has told its name\n";
      continue;
    }
    std::cout << room.at("name").get<std::string>();
    if (room.at("unsure").get<bool>())
      std::cout << " (unsure: right with a probability of "
                << std::lround(100.0 * room.at("probability").get<double>()) << " %)";
    std::cout << '\n';
  }
  if (result.contains("question"))
    std::cout << "would ask: what is place " << result.at("question").at("place") << "?\n";
}

json run(const Options& o) {
  const std::string text = textOf(o.text);
  const AugmentedTopologicalMap map = loadXml(o.map_file);
  const TourDoors doors = doorsAlong(map, o.robot_place, o.robot_heading);
  if (doors.slots.empty())
    throw hyselam::InputError(o.map_file, "place " + std::to_string(o.robot_place),
                              "has no doors on its sides, looking along the heading");
  ParseOptions options;
  options.language = o.language;
  options.max_bytes = kMaxBytes;
  const Grammar grammar = Grammar::shipped(TopoParser().parse(text, options).language);
  const TourReader reader = TourReader::shipped(grammar);
  const ToldTour tour = reader.read(text);
  if (tour.empty())
    throw hyselam::InputError(o.text, "", "names no room: this is no tour of a building");
  const Answers answers = answersOf(o, doors);
  const TourMatch match =
      matchTour(tour.evidence, doors.slots, {}, constraintsOf(answers, reader, tour, doors));
  saveXml(o.out, withAnswers(withTourNames(map, doors, tour, match, o.least), answers));

  json result{{"language", grammar.language()},
              {"names", tour.names.size()},
              {"rooms", roomsOf(tour, doors, match, answers)}};
  if (const auto slot = match.question())
    result["question"] = {{"place", doors.places[*slot]}, {"bits", match.entropy(*slot)}};
  print(result);
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Gives the rooms beside a corridor of a topological map the names that somebody tells who "
      "shows the robot round, as people talk: no sentence has to be understood. Each name has a "
      "probability; what is not sure is asked.",
      "name_tour");
  app.option_defaults()->always_capture_default();
  Options options;
  app.add_option("TEXT", options.text, "file with what was said; - for the standard input")
      ->required();
  app.add_option("MAP", options.map_file, "topological map (XML), as gr2to writes it")->required();
  app.add_option("--out", options.out, "the map with the names, unconfirmed")->required();
  app.add_option("--robot-place", options.robot_place,
                 "id of the corridor in the map; the robot stood at its beginning")
      ->required();
  app.add_option("--robot-heading", options.robot_heading,
                 "of the robot, which looked along the corridor [rad]")
      ->required();
  app.add_option("--confirmed", options.confirmed,
                 "PLACE=NAME: what a person answered; a name of the tour, or another one");
  app.add_option("--least", options.least, "names that are less probable are left off the map")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--language", options.language, "en, pt, or auto: the one that understands most");
  return hyselam::runTool(argc, argv, app, [&] { return run(options); });
}
