// merge_floors: made-up floors from the plan to the names. Each plan becomes a grid map, gr2to
// finds its places, a person who knows the plan describes it from where the robot stands, TopoMerg
// gives the names. Counted: names that are right at once, and questions until all are.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "../test/random_matches.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"
#include "hyselam_topo/topomerg/topomerg_names.hpp"

namespace {

using namespace hyselam_topo;  // NOLINT: a program, not a header
using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;
using random_matches::Dice;

struct Speaker {
  double told_sizes = 0.6;
  double wrong_sizes = 0.0;
  int confused_sides = 0;
};

double areaOf(const hyselam_sim::Polygon& outline) {
  double twice = 0.0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point2& p = outline[k];
    const Point2& q = outline[(k + 1) % outline.size()];
    twice += p.x * q.y - q.x * p.y;
  }
  return 0.5 * std::abs(twice);
}

/// Place k of the plan has the id k + 1; 0: none.
Id placeAt(const hyselam_sim::FloorPlan& plan, Point2 p) {
  for (std::size_t k = 0; k < plan.places.size(); ++k)
    if (hyselam_sim::contains(plan.places[k].outline, p)) return static_cast<Id>(k + 1);
  return 0;
}

struct Passage {
  Id a = 0, b = 0;
  Point2 at, normal;  ///< the normal from a to b
};

std::vector<Passage> passages(const hyselam_sim::FloorPlan& plan) {
  std::vector<Passage> out;
  for (const auto& door : plan.doors) {
    const Point2 n{-door.along.y, door.along.x};
    const auto beside = [&](double sign) {
      for (const double d : {0.2, 0.4, 0.7})
        if (const Id id = placeAt(plan, {door.at.x + sign * d * n.x, door.at.y + sign * d * n.y}))
          return id;
      return Id{0};
    };
    const Id a = beside(-1.0), b = beside(1.0);
    if (a != 0 && b != 0 && a != b) out.push_back({a, b, door.at, n});
  }
  return out;
}

/// What a person who stands in the place with most doors and looks along it tells, from there on.
DescribedBuilding describe(const hyselam_sim::FloorPlan& plan, const Speaker& speaker, Dice* dice,
                           double* heading) {
  const std::vector<Passage> doors = passages(plan);
  std::map<Id, int> count;
  for (const Passage& d : doors) {
    ++count[d.a];
    ++count[d.b];
  }
  Id root = 1;
  for (const auto& [id, n] : count)
    if (n > count[root]) root = id;
  const auto& outline = plan.places[root - 1].outline;
  double longest = 0.0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point2& p = outline[k];
    const Point2& q = outline[(k + 1) % outline.size()];
    const double length = std::hypot(q.x - p.x, q.y - p.y);
    if (length <= longest) continue;
    longest = length;
    *heading = std::atan2(q.y - p.y, q.x - p.x);
  }

  DescribedBuilding out;
  out.robot_place = root;
  for (std::size_t k = 0; k < plan.places.size(); ++k) {
    DescribedPlace place;
    place.id = static_cast<Id>(k + 1);
    place.name = plan.places[k].name;
    if (place.name.find("corridor") != std::string::npos) place.kind = PlaceKind::kCorridor;
    if (dice->chance(speaker.told_sizes)) {
      place.area = areaOf(plan.places[k].outline) * dice->real(0.92, 1.08);
      if (dice->chance(speaker.wrong_sizes)) *place.area *= dice->chance(0.5) ? 2.0 : 0.5;
    }
    out.places.push_back(place);
  }
  // Place by place outwards; along each side in the direction that the robot looks.
  std::set<Id> known{root};
  std::vector<Id> waiting{root};
  std::set<std::pair<Id, Id>> told;
  for (std::size_t w = 0; w < waiting.size(); ++w) {
    const Id from = waiting[w];
    std::map<Side, std::vector<std::pair<double, Id>>> rows;
    for (const Passage& d : doors) {
      if (d.a != from && d.b != from) continue;
      const Id to = d.a == from ? d.b : d.a;
      if (!told.insert({std::min(from, to), std::max(from, to)}).second) continue;
      const double sign = d.a == from ? 1.0 : -1.0;
      const double turn =
          std::remainder(std::atan2(sign * d.normal.y, sign * d.normal.x) - *heading, 2 * M_PI);
      const Side side = std::abs(turn) < M_PI / 4       ? Side::kFront
                        : std::abs(turn) > 3 * M_PI / 4 ? Side::kBack
                        : turn > 0                      ? Side::kLeft
                                                        : Side::kRight;
      const bool across = side == Side::kFront || side == Side::kBack;
      const double along = across ? std::sin(*heading) * d.at.x - std::cos(*heading) * d.at.y
                                  : std::cos(*heading) * d.at.x + std::sin(*heading) * d.at.y;
      rows[side].emplace_back(along, to);
      if (known.insert(to).second) waiting.push_back(to);
    }
    for (auto& [side, row] : rows) {
      std::sort(row.begin(), row.end());
      for (std::size_t k = 0; k < row.size(); ++k) {
        DescribedConnection c;
        c.from = from;
        c.to = row[k].second;
        c.side = side;
        c.order = k;
        out.connections.push_back(c);
      }
    }
  }
  for (int k = 0; k < speaker.confused_sides && !out.connections.empty(); ++k) {
    auto& c = out.connections[static_cast<std::size_t>(
        dice->whole(0, static_cast<int>(out.connections.size()) - 1))];
    c.side = c.side == Side::kLeft    ? Side::kRight
             : c.side == Side::kRight ? Side::kLeft
             : c.side == Side::kFront ? Side::kBack
                                      : Side::kFront;
  }
  return out;
}

