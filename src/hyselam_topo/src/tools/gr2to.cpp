// gr2to MAP --out DIR: places, doors and walls of a grid map or an OctoMap.
#include "hyselam_gr2to/gr2to.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_gr2to/octomap/octomap_compression.hpp"
#include "hyselam_gr2to/overview.hpp"
#include "hyselam_gr2to/segmentation/border_model.hpp"
#include "hyselam_topological_map/carry_over.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

namespace fs = std::filesystem;
using namespace hyselam_topo;  // NOLINT: a program, not a header

struct Options {
  std::string map_file, out, mode = "default", border_model, previous;
  Gr2ToParams gr2to;
  OverviewOptions picture;
  CompressionParams octomap;
  std::optional<std::size_t> max_cells;
  bool graphml = false;
};

void addOptions(CLI::App& app, Options& o) {
  app.option_defaults()->always_capture_default();
  app.add_option("MAP", o.map_file, "map_server's MAP.yaml, or an OctoMap, MAP.bt or MAP.ot")
      ->required();
  app.add_option("--out", o.out,
                 "folder to write to: topo.xml, labels.png, doors.csv, overview.png, summary.json")
      ->required();
  app.add_option("--previous", o.previous,
                 "topo.xml of an earlier map in the same frame: ids and words go on");
  app.add_option("--mode", o.mode, "default: merged and without clutter; thesis: as in the thesis")
      ->check(CLI::IsMember({"default", "thesis"}));
  app.add_option("--free-max", o.gr2to.segmentation.free_max, "cells of 0 .. this value are free");
  app.add_option(
      "--clutter", o.gr2to.segmentation.max_clutter_size,
      "free-standing obstacles whose box has a diagonal up to this do not separate places [m]");
  app.add_option("--smallest-place", o.gr2to.segmentation.min_place_area,
                 "smaller places join a neighbor or are left out [m^2]");
  app.add_option("--border-model", o.border_model,
                 "file of border trees, by train_borders; else those of the package");
  ThesisParams& thesis = o.gr2to.thesis;
  app.add_option("--door-min", thesis.door_min, "mode thesis: width of a door, at least [m]");
  app.add_option("--door-max", thesis.door_max, "mode thesis: width of a door, at most [m]");
  app.add_option("--critical-radius", thesis.critical_radius,
                 "mode thesis: within which a critical point is the narrowest [m]");
  app.add_option("--wall-share", thesis.wall_share,
                 "mode thesis: occupied part of a polygon's edge that makes it a wall");
  app.add_option("--picture-side", o.picture.side, "longer side of overview.png [pixel]");
  app.add_option("--storey", o.octomap.storey, "of an OctoMap, 0 is the lowest; -1: the only one");
  app.add_option("--z-min", o.octomap.z_min, "lowest height of an OctoMap that is used [m]");
  app.add_option("--z-max", o.octomap.z_max, "highest height of an OctoMap that is used [m]");
  app.add_option("--max-cells", o.max_cells, "a larger map is refused");
  app.add_flag("--graphml", o.graphml, "write topo.graphml too");
}

bool isOctoMap(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  return extension == ".bt" || extension == ".ot";
}

hyselam::OccupancyGrid loadGrid(const Options& o) {
  if (isOctoMap(o.map_file)) {
    CompressionParams octomap = o.octomap;
    if (o.max_cells) octomap.max_cells = *o.max_cells;
    return compress(loadOctoMap(o.map_file), octomap, o.map_file).grid;
  }
  hyselam::MapIoOptions limits;
  if (o.max_cells) limits.max_cells = *o.max_cells;
  return hyselam::loadMap(o.map_file, limits);
}

void saveImage(const std::string& path, const cv::Mat& image) {
  hyselam::replaceFileAtomically(path, [&](const std::string& temporary) {
    if (!cv::imwrite(temporary, image)) {
      throw hyselam::InputError(path, "", "the picture cannot be written");
    }
  });
}

void saveDoors(const std::string& path, const AugmentedTopologicalMap& map) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "x,y,width,real\n";
    for (const Edge& edge : map.edges) {
      for (const Door& door : edge.doors) {
        out << door.position.x << ',' << door.position.y << ',' << door.width << ','
            << (door.real ? 1 : 0) << '\n';
      }
    }
  });
}

void saveMapFiles(const Options& o, const Gr2ToResult& result) {
  hyselam::makeFolder(o.out);
  saveXml(o.out + "/topo.xml", result.map);
  if (o.graphml) {
    hyselam::writeFileAtomically(o.out + "/topo.graphml",
                                 [&](std::ostream& file) { file << toGraphMl(result.map); });
  }
  cv::Mat labels;
  cv::flip(result.labels, labels, 0);  // images begin with the highest row
  saveImage(o.out + "/labels.png", labels);
  saveDoors(o.out + "/doors.csv", result.map);
}

