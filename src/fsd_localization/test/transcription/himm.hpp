// Alg. 2.2 as the thesis writes it: for every cell the bearing, the nearest beam, the distance. The
// oracle of LocalMap; slow on purpose.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/occupancy_grid.hpp"

namespace transcription {

/// A square grid of odd side whose centre holds the robot, values 0..15.
struct HimmGrid {
  int side = 0;
  std::vector<int> occ;
  explicit HimmGrid(int s) : side(s), occ(static_cast<std::size_t>(s * s), 8) {}
  int& at(int x, int y) { return occ[static_cast<std::size_t>(y * side + x)]; }
};

/// One update. `d_max` is r_max in cells; `usable` is the range up to which beams are believed [m];
/// a beam without return frees up to it; NaN and too short beams update nothing (the decisions on
/// what the thesis leaves open).
inline void himm(HimmGrid& m, const hyselam::LaserScan& scan, double laser_heading,
                 double resolution, double d_max, double usable, double epsilon_d) {
  const int center = m.side / 2;
  const double inc = std::abs(scan.angle_increment);
  for (int y = 0; y < m.side; ++y) {
    for (int x = 0; x < m.side; ++x) {
      const double dx = x - center, dy = y - center;
      const double phi = std::atan2(dy, dx) - laser_heading;
      std::size_t k = 0;
      double best = 1e9;
      for (std::size_t j = 0; j < scan.ranges.size(); ++j) {
        const double beam = scan.angle_min + static_cast<double>(j) * scan.angle_increment;
        double diff = std::abs(phi - beam);
        while (diff > hyselam::kPi) diff = std::abs(diff - 2.0 * hyselam::kPi);
        if (diff < best) best = diff, k = j;
      }
      const double d_i = std::sqrt(dx * dx + dy * dy);
      if (best > 0.5 * inc || !(d_i < d_max)) continue;  // not in the perceptual field
      const double range = scan.ranges[k];
      if (std::isnan(range) || range < scan.range_min) continue;
      int& occ = m.at(x, y);
      if (range >= scan.range_max || range > usable) {
        if (d_i < usable / resolution) occ = std::max(0, occ - 1);
        continue;
      }
      const double d = range / resolution;
      if (std::abs(d_i - d) < epsilon_d) {
        occ = std::min(15, occ + 3);
      } else if (d_i < d - epsilon_d) {
        occ = std::max(0, occ - 1);
      }
    }
  }
}

}  // namespace transcription