/// Closes as many doors: rooms behind them are on the map, but no path leads into them.
void shutDoors(hyselam_sim::FloorPlan* plan, int count, std::uint64_t seed) {
  Dice dice(seed ^ 0x5A5A5A5Au);
  std::vector<std::size_t> open(plan->doors.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  for (; count > 0 && !open.empty(); --count) {
    const auto k = open.begin() + dice.whole(0, static_cast<int>(open.size()) - 1);
    plan->doors[*k].initially_open = false;
    plan->doors[*k].schedule.clear();
    open.erase(k);
  }
}

/// The place of the plan that most cells of each place of the map lie in.
std::map<Id, Id> truthOf(const hyselam_sim::FloorPlan& plan, const Gr2ToResult& found) {
  std::map<Id, std::map<Id, int>> votes;
  const PlaceGrid& grid = *found.map.grid;
  for (int y = 0; y < grid.geometry.height; ++y)
    for (int x = 0; x < grid.geometry.width; ++x)
      if (const Id id = grid.placeOf({x, y}))
        if (const Id plan_id = placeAt(plan, grid.geometry.center({x, y}))) ++votes[id][plan_id];
  std::map<Id, Id> out;
  for (const auto& [id, counts] : votes)
    out[id] = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                return a.second < b.second;
              })->first;
  return out;
}

/// Names whose largest place is theirs.
std::vector<bool> rightNames(const MatchProblem& problem, const PlaceAssignment& match,
                             const std::map<Id, Id>& truth) {
  std::vector<bool> out;
  for (std::size_t i = 0; i < problem.nameCount(); ++i) {
    double most = -1.0;
    bool right = false;
    for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
      if (match.best().assignment[v] != static_cast<int>(i) || problem.area[v] <= most) continue;
      most = problem.area[v];
      const auto found = truth.find(problem.vertices[v]);
      right = found != truth.end() && found->second == problem.names[i];
    }
    out.push_back(right);
  }
  return out;
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
            << building.findPlace(c.from)->name;
    out << ": is" << places(is, i) << ", found" << places(match.best().assignment, i) << '\n';
  }
}

struct Options {
  int floors = 12;
  std::uint64_t first_seed = 1;
  Speaker speaker;
  SolverParams params;
  bool thesis_sides = false, know_heading = true, show_names = false;
  int closed_doors = 0;
};

/// One floor, from its plan to the description and the map.
struct Floor {
  DescribedBuilding building;
  AugmentedTopologicalMap map;
  std::map<Id, Id> truth;
  std::set<Id> in_map;  ///< names that the map has a place for
  MatchObserver observer;
};

Floor makeFloor(const Options& o, std::uint64_t seed) {
  Floor floor;
  Dice dice(seed);
  auto plan = hyselam_sim::generatePlan(seed);
  shutDoors(&plan, o.closed_doors, seed);
  const OccupancyGrid grid = hyselam_sim::rasterize(plan, 0.05, 0.0);
  const Gr2ToResult found = gr2to(grid);
  floor.map = found.map;
  floor.truth = truthOf(plan, found);
  double heading = 0.0;
  floor.building = describe(plan, o.speaker, &dice, &heading);
  double largest = 0.0;
  for (const Place& place : floor.map.places) {
    const auto is = floor.truth.find(place.id);
    if (is == floor.truth.end() || is->second != *floor.building.robot_place ||
        place.area <= largest)
      continue;
    largest = place.area;
    floor.observer.place = place.id;
  }
  if (o.know_heading) floor.observer.heading = heading;
  for (const auto& [place, name] : floor.truth) floor.in_map.insert(name);
  return floor;
}

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
  std::size_t right_at_once = 0;
  double fitness_at_once = 0.0;
};

