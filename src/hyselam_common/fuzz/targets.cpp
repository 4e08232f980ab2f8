#include <cmath>

#include "hyselam_common/carmen_log.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_common/trajectory_io.hpp"

namespace hyselam {
namespace {

using testing::FuzzFolder;
using testing::require;
using testing::textOf;

bool finite(const Pose2& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.theta);
}

void checkPoses(const std::vector<StampedPose2>& poses, bool in_order) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    require(std::isfinite(poses[i].stamp) && finite(poses[i].pose));
    require(!in_order || i == 0 || poses[i - 1].stamp <= poses[i].stamp);
  }
}

/// What was read can be written, and comes back as it was.
void checkMap(const std::string& yaml, const FuzzFolder& folder) {
  MapIoOptions options;
  options.max_cells = 1u << 16;
  OccupancyGrid map;
  try {
    map = loadMap(yaml, options);
  } catch (const InputError&) {
    return;
  }
  const auto cells =
      static_cast<std::size_t>(map.geometry.width) * static_cast<std::size_t>(map.geometry.height);
  require(cells > 0 && cells <= options.max_cells && map.cells.size() == cells);
  require(map.geometry.resolution > 0 && finite(map.geometry.origin));
  for (const std::int8_t cell : map.cells) require(cell >= -1 && cell <= 100);
  const std::string again = folder.path("again.yaml");
  saveMap(again, map, MapMode::kScale);
  require(loadMap(again, options).cells == map.cells);
}

/// A CARMEN log: refused, or scans and odometry in order of time with numbers that are numbers.
void carmenLog(const std::uint8_t* data, std::size_t size) {
  try {
    std::vector<CarmenIssue> issues;
    const RobotLog log = parseCarmenLog(textOf(data, size), "fuzz", {}, &issues);
    require(!log.scans.empty());
    for (std::size_t i = 0; i < log.scans.size(); ++i) {
      const LaserScan& s = log.scans[i];
      require(std::isfinite(s.stamp) && std::isfinite(s.angle_min) &&
              std::isfinite(s.angle_increment));
      require(finite(s.laser_in_base) && !s.ranges.empty());
      require(i == 0 || log.scans[i - 1].stamp < s.stamp);
    }
    checkPoses(log.odometry, true);
    checkPoses(log.ground_truth, false);
    for (const CarmenIssue& issue : issues) require(!toString(issue).empty());
  } catch (const InputError&) {
  }
}

/// The YAML file of a map, beside an image of 4 x 3 cells: refused, or saved and read as the same.
void mapYaml(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  static const std::string image =
      folder.put("map.pgm", "P2 4 3 255 0 100 205 254 255 1 2 3 4 5 6 7\n");
  checkMap(folder.put("map.yaml", textOf(data, size)), folder);
}

/// The image of a map, PGM in both forms or whatever OpenCV takes it for: the same.
void mapImage(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  static const std::string yaml = folder.put(
      "image.yaml",
      "image: image.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.196\n");
  folder.put("image.pgm", textOf(data, size));
  checkMap(yaml, folder);
}

/// A trajectory, TUM or a table of reference poses: refused, or finite.
void poses(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  try {
    checkPoses(readPoses(folder.put("poses.txt", textOf(data, size))).poses, false);
  } catch (const InputError&) {
  }
}

}  // namespace

std::vector<testing::FuzzTarget> testing::fuzzTargets() {
  return {{"carmenLog", carmenLog}, {"mapYaml", mapYaml}, {"mapImage", mapImage}, {"poses", poses}};
}

}  // namespace hyselam
