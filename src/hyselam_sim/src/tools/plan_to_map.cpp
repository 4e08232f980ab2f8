// plan_to_map PLAN OUT.yaml: the map that a perfect mapping run through a floor plan would give.
#include <iostream>

#include "hyselam_common/map_io.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/picture.hpp"
#include "hyselam_sim/rasterize.hpp"

int main(int argc, char** argv) {
  CLI::App app("Draws a floor plan as a grid map (map_server's YAML and PGM).", "plan_to_map");
  std::string plan_name, out, picture_out;
  hyselam_sim::RasterOptions options;
  bool without_furniture = false;
  app.option_defaults()->always_capture_default();
  app.add_option("PLAN", plan_name, "floor plan: a .yaml file or the name of a shipped one")
      ->required();
  app.add_option("OUT", out, "map to write (NAME.yaml; NAME.pgm goes beside it)")->required();
  app.add_option("--resolution", options.resolution, "side of a cell [m]");
  app.add_option("--time", options.time, "when the doors are looked at [s]");
  app.add_flag("--without-furniture", without_furniture, "leave furniture out");
  app.add_option("--picture", picture_out, "picture of the plan to write (PNG)");

  return hyselam::runTool(argc, argv, app, [&] {
    options.with_furniture = !without_furniture;
    const hyselam_sim::FloorPlan plan =
        hyselam_sim::loadFloorPlan(hyselam_sim::planFile(plan_name));
    const hyselam::OccupancyGrid grid = hyselam_sim::rasterize(plan, options);
    hyselam::saveMap(out, grid);
    if (!picture_out.empty()) {
      hyselam_sim::PictureOptions picture;
      picture.time = options.time;
      hyselam_sim::savePicture(picture_out, hyselam_sim::drawPicture(plan, {}, picture));
    }
    std::cout << plan.name << " -> " << out << ", " << grid.geometry.width << " x "
              << grid.geometry.height << " cells of " << grid.geometry.resolution << " m\n";
    return nlohmann::json{{"plan", plan.name},
                          {"width", grid.geometry.width},
                          {"height", grid.geometry.height},
                          {"resolution", grid.geometry.resolution}};
  });
}
