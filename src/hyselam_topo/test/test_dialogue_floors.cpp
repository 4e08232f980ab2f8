// From the plan to the names, by text alone: made-up floors become grid maps, gr2to finds their
// places, a person describes them from the place with most doors, walks with the robot from place
// to place and answers what it asks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "hyselam_common/rng.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topological_map/map_geometry.hpp"

using hyselam::Point2;
using hyselam::Pose2;
using hyselam_topo::Dialogue;
using hyselam_topo::Id;
using hyselam_topo::Question;

namespace {

struct Speaker {
  double wrong_sizes = 0.0;    ///< share of the sizes that are told with one side 1.5 times as long
  bool confused_side = false;  ///< one room of the left is told to be on the right
};

struct Count {
  int places = 0;
  int right = 0;      ///< after the description, before any answer; without the robot's own place
  int confirmed = 0;  ///< questions that were answered with yes
  int corrected = 0;  ///< questions answered with no, and names told
  int at_the_end = 0;
};

class Floor {
 public:
  Floor(std::uint64_t seed, const Speaker& speaker) : speaker_(speaker), rng_(seed) {
    hyselam_sim::PlanParams params;
    params.layout = hyselam_sim::PlanParams::Layout::kCorridor;
    params.openings = false;
    plan_ = hyselam_sim::generatePlan(seed, params);
    const auto doors = passages();
    std::map<int, int> count;
    for (const auto& d : doors) ++count[d.a], ++count[d.b];
    for (const auto& [place, n] : count) {
      if (home_ < 0 || n > count[home_]) home_ = place;
    }
    const auto& outline = plan_.places[static_cast<std::size_t>(home_)].outline;
    const auto [low_x, high_x] = std::minmax_element(outline.begin(), outline.end(),
                                                     [](Point2 a, Point2 b) { return a.x < b.x; });
    const auto [low_y, high_y] = std::minmax_element(outline.begin(), outline.end(),
                                                     [](Point2 a, Point2 b) { return a.y < b.y; });
    heading_ = high_x->x - low_x->x >= high_y->y - low_y->y ? 0.0 : 0.5 * hyselam::kPi;
  }

  void run(Count* count) {
    Dialogue robot;
    robot.setGrid(hyselam_sim::rasterize(plan_, 0.05, 0.0));
    robot.setMap(hyselam_topo::gr2to(*robot.gridWithWalls()).map);
    double time = 0.0;
    const Point2 home = at(home_);
    robot.setPose(time += 1.0, {home.x, home.y, heading_});
    robot.hear(describe());
    const int n = static_cast<int>(plan_.places.size());
    for (int k = 0; k < n; ++k) {
      if (k == home_) continue;
      ++count->places;
      count->right += isRight(robot, k) ? 1 : 0;
    }
    for (int k = 0; k < n; ++k) {
      robot.setPose(time += 1.0, {at(k).x, at(k).y, 0.0});
      for (int question = 0; question < 4; ++question) {
        if (robot.question().kind != Question::Kind::kConfirmName) break;
        if (robot.places().sameName(robot.question().names[0], nameOf(k))) {
          robot.hear("Yes.");
          ++count->confirmed;
        } else {
          robot.hear("No.");
          ++count->corrected;
        }
      }
      if (!isRight(robot, k)) {
        robot.hear("This is " + nameOf(k) + ".");
        ++count->corrected;
      }
    }
    for (int k = 0; k < n; ++k) count->at_the_end += k != home_ && isRight(robot, k) ? 1 : 0;
  }

 private:
  struct Passage {
    int a, b;
    Point2 at;
  };

  Point2 at(int k) const { return plan_.places[static_cast<std::size_t>(k)].at; }
  std::string nameOf(int k) const {
    return k == home_ ? "the corridor" : "room " + std::to_string(101 + k);
  }

  int placeAt(Point2 p) const {
    for (std::size_t k = 0; k < plan_.places.size(); ++k) {
      if (hyselam_sim::contains(plan_.places[k].outline, p)) return static_cast<int>(k);
    }
    return -1;
  }

