// Descriptions written by hand, as a person would tell them, of a building that comes with the
// simulator: from the text alone to a name for every room of the map that gr2to makes of it.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topological_map/map_geometry.hpp"

namespace hyselam_topo {
namespace {

using Names = std::map<std::string, std::string>;  ///< plan's name -> told name

/// The office as it was mapped: with all doors open but these.
hyselam_sim::FloorPlan office(const std::set<std::string>& shut = {}) {
  hyselam_sim::FloorPlan plan = hyselam_sim::loadFloorPlan(hyselam_sim::planFile("office"));
  for (hyselam_sim::PlanDoor& door : plan.doors) {
    door.initially_open = shut.count(door.name) == 0;
    door.schedule.clear();
  }
  return plan;
}

/// At the east end of the office's corridor with the face to the west.
const hyselam::Pose2 kEastEnd{35.0, 8.0, hyselam::kPi};

/// How many of the names stand at the place that they belong to after the text, told to a robot
/// with a map of the plan that stands at `pose`; nothing is confirmed.
int namedRightly(const hyselam_sim::FloorPlan& plan, const hyselam::Pose2& pose,
                 const std::string& file, const Names& names) {
  Dialogue robot;
  robot.setGrid(hyselam_sim::rasterize(plan, 0.05, 0.0));
  robot.setMap(gr2to(*robot.gridWithWalls()).map);
  robot.setPose(1.0, pose);
  robot.hear(
      hyselam::readTextFile(std::string(HYSELAM_PACKAGE_DIR) + "/test/data/described/" + file));
  int right = 0;
  for (const auto& [place, told] : names) {
    const auto there = placeAt(robot.map(), plan.place(place).at, 0.3);
    if (!there) continue;
    bool named = false;
    for (const std::string& name : namesOf(*robot.map().findPlace(there->place))) {
      named = named || robot.places().sameName(name, told);
    }
    EXPECT_TRUE(named) << place << " is not called " << told;
    right += named ? 1 : 0;
  }
  return right;
}

Names officeNames() {
  Names names;
  for (const hyselam_sim::PlanPlace& place : office().places) {
    const bool corridor = place.name.find("corridor") != std::string::npos;
    names[place.name] = corridor ? "corridor" : place.name;
  }
  return names;
}

TEST(DescribedBuildings, OfficeInEnglish) {
  EXPECT_EQ(namedRightly(office(), kEastEnd, "office_en.txt", officeNames()), 22);
}

// As on the day that the routes are driven: no way leads into these rooms on the map.
TEST(DescribedBuildings, OfficeWithTwoDoorsClosed) {
  EXPECT_EQ(namedRightly(office({"server room door", "store room door"}), kEastEnd, "office_en.txt",
                         officeNames()),
            22);
}

TEST(DescribedBuildings, OfficeWithThreeDoorsClosed) {
  EXPECT_EQ(namedRightly(office({"server room door", "store room door", "library door"}), kEastEnd,
                         "office_en.txt", officeNames()),
            22);
}

// A corridor that turns left, told at its west end: five rooms on the right, three on the left,
// three around the corner.
TEST(DescribedBuildings, FloorAroundACornerInEnglish) {
  EXPECT_EQ(namedRightly(hyselam_sim::generatePlan(4), {0.8, 4.6, 0.0}, "floor_4_en.txt",
                         {{"corridor", "corridor"},
                          {"room 1", "porter's lodge"},
                          {"room 2", "mail room"},
                          {"room 3", "big meeting room"},
                          {"room 4", "kitchen"},
                          {"room 5", "toilets"},
                          {"room 6", "Jim's office"},
                          {"room 7", "Helen's office"},
                          {"room 8", "print room"},
                          {"room 9", "server room"},
                          {"room 10", "archive"},
                          {"room 11", "workshop"}}),
            12);
}

TEST(DescribedBuildings, FloorAroundACornerInPortuguese) {
  EXPECT_EQ(namedRightly(hyselam_sim::generatePlan(7), {0.8, 5.5, 0.0}, "floor_7_pt.txt",
                         {{"corridor", "corredor"},
                          {"room 1", "sala de aula"},
                          {"room 2", "sala dos professores"},
                          {"room 3", "casa de banho"},
                          {"room 4", "laboratório"},
                          {"room 5", "gabinete do Rui"},
                          {"room 6", "biblioteca"}}),
            7);
}

TEST(DescribedBuildings, OfficeInPortuguese) {
  EXPECT_EQ(namedRightly(office(), kEastEnd, "office_pt.txt",
                         {{"west corridor", "corredor"},
                          {"Renan's office", "sala do Renan"},
                          {"Sofia's office", "sala da Sofia"},
                          {"store room", "arrecadação"},
                          {"workshop", "oficina"},
                          {"library", "biblioteca"},
                          {"Carlos' office", "sala do Carlos"},
                          {"toilet", "casa de banho"},
                          {"Laura's office", "sala da Laura"},
                          {"kitchen", "cozinha"},
                          {"Paul's office", "sala do Paul"},
                          {"server room", "sala dos servidores"},
                          {"laboratory", "laboratório"},
                          {"Anna's office", "sala da Anna"},
                          {"Peter's office", "sala do Peter"},
                          {"copy room", "sala das cópias"},
                          {"meeting room", "sala de reuniões"},
                          {"Mary's office", "sala da Mary"},
                          {"John's office", "sala do John"},
                          {"reception", "recepção"},
                          {"conference room", "sala de conferências"}}),
            21);
}

}  // namespace
}  // namespace hyselam_topo
