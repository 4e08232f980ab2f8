// Descriptions written by hand, as a person would tell them, of a building that comes with the
// simulator: from the text alone to a name for every room of the map that gr2to makes of it.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/rasterise.hpp"
#include "hyselam_topo/dialogue.hpp"
#include "hyselam_topo/gr2to.hpp"
#include "hyselam_topo/map_geometry.hpp"

namespace hyselam_topo {
namespace {

/// The office when it was mapped with all doors open.
hyselam_sim::FloorPlan office() {
  hyselam_sim::FloorPlan plan = hyselam_sim::loadFloorPlan(hyselam_sim::planFile("office"));
  for (hyselam_sim::Door& door : plan.doors) {
    door.initially_open = true;
    door.schedule.clear();
  }
  return plan;
}

/// How many of the names (plan's name -> told name) stand at the place that they belong to after
/// the text, told at the east end of the corridor with the face to the west.
int namedRightly(const std::string& file, const std::map<std::string, std::string>& names) {
  const hyselam_sim::FloorPlan plan = office();
  Dialogue robot;
  robot.setGrid(hyselam_sim::rasterise(plan, 0.05, 0.0));
  robot.setMap(gr2to(*robot.gridWithWalls()).map);
  robot.setPose(1.0, {35.0, 8.0, hyselam::kPi});
  robot.hear(
      hyselam::readTextFile(std::string(HYSELAM_TOPO_SOURCE_DIR) + "/test/data/told/" + file));
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

TEST(ToldBuildings, OfficeInEnglish) {
  std::map<std::string, std::string> names;
  for (const hyselam_sim::Place& place : office().places) {
    const bool corridor = place.name.find("corridor") != std::string::npos;
    names[place.name] = corridor ? "corridor" : place.name;
  }
  EXPECT_EQ(namedRightly("office_en.txt", names), 22);
}

TEST(ToldBuildings, OfficeInPortuguese) {
  EXPECT_EQ(namedRightly("office_pt.txt", {{"west corridor", "corredor"},
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
