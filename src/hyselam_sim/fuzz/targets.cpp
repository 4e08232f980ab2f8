#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_sim/route.hpp"
#include "hyselam_sim/things.hpp"

namespace hyselam_sim {
namespace {

using hyselam::testing::require;
using hyselam::testing::textOf;

bool finite(Point2 p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

/// A floor plan: refused, or it can be drawn with about a hundred cells a side, its doors can be
/// put as its configurations say, and it can be written.
void floorPlan(const std::uint8_t* data, std::size_t size) {
  FloorPlan plan;
  try {
    plan = parseFloorPlan(textOf(data, size), "fuzz");
  } catch (const hyselam::InputError&) {
    return;
  }
  require(plan.size.x > 0.0 && plan.size.y > 0.0 && finite(plan.origin) && finite(plan.size));
  RasterOptions raster;
  raster.resolution = std::clamp(std::max(plan.size.x, plan.size.y) / 100.0, 0.005, 10.0);
  try {
    const hyselam::OccupancyGrid map = rasterize(plan, raster);
    require(map.geometry.width > 0 && map.geometry.height > 0);
  } catch (const hyselam::InputError&) {
  }
  for (const PlanPlace& place : plan.places) require(&plan.place(place.name) == &place);
  for (const DoorConfiguration& doors : plan.configurations) plan.setDoors(doors.name);
  require(plan.configurations.empty() || std::isinf(plan.nextDoorChange(0.0)));
  require(!toYaml(plan).empty());
}

/// A route: refused, or people are where numbers are numbers at any time.
void route(const std::uint8_t* data, std::size_t size) {
  Route read;
  try {
    read = parseRoute(textOf(data, size), "fuzz");
  } catch (const hyselam::InputError&) {
    return;
  }
  for (const RouteStep& step : read.steps) {
    require(finite(step.spot.point) && std::isfinite(step.seconds) && !step.where.empty());
  }
  for (const Person& person : read.people) {
    for (const double time : {0.0, 1.0, 1e3, 1e6}) {
      const auto at = person.at(time);
      require(!at || finite(*at));
    }
  }
}

/// A list of things: refused, or things with extent and different names.
void things(const std::uint8_t* data, std::size_t size) {
  try {
    for (const Thing& thing : parseThings(textOf(data, size), "fuzz")) {
      require(!thing.name.empty() && !thing.kind.empty() && std::isfinite(thing.z));
      require(finite({thing.pose.x, thing.pose.y}) && std::isfinite(thing.pose.theta));
      for (const double side : thing.size) require(side > 0.0);
    }
  } catch (const hyselam::InputError&) {
  }
}

}  // namespace
}  // namespace hyselam_sim

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace hyselam_sim;  // NOLINT: its own targets
  return {{"floorPlan", floorPlan}, {"route", route}, {"things", things}};
}