  std::vector<Passage> passages() const {
    std::vector<Passage> all;
    for (const auto& door : plan_.doors) {
      const Point2 n{-door.along.y, door.along.x};
      const int a = placeAt({door.at.x + 0.4 * n.x, door.at.y + 0.4 * n.y});
      const int b = placeAt({door.at.x - 0.4 * n.x, door.at.y - 0.4 * n.y});
      if (a >= 0 && b >= 0 && a != b) all.push_back({a, b, door.at});
    }
    return all;
  }

  bool isRight(const Dialogue& robot, int k) const {
    const auto place = hyselam_topo::placeAt(robot.map(), at(k), 0.5);
    if (!place) return false;
    for (const auto& name : hyselam_topo::namesOf(*robot.map().findPlace(place->place))) {
      if (robot.places().sameName(name, nameOf(k))) return true;
    }
    return false;
  }

  std::string describe() {
    const Pose2 here{at(home_).x, at(home_).y, heading_};
    std::map<std::string, std::vector<std::pair<double, int>>> sides;
    std::string deeper;
    std::vector<int> told;
    for (const Passage& p : passages()) {
      if (p.a != home_ && p.b != home_) {
        deeper += " " + nameOf(p.a) + " is connected to " + nameOf(p.b) + ".";
        continue;
      }
      const int other = p.a == home_ ? p.b : p.a;
      if (std::count(told.begin(), told.end(), other) > 0) continue;
      told.push_back(other);
      // The wall that the door is in: its direction out of the corridor.
      const Point2 door = here.inverse() * p.at, room = here.inverse() * at(other);
      const bool across = std::abs(room.y - door.y) > std::abs(room.x - door.x);
      const std::string side = across ? (room.y > door.y ? "On your left" : "On your right")
                                      : (room.x > door.x ? "In front of you" : "Behind you");
      sides[side].emplace_back(door.x, other);
    }
    auto& left = sides["On your left"];
    if (speaker_.confused_side && !left.empty()) {
      sides["On your right"].push_back(left.back());
      left.pop_back();
    }
    std::string text = "You are in the corridor.";
    for (auto& [side, rooms] : sides) {
      std::sort(rooms.begin(), rooms.end());
      std::string list;
      for (const auto& [along, room] : rooms)
        list += (list.empty() ? " " : ", then ") + nameOf(room);
      if (!list.empty()) text += " " + side + " you have" + list + ".";
    }
    text += deeper;
    for (std::size_t k = 0; k < plan_.places.size(); ++k) {
      if (static_cast<int>(k) == home_ || rng_.uniform() > 0.6) continue;
      const auto& o = plan_.places[k].outline;
      double length = std::hypot(o[1].x - o[0].x, o[1].y - o[0].y);
      const double width = std::hypot(o[2].x - o[1].x, o[2].y - o[1].y);
      if (rng_.uniform() < speaker_.wrong_sizes) length *= 1.5;
      char size[80];
      std::snprintf(size, sizeof size, " is %.1f by %.1f meters.", length, width);
      text += " " + nameOf(static_cast<int>(k)) + size;
    }
    return text;
  }

  Speaker speaker_;
  hyselam::Rng rng_;
  hyselam_sim::FloorPlan plan_;
  int home_ = -1;
  double heading_ = 0.0;
};

Count describeFloors(const char* what, const Speaker& speaker) {
  Count count;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) Floor(seed, speaker).run(&count);
  std::cout << what << ": " << count.right << " of " << count.places
            << " names right at once; then yes " << count.confirmed << ", no or told "
            << count.corrected << "; " << count.at_the_end << " right at the end\n";
  return count;
}

}  // namespace

TEST(DialogueFloors, NamesAreRightByWordsAlone) {
  const Count count = describeFloors("12 floors", {});
  EXPECT_GE(count.right, 0.95 * count.places);
  EXPECT_EQ(count.at_the_end, count.places);
}

TEST(DialogueFloors, MistakesOfPeopleAreCorrectedByAnswers) {
  Speaker speaker;
  speaker.wrong_sizes = 0.2;
  speaker.confused_side = true;
  const Count count = describeFloors("20 % of the sizes wrong, one side confused", speaker);
  EXPECT_GE(count.right, 0.5 * count.places);
  EXPECT_EQ(count.at_the_end, count.places);
}
