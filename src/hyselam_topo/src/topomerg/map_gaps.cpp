#include "map_gaps.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_topological_map/map_geometry.hpp"

namespace hyselam_topo::merging {
namespace {

/// A room is at least as wide [m].
constexpr double kNarrowRoom = 1.6;
/// Of long stretches each room is assumed to take so much [m].
constexpr double kUsualRoom = 3.5;
/// What is so far behind a wall belongs to the next room [m].
constexpr double kBehind = 0.9;
/// Distance of the points that are looked at along the wall [m].
constexpr double kStep = 0.2;

/// The stretch of a wall from `low` to `high`, measured from its middle to the left of its normal.
void addStretch(const Wall& wall, double low, double high,
                std::vector<MatchProblem::Passage>* gaps) {
  if (high - low < kNarrowRoom) return;
  const int rooms = std::max(1, static_cast<int>(std::lround((high - low) / kUsualRoom)));
  MatchProblem::Passage gap;
  gap.dx = -wall.normal.x;
  gap.dy = -wall.normal.y;
  gap.bearing = std::atan2(gap.dy, gap.dx);
  for (int k = 0; k < rooms; ++k) {
    const double along = low + (high - low) * (k + 0.5) / rooms;
    gap.x = wall.position.x - along * wall.normal.y;
    gap.y = wall.position.y + along * wall.normal.x;
    gaps->push_back(gap);
  }
}

void addGapsOf(const AugmentedTopologicalMap& map, const Wall& wall,
               std::vector<MatchProblem::Passage>* gaps) {
  const int steps = static_cast<int>(wall.length / kStep);
  double low = 0.0, high = -1.0;
  for (int k = 0; k <= steps; ++k) {
    const double along = -0.5 * wall.length + (k + 0.5) * wall.length / (steps + 1);
    const hyselam::Point2 behind{wall.position.x - along * wall.normal.y - kBehind * wall.normal.x,
                                 wall.position.y + along * wall.normal.x - kBehind * wall.normal.y};
    if (placeAt(map, behind)) {
      addStretch(wall, low, high, gaps);
      high = low - 1.0;
    } else {
      if (high < low) low = along;
      high = along;
    }
  }
  addStretch(wall, low, high, gaps);
}

}  // namespace

void addGaps(const AugmentedTopologicalMap& map, MatchProblem* out) {
  out->gaps.resize(map.places.size());
  bool any = false;
  for (std::size_t v = 0; v < map.places.size(); ++v) {
    for (const Wall& wall : map.places[v].walls)
      if (wall.kind == WallKind::kSolid && wall.curvature == 0.0)
        addGapsOf(map, wall, &out->gaps[v]);
    any = any || !out->gaps[v].empty();
  }
  if (!any) out->gaps.clear();
}

}  // namespace hyselam_topo::merging