/// Asks until all names are right.
Outcome askUntilRight(const Options& o, std::uint64_t seed, const Floor& floor) {
  Outcome outcome;
  MatchConstraints constraints;
  while (true) {
    const MatchProblem problem =
        compileMatch(floor.building, floor.map, floor.observer, constraints);
    const PlaceAssignment match = solveExact(problem, o.params);
    if (!match.found()) break;
    const std::vector<bool> right = rightNames(problem, match, floor.truth);
    std::size_t count = 0;
    for (std::size_t i = 0; i < right.size(); ++i)
      count += right[i] && floor.in_map.count(problem.names[i]) > 0;
    if (outcome.questions == 0) {
      outcome.right_at_once = count;
      outcome.fitness_at_once = match.best().fitness;
      if (o.show_names) {
        std::cerr << "floor " << seed << ": ";
        show(std::cerr, floor.building, problem, o.params.fitness, match, floor.truth);
      }
    }
    if (count == floor.in_map.size() || outcome.questions == floor.map.places.size()) break;
    const Id place = placeToAsk(problem, o.params, match);
    if (place == 0) break;
    ++outcome.questions;
    const auto answer = floor.truth.find(place);
    if (answer == floor.truth.end())
      constraints.unnamed.push_back(place);
    else
      constraints.confirmed.emplace_back(place, answer->second);
  }
  return outcome;
}

nlohmann::json run(Options o) {
  if (o.thesis_sides) o.params.fitness.sides = SideRule::kCenters;
  hyselam::Progress progress("merge_floors", static_cast<std::size_t>(o.floors));
  nlohmann::json records = nlohmann::json::array();
  std::size_t names = 0, at_once = 0, all_questions = 0, whole = 0, lost = 0;
  std::size_t whole_map_names = 0, whole_map_right = 0;
  for (int k = 0; k < o.floors; ++k) {
    const std::uint64_t seed = o.first_seed + static_cast<std::uint64_t>(k);
    const Floor floor = makeFloor(o, seed);
    const Outcome outcome = askUntilRight(o, seed, floor);
    const std::size_t in_map = floor.in_map.size(), described = floor.building.places.size();
    names += in_map;
    at_once += outcome.right_at_once;
    all_questions += outcome.questions;
    whole += outcome.questions == 0;
    // Rooms that the map has no place for, because gr2to joined them to another.
    lost += described - in_map;
    if (described == in_map) {
      whole_map_names += in_map;
      whole_map_right += outcome.right_at_once;
    }
    records.push_back({{"seed", seed},
                       {"told", described},
                       {"places", floor.map.places.size()},
                       {"in_map", in_map},
                       {"right_at_once", outcome.right_at_once},
                       {"questions", outcome.questions},
                       {"fitness", outcome.fitness_at_once}});
    progress.update(static_cast<std::size_t>(k + 1));
  }
  const double share =
      static_cast<double>(at_once) / static_cast<double>(std::max<std::size_t>(1, names));
  std::cout << o.floors << " floors, " << names << " names: " << at_once << " right at once ("
            << std::lround(1000.0 * share) / 10.0 << " %), " << whole
            << " floors without a question, " << all_questions
            << " questions until all are right\n";
  return {{"names", names},
          {"right_at_once", at_once},
          {"names_without_place", lost},
          {"names_in_whole_maps", whole_map_names},
          {"right_in_whole_maps", whole_map_right},
          {"questions", all_questions},
          {"floors_without_question", whole},
          {"floors", records}};
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
  app.add_option("--told-sizes", o.speaker.told_sizes, "share of the sizes that are described");
  app.add_option("--wrong-sizes", o.speaker.wrong_sizes, "share of those that are half or twice");
  app.add_option("--confused-sides", o.speaker.confused_sides, "left for right, front for back");
  app.add_option("--weight-kinds", o.params.fitness.kinds, "corridor or room");
  app.add_option("--weight-orders", o.params.fitness.orders, "A, then B");
  app.add_option("--forgotten-edge", o.params.fitness.undescribed_edge_credit, "as of topomerg");
  app.add_option("--shut-door", o.params.fitness.closed_door_credit, "as of topomerg");
  app.add_option("--shut-doors", o.closed_doors, "doors that are closed during the mapping");
  app.add_flag("--thesis-sides", o.thesis_sides, "by centers, spread as described (Eq. 5.7)");
  app.add_option("--time-limit", o.params.time_limit, "of each search [s]");
  app.add_option("--know-heading", o.know_heading, "the robot's heading is known");
  app.add_flag("--show", o.show_names, "names described, true and found, to standard error");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
