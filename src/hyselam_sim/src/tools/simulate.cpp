// simulate --plan PLAN --route ROUTE --out OUT.bag: one run of the robot as a bag.
#include <chrono>
#include <iostream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/picture.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_sim/simulation.hpp"

int main(int argc, char** argv) {
  CLI::App app(
      "Drives a simulated Pioneer P3-DX with a SICK LMS-200 along a route through a floor "
      "plan and writes scans, odometry and ground truth as a bag.",
      "simulate");
  std::string plan_name, route_name, out, map_out, picture_out;
  std::uint64_t seed = 1;
  hyselam_sim::SimulationParams params;
  hyselam_sim::RasterOptions raster;
  bool without_furniture = false;
  app.option_defaults()->always_capture_default();
  app.add_option(
      "--plan", plan_name,
      "floor plan: a .yaml file or the name of a shipped one; the route's own if not given");
  app.add_option("--route", route_name, "route: a .yaml file or the name of a shipped one")
      ->required();
  app.add_option("--seed", seed, "seed of all noise");
  app.add_option("--out", out, "bag to write")->required();
  app.add_option("--map", map_out, "map of the plan to write (NAME.yaml; NAME.pgm goes beside it)");
  app.add_option("--resolution", raster.resolution, "side of the map's cells [m]");
  app.add_flag("--map-without-furniture", without_furniture, "leave furniture out of the map");
  app.add_option("--picture", picture_out, "picture of plan and route to write (PNG)");
  app.add_option("--speed", params.follower.speed, "cruising speed [m/s], if the route has none");
  app.add_option("--scan-rate", params.scan_rate, "[Hz]");
  app.add_option("--odometry-rate", params.odometry_rate, "[Hz]");
  app.add_option("--max-range", params.laser.range_max, "of the laser [m]");
  app.add_option("--laser-sigma", params.laser.sigma, "standard deviation of a range [m]");
  app.add_option("--odometry-sigma", params.odometry.sigma, "random error of a wheel [m/sqrt(m)]");

  return hyselam::runTool(argc, argv, app, [&] {
    using Clock = std::chrono::steady_clock;
    const hyselam_sim::Route route = hyselam_sim::loadRoute(hyselam_sim::routeFile(route_name));
    if (plan_name.empty()) plan_name = route.plan;
    if (plan_name.empty()) {
      throw hyselam::InputError(route.source, "key 'plan'", "missing, and no --plan is given");
    }
    const hyselam_sim::FloorPlan plan =
        hyselam_sim::loadFloorPlan(hyselam_sim::planFile(plan_name));

    const Clock::time_point begin = Clock::now();
    hyselam::Progress progress("simulating", route.steps.size());
    const hyselam_sim::Simulation run = hyselam_sim::simulate(
        plan, route, seed, params, [&](std::size_t done) { progress.update(done); });
    const double simulating = std::chrono::duration<double>(Clock::now() - begin).count();
    hyselam::writeBag(out, run.log);
    const double all = std::chrono::duration<double>(Clock::now() - begin).count();

    if (!map_out.empty()) {
      raster.with_furniture = !without_furniture;
      hyselam::saveMap(map_out, hyselam_sim::rasterize(plan, raster));
    }
    if (!picture_out.empty()) {
      hyselam_sim::savePicture(picture_out, hyselam_sim::drawPicture(plan, run.log.ground_truth));
    }
    std::cout << plan.name << ", " << route.name << ": " << run.distance << " m in " << run.duration
              << " s, " << run.log.scans.size() << " scans -> " << out << " (" << all << " s)\n";
    return nlohmann::json{{"plan", plan.name},
                          {"route", route.name},
                          {"seed", seed},
                          {"distance_m", run.distance},
                          {"duration_s", run.duration},
                          {"scans", run.log.scans.size()},
                          {"odometry", run.log.odometry.size()},
                          {"teleports", run.teleport_stamps},
                          {"simulating_s", simulating},
                          {"simulating_and_writing_s", all},
                          {"times_real_time", run.duration / all}};
  });
}
