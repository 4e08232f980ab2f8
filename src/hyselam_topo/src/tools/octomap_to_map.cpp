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

cv::Vec3b colorOf(std::int8_t value) {
  if (value == OccupancyGrid::kUnknown) return {200, 200, 200};
  return value == OccupancyGrid::kFree ? cv::Vec3b{255, 255, 255} : cv::Vec3b{25, 20, 20};
}

/// The part of a grid that a geometry covers, highest y first.
cv::Mat drawn(const OccupancyGrid& grid, const hyselam::GridGeometry& geometry) {
  cv::Mat picture(geometry.height, geometry.width, CV_8UC3);
  for (int y = 0; y < geometry.height; ++y) {
    for (int x = 0; x < geometry.width; ++x) {
      const hyselam::Cell there = grid.geometry.cellAt(geometry.center({x, y}));
      picture.at<cv::Vec3b>(geometry.height - 1 - y, x) = colorOf(grid.valueOr(there));
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

/// One above the other: what a planar sensor sees, and the projected map.
void savePicture(const std::string& path, const OccupancyGrid& seen,
                 const hyselam_topo::Compression& projected) {
  const auto& geometry = projected.grid.geometry;
  char before[100], after[100];
  std::snprintf(before, sizeof before, "anything between z = %.2f and %.2f m", projected.z_min,
                std::min(projected.z_max, projected.z_min + 1.0));
  std::snprintf(after, sizeof after, "walls between z = %.2f and %.2f m", projected.z_min,
                projected.z_max);
  cv::Mat both;
  cv::vconcat(titled(drawn(seen, geometry), before), titled(drawn(projected.grid, geometry), after),
              both);
  hyselam::replaceFileAtomically(path, [&](const std::string& temporary) {
    if (!cv::imwrite(temporary, both)) {
      throw hyselam::InputError(path, "", "cannot be written as a picture");
    }
  });
}

struct Options {
  std::string in, out, picture;
  hyselam_topo::CompressionParams compression;
};

void addOptions(CLI::App& app, Options& o) {
  app.option_defaults()->always_capture_default();
  app.add_option("OCTOMAP", o.in, "file of type .bt or .ot")->required();
  app.add_option("OUT", o.out, "map to write (NAME.yaml; NAME.pgm goes beside it)")->required();
  hyselam_topo::CompressionParams& p = o.compression;
  app.add_option("--z-min", p.z_min,
                 "lower limit of the heights that are projected [m]; else of the storey");
  app.add_option("--z-max", p.z_max, "upper limit [m]");
  app.add_option("--storey", p.storey, "from 0 for the lowest; -1: the only one");
  app.add_option("--max-free-height", p.max_free_height,
                 "a column with more free space is free [m]");
  app.add_option("--min-occupied-height", p.min_occupied_height,
                 "else it is occupied with more than this [m]");
  app.add_option("--max-cells", p.max_cells, "a larger grid map is refused");
  app.add_option("--picture", o.picture, "PNG: what a planar sensor sees above the projected map");
}

nlohmann::json countCells(const OccupancyGrid& grid) {
  const auto count = [&](std::int8_t value) {
    return std::count(grid.cells.begin(), grid.cells.end(), value);
  };
  return {{"occupied", count(OccupancyGrid::kOccupied)}, {"free", count(OccupancyGrid::kFree)}};
}

nlohmann::json run(const Options& o) {
  const auto begin = std::chrono::steady_clock::now();
  const hyselam_topo::VoxelMap map = hyselam_topo::loadOctoMap(o.in);
  const auto loaded = std::chrono::steady_clock::now();
  const hyselam_topo::Compression projected = hyselam_topo::compress(map, o.compression, o.in);
  const auto done = std::chrono::steady_clock::now();
  const OccupancyGrid seen =
      hyselam_topo::slice(map, projected.z_min, std::min(projected.z_max, projected.z_min + 1.0),
                          o.in, o.compression.max_cells);
  hyselam::saveMap(o.out, projected.grid);
  if (!o.picture.empty()) savePicture(o.picture, seen, projected);

  const auto seconds = [](auto from, auto to) {
    return std::chrono::duration<double>(to - from).count();
  };
  nlohmann::json result;
  result["leaves"] = map.leaves.size();
  result["resolution"] = map.resolution;
  result["z_min"] = projected.z_min;
  result["z_max"] = projected.z_max;
  result["width"] = projected.grid.geometry.width;
  result["height"] = projected.grid.geometry.height;
  result["storeys"] = nlohmann::json::array();
  for (const auto& storey : projected.storeys) {
    result["storeys"].push_back({{"floor", storey.floor}, {"ceiling", storey.ceiling}});
  }
  result["seen"] = countCells(seen);
  result["pressed"] = countCells(projected.grid);  // the former word stays in the output
  result["read_seconds"] = seconds(begin, loaded);
  result["press_seconds"] = seconds(loaded, done);
  std::cout << result.dump(2) << '\n';
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Projects a storey of an OctoMap to a grid map (map_server's YAML and PGM) without the "
      "furniture, which does not reach from the floor to the ceiling.",
      "octomap_to_map");
  Options options;
  addOptions(app, options);
  return hyselam::runTool(argc, argv, app, [&] { return run(options); });
}
