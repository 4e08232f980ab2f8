// Where is the robot? It drives through a room on a known map, and nothing says where it starts.
#include <cstdio>

#include "fsd_localization/localizer.hpp"

int main() {
  hyselam::GridGeometry geometry;  // a room of 12 x 8 m with a pillar and a piece of wall
  geometry.width = 120;
  geometry.height = 80;
  geometry.resolution = 0.1;
  hyselam::OccupancyGrid map(geometry, 0);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      const bool border = x < 3 || y < 3 || x >= 117 || y >= 77;
      const bool inner = (x >= 70 && x < 75 && y < 30) || (x >= 30 && x < 40 && y >= 50 && y < 60);
      if (border || inner) map.at({x, y}) = 100;
    }
  }
  const fsd_localization::GridRayCaster world(map);
  fsd_localization::LocalizerParams params;
  params.filter.max_particles = 5000;  // enough for a small room
  params.seed = 4;
  fsd_localization::Localizer localizer(map, params);
  const hyselam::Pose2 start{1.5, 1.5, 0.0};
  hyselam::Pose2 truth = start;
  for (int i = 0; i < 200; ++i) {
    const bool turning =
        (truth.x > 5.5 && truth.theta < 1.57) || (truth.y > 6.0 && truth.theta < 3.1);
    truth = truth * hyselam::Pose2{0.05, 0.0, turning ? 0.05 : 0.0};
    hyselam::LaserScan scan;
    scan.stamp = 1.0 + 0.1 * i;
    scan.angle_min = -hyselam::kPi / 2;
    scan.angle_increment = hyselam::kPi / 180;
    scan.range_max = 30.0;
    for (int b = 0; b < 181; ++b) {
      const double bearing = truth.theta + scan.angle_min + b * scan.angle_increment;
      scan.ranges.push_back(static_cast<float>(world.range(truth.x, truth.y, bearing, 30.0)));
    }
    const auto result = localizer.update(scan, hyselam::between(start, truth));
    if (result && result->converged) {
      std::printf("%s; error below 0.2 m: %s\n", toString(result->phase),
                  hyselam::distance(result->base_in_map, truth) < 0.2 ? "yes" : "no");
      return 0;
    }
  }
  std::puts("not found");
  return 1;
}
