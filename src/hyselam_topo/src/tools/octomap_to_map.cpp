// octomap_to_map IN.bt OUT.yaml: a storey of an OctoMap as a grid map without furniture.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_gr2to/octomap/octomap_compression.hpp"

namespace {

using hyselam::OccupancyGrid;

cv::Vec3b colourOf(std::int8_t value) {
  if (value == OccupancyGrid::kUnknown) return {200, 200, 200};
  return value == OccupancyGrid::kFree ? cv::Vec3b{255, 255, 255} : cv::Vec3b{25, 20, 20};
}

/// The part of a grid that a geometry covers, highest y first.
cv::Mat drawn(const OccupancyGrid& grid, const hyselam::GridGeometry& geometry) {
  cv::Mat picture(geometry.height, geometry.width, CV_8UC3);
  for (int y = 0; y < geometry.height; ++y) {
    for (int x = 0; x < geometry.width; ++x) {
      const hyselam::Cell there = grid.geometry.cellAt(geometry.center({x, y}));
      picture.at<cv::Vec3b>(geometry.height - 1 - y, x) = colourOf(grid.valueOr(there));
    }
  }
  return picture;
}

/// A picture under a line of text.
cv::Mat titled(const cv::Mat& picture, const std::string& title) {
  cv::Mat with_title(picture.rows + 34, picture.cols, CV_8UC3, cv::Scalar(255, 255, 255));
  picture.copyTo(with_title.rowRange(34, with_title.rows));
  cv::putText(with_title, title, {6, 23}, cv::FONT_HERSHEY_SIMPLEX, 0.55, cv::Scalar(40, 40, 40), 1,
              cv::LINE_AA);
  return with_title;
}

/// One above the other: what a planar sensor sees, and the pressed map.
void savePicture(const std::string& path, const OccupancyGrid& seen,
                 const hyselam_topo::Compression& pressed) {
  const auto& geometry = pressed.grid.geometry;
  char before[100], after[100];
  std::snprintf(before, sizeof before, "anything between z = %.2f and %.2f m", pressed.z_min,
                std::min(pressed.z_max, pressed.z_min + 1.0));
  std::snprintf(after, sizeof after, "walls between z = %.2f and %.2f m", pressed.z_min,
                pressed.z_max);
  cv::Mat both;
  cv::vconcat(titled(drawn(seen, geometry), before), titled(drawn(pressed.grid, geometry), after),
              both);
  hyselam::replaceFileAtomically(path, [&](const std::string& temporary) {
    if (!cv::imwrite(temporary, both)) {
      throw hyselam::InputError(path, "", "cannot be written as a picture");
    }
  });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Presses a storey of an OctoMap into a grid map (map_server's YAML and PGM) without the "
      "furniture, which does not reach from the floor to the ceiling.",
      "octomap_to_map");
  std::string in, out, picture;
  hyselam_topo::CompressionParams params;
  app.option_defaults()->always_capture_default();
  app.add_option("OCTOMAP", in, "file of type .bt or .ot")->required();
  app.add_option("OUT", out, "map to write (NAME.yaml; NAME.pgm goes beside it)")->required();
  app.add_option("--z-min", params.z_min, "lower limit of what is pressed [m]; else of the storey");
  app.add_option("--z-max", params.z_max, "upper limit [m]");
  app.add_option("--storey", params.storey, "from 0 for the lowest, if there are several");
  app.add_option("--max-free-height", params.max_free_height,
                 "a column with more free space is free [m]");
  app.add_option("--min-occupied-height", params.min_occupied_height,
                 "else it is occupied with more than this [m]");
  app.add_option("--max-cells", params.max_cells, "a larger grid map is refused");
  app.add_option("--picture", picture, "PNG: what a planar sensor sees above the pressed map");

  return hyselam::runTool(argc, argv, app, [&] {
    const auto begin = std::chrono::steady_clock::now();
    const hyselam_topo::VoxelMap map = hyselam_topo::loadOctoMap(in);
    const auto loaded = std::chrono::steady_clock::now();
    const hyselam_topo::Compression pressed = hyselam_topo::compress(map, params, in);
    const auto done = std::chrono::steady_clock::now();
    const OccupancyGrid seen = hyselam_topo::slice(
        map, pressed.z_min, std::min(pressed.z_max, pressed.z_min + 1.0), in, params.max_cells);
    hyselam::saveMap(out, pressed.grid);
    if (!picture.empty()) savePicture(picture, seen, pressed);

    const auto count = [](const OccupancyGrid& grid, std::int8_t value) {
      return std::count(grid.cells.begin(), grid.cells.end(), value);
    };
    const auto seconds = [](auto from, auto to) {
      return std::chrono::duration<double>(to - from).count();
    };
    nlohmann::json result;
    result["leaves"] = map.leaves.size();
    result["resolution"] = map.resolution;
    result["z_min"] = pressed.z_min;
    result["z_max"] = pressed.z_max;
    result["width"] = pressed.grid.geometry.width;
    result["height"] = pressed.grid.geometry.height;
    result["storeys"] = nlohmann::json::array();
    for (const auto& storey : pressed.storeys) {
      result["storeys"].push_back({{"floor", storey.floor}, {"ceiling", storey.ceiling}});
    }
    for (const auto& [name, grid] :
         {std::make_pair("seen", &seen), std::make_pair("pressed", &pressed.grid)}) {
      result[name] = {{"occupied", count(*grid, OccupancyGrid::kOccupied)},
                      {"free", count(*grid, OccupancyGrid::kFree)}};
    }
    result["read_seconds"] = seconds(begin, loaded);
    result["press_seconds"] = seconds(loaded, done);
    std::cout << result.dump(2) << '\n';
    return result;
  });
}
