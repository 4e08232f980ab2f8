// gr2to MAP --out DIR: places, doors and walls of a grid map or an OctoMap.
#include "hyselam_gr2to/gr2to.hpp"

#include <filesystem>
#include <iostream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_gr2to/octomap/octomap_compression.hpp"
#include "hyselam_gr2to/overview.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace {

namespace fs = std::filesystem;
using namespace hyselam_topo;  // NOLINT: a program, not a header

bool isOctoMap(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  return extension == ".bt" || extension == ".ot";
}

void saveImage(const std::string& path, const cv::Mat& image) {
  hyselam::replaceFileAtomically(path, [&](const std::string& temporary) {
    if (!cv::imwrite(temporary, image))
      throw hyselam::InputError(path, "", "the picture cannot be written");
  });
}

void saveDoors(const std::string& path, const AugmentedTopologicalMap& map) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "x,y,width,real\n";
    for (const Edge& edge : map.edges)
      for (const Door& door : edge.doors)
        out << door.position.x << ',' << door.position.y << ',' << door.width << ','
            << (door.real ? 1 : 0) << '\n';
  });
}

void makeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path, error))
    throw hyselam::InputError(path, "", "is not a folder and cannot be made one");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Finds the places, doors and walls of a grid map or an OctoMap.", "gr2to");
  std::string map_file, out, mode = "default";
  Gr2ToParams params;
  OverviewOptions picture;
  CompressionParams octomap;
  std::optional<std::size_t> max_cells;
  bool graphml = false;
  app.option_defaults()->always_capture_default();
  app.add_option("MAP", map_file, "map_server's MAP.yaml, or an OctoMap, MAP.bt or MAP.ot")
      ->required();
  app.add_option("--out", out,
                 "folder to write to: topo.xml, labels.png, doors.csv, overview.png, summary.json")
      ->required();
  app.add_option("--mode", mode, "default: merged and without clutter; thesis: as in the thesis")
      ->check(CLI::IsMember({"default", "thesis"}));
  app.add_option("--clutter", params.segmentation.clutter,
                 "obstacles up to this across that stand free do not part places [m]");
  app.add_option("--smallest-place", params.segmentation.smallest_place, "[m^2]");
  app.add_option("--picture-side", picture.side, "longer side of overview.png [pixel]");
  app.add_option("--storey", octomap.storey, "of an OctoMap, 0 is the lowest");
  app.add_option("--z-min", octomap.z_min, "lowest height of an OctoMap that is used [m]");
  app.add_option("--z-max", octomap.z_max, "highest height of an OctoMap that is used [m]");
  app.add_option("--max-cells", max_cells, "a larger map is refused");
  app.add_flag("--graphml", graphml, "write topo.graphml too");

  return hyselam::runTool(argc, argv, app, [&] {
    params.mode = mode == "thesis" ? Gr2ToParams::Mode::kThesis : Gr2ToParams::Mode::kDefault;
    hyselam::Progress progress("gr2to", 4);
    hyselam::MapIoOptions limits;
    if (max_cells) octomap.max_cells = limits.max_cells = *max_cells;
    hyselam::OccupancyGrid grid;
    if (isOctoMap(map_file))
      grid = compress(loadOctoMap(map_file), octomap, map_file).grid;
    else
      grid = hyselam::loadMap(map_file, limits);
    progress.update(1);
    const Gr2ToResult result = gr2to(grid, params);
    progress.update(2);

    makeFolder(out);
    saveXml(out + "/topo.xml", result.map);
    if (graphml)
      hyselam::writeFileAtomically(out + "/topo.graphml",
                                   [&](std::ostream& file) { file << toGraphMl(result.map); });
    cv::Mat labels;
    cv::flip(result.labels, labels, 0);  // images begin with the highest row
    saveImage(out + "/labels.png", labels);
    saveDoors(out + "/doors.csv", result.map);
    progress.update(3);
    saveImage(out + "/overview.png", drawOverview(grid, result, picture));

    std::size_t doors = 0, open_borders = 0, walls = 0, corridors = 0;
    for (const Edge& edge : result.map.edges)
      for (const Door& door : edge.doors) ++(door.real ? doors : open_borders);
    for (const Place& place : result.map.places) {
      walls += place.walls.size();
      corridors += place.kind == PlaceKind::kCorridor;
    }
    nlohmann::json seconds = nlohmann::json::object();
    double total = 0.0;
    for (const auto& [stage, time] : result.seconds) {
      seconds[stage] = time;
      total += time;
    }
    seconds["total"] = total;
    nlohmann::json summary{{"map", map_file},
                           {"mode", mode},
                           {"width", grid.geometry.width},
                           {"height", grid.geometry.height},
                           {"resolution", grid.geometry.resolution},
                           {"places", result.map.places.size()},
                           {"corridors", corridors},
                           {"doors", doors},
                           {"open_borders", open_borders},
                           {"walls", walls},
                           {"seconds", seconds}};
    hyselam::writeFileAtomically(out + "/summary.json",
                                 [&](std::ostream& file) { file << summary.dump(2) << '\n'; });
    progress.update(4);
    std::cout << result.map.places.size() << " places (" << corridors << " corridors), " << doors
              << " doors, " << open_borders << " open borders -> " << out << '\n';
    return summary;
  });
}