/// What a person should know who wonders at the result.
void remark(const hyselam::OccupancyGrid& grid, const Gr2ToParams& params,
            const Gr2ToResult& result) {
  constexpr double kTiny = 2.0, kHuge = 500.0;  // [m] of the longer side of what is free
  const hyselam::GridGeometry& g = grid.geometry;
  hyselam::Cell low{g.width, g.height}, high{-1, -1};
  bool unknown = false;
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) {
      const int value = grid.at({x, y});
      unknown = unknown || value < 0;
      if (value < 0 || value > params.segmentation.free_max) continue;
      low = {std::min(low.x, x), std::min(low.y, y)};
      high = {std::max(high.x, x), std::max(high.y, y)};
    }
  if (high.x < 0) {
    std::cerr << "gr2to: no cell of the map is free, so it has no places\n";
    return;
  }
  const double side = (std::max(high.x - low.x, high.y - low.y) + 1) * g.resolution;
  if (side < kTiny || side > kHuge)
    std::cerr << "gr2to: what is free is " << side << " m long: is the resolution of "
              << g.resolution << " m right?\n";
  if (!unknown && !result.map.places.empty())
    std::cerr << "gr2to: the map has no unknown cells: what is not free may be wall or unseen\n";
}

nlohmann::json summaryOf(const Options& o, const hyselam::OccupancyGrid& grid,
                         const Gr2ToResult& result) {
  std::size_t doors = 0, open_borders = 0, walls = 0, corridors = 0;
  for (const Edge& edge : result.map.edges) {
    for (const Door& door : edge.doors) ++(door.real ? doors : open_borders);
  }
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
  return {{"map", o.map_file},
          {"mode", o.mode},
          {"width", grid.geometry.width},
          {"height", grid.geometry.height},
          {"resolution", grid.geometry.resolution},
          {"places", result.map.places.size()},
          {"corridors", corridors},
          {"doors", doors},
          {"open_borders", open_borders},
          {"walls", walls},
          {"seconds", seconds}};
}

/// Label n is map place n again, after the map was given other ids.
void renumberLabels(const PlaceGrid& places, cv::Mat* labels) {
  for (int y = 0; y < labels->rows; ++y) {
    for (int x = 0; x < labels->cols; ++x) {
      labels->at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(places.placeOf({x, y}));
    }
  }
}

/// The steps make and free images of the map's size one after the other: by default each is given
/// back to the system and its pages are cleared anew, a fifth of the time.
void keepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kImage = 1 << 25;
  mallopt(M_MMAP_THRESHOLD, kImage);
  mallopt(M_TRIM_THRESHOLD, 8 * kImage);
  mallopt(M_TOP_PAD, kImage);
#endif
}

nlohmann::json run(Options& o) {
  keepFreedMemory();
  o.gr2to.mode = o.mode == "thesis" ? Gr2ToParams::Mode::kThesis : Gr2ToParams::Mode::kDefault;
  if (!o.border_model.empty()) {
    o.gr2to.segmentation.border_model =
        std::make_shared<BorderModel>(BorderModel::load(o.border_model));
  }
  hyselam::Progress progress("gr2to", 4);
  const hyselam::OccupancyGrid grid = loadGrid(o);
  progress.update(1);
  Gr2ToResult result = gr2to(grid, o.gr2to);
  CarryOverReport carried;
  if (!o.previous.empty()) {
    result.map = carryOver(loadXml(o.previous), result.map, CarryOverParams{}, carried);
    renumberLabels(*result.map.grid, &result.labels);
  }
  progress.update(2);
  remark(grid, o.gr2to, result);
  saveMapFiles(o, result);
  progress.update(3);
  saveImage(o.out + "/overview.png", drawOverview(grid, result, o.picture));
  nlohmann::json summary = summaryOf(o, grid, result);
  if (!o.previous.empty()) {
    summary["carried_over"] = {{"kept", carried.kept},
                               {"created", carried.created},
                               {"merged", carried.merged},
                               {"split_off", carried.split_off},
                               {"lost", carried.lost}};
  }
  hyselam::writeFileAtomically(o.out + "/summary.json",
                               [&](std::ostream& file) { file << summary.dump(2) << '\n'; });
  progress.update(4);
  std::cout << summary["places"] << " places (" << summary["corridors"] << " corridors), "
            << summary["doors"] << " doors, " << summary["open_borders"] << " open borders -> "
            << o.out << '\n';
  return summary;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Finds the places, doors and walls of a grid map or an OctoMap.", "gr2to");
  Options options;
  addOptions(app, options);
  return hyselam::runTool(argc, argv, app, [&] { return run(options); });
}
