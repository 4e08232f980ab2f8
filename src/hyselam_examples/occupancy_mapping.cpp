// A laser that looks in four directions from two places in a corridor draws a map of it.
#include <cstdio>

#include "hyselam_common/occupancy_mapper.hpp"
#include "hyselam_common/testing/drawn_grid.hpp"

int main() {
  hyselam::OccupancyMapperParams params;
  params.resolution = 0.5;
  params.min_observations = 1;
  hyselam::OccupancyMapper mapper(params);

  hyselam::LaserScan scan;  // beams ahead, to the left, behind, to the right
  scan.angle_increment = hyselam::radians(90.0);
  scan.range_max = 10.0;
  scan.ranges = {3.25F, 1.25F, 1.25F, 0.75F};
  mapper.insert({0.25, 0.25, 0.0}, scan);
  scan.ranges = {2.25F, 1.25F, 2.25F, 0.75F};
  mapper.insert({1.25, 0.25, 0.0}, scan);

  for (const std::string& row : hyselam::testing::drawingOf(mapper.grid())) std::puts(row.c_str());
  return 0;
}
