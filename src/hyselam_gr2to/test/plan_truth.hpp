// What is known about a simulated floor plan, to measure what was found in its grid map.
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_gr2to/map_builder/walls.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_topological_map/map_geometry.hpp"

namespace plan_truth {

using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;

/// The places of the plan as labels of the free cells; cells in doorways go to the nearest place.
inline cv::Mat labels(const hyselam_sim::FloorPlan& plan, const OccupancyGrid& grid) {
  cv::Mat out(grid.geometry.height, grid.geometry.width, CV_16UC1, cv::Scalar(0));
  std::vector<Cell> front;
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      if (grid.at({x, y}) != OccupancyGrid::kFree) continue;
      for (std::size_t k = 0; k < plan.places.size(); ++k) {
        if (!hyselam_sim::contains(plan.places[k].outline, grid.geometry.center({x, y}))) continue;
        out.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(k + 1);
        front.push_back({x, y});
        break;
      }
    }
  }
  for (std::size_t i = 0; i < front.size(); ++i) {
    const Cell c = front[i];
    for (const Cell& n :
         {Cell{c.x + 1, c.y}, Cell{c.x - 1, c.y}, Cell{c.x, c.y + 1}, Cell{c.x, c.y - 1}}) {
      if (grid.valueOr(n) != OccupancyGrid::kFree || out.at<std::uint16_t>(n.y, n.x) != 0) continue;
      out.at<std::uint16_t>(n.y, n.x) = out.at<std::uint16_t>(c.y, c.x);
      front.push_back(n);
    }
  }
  return out;
}

/// Moves the borders in the doorways out into one of the places, as a segmentation does that is
/// right about the places but not about where exactly they end.
inline void shiftBorders(const hyselam_sim::FloorPlan& plan, const OccupancyGrid& grid,
                         double distance, cv::Mat* labels) {
  int k = 0;
  for (const hyselam_sim::PlanDoor& door : plan.doors) {
    // Two doorways close together would become one place.
    const bool alone =
        std::none_of(plan.doors.begin(), plan.doors.end(), [&](const hyselam_sim::PlanDoor& other) {
          const double d = std::hypot(other.at.x - door.at.x, other.at.y - door.at.y);
          return d > 0.0 && d < 0.5 * (door.width + other.width) + 2.0 * distance;
        });
    if (!alone) continue;
    const double sign = ++k % 2 == 0 ? 1.0 : -1.0;
    const Point2 across{-sign * door.along.y, sign * door.along.x};
    const auto at = [&](double s) {
      const Cell c = grid.geometry.cellAt({door.at.x + s * across.x, door.at.y + s * across.y});
      return labels->at<std::uint16_t>(c.y, c.x);
    };
    const std::uint16_t grows = at(-0.2), yields = at(0.2);
    const double reach = std::hypot(0.5 * door.width, distance);
    for (int y = 0; y < labels->rows; ++y) {
      for (int x = 0; x < labels->cols; ++x) {
        const Point2 p = grid.geometry.center({x, y});
        if (std::hypot(p.x - door.at.x, p.y - door.at.y) > reach) continue;
        auto& label = labels->at<std::uint16_t>(y, x);
        if (label == yields) label = grows;
      }
    }
  }
}

struct Score {
  int truth = 0;
  int found = 0;
  int right = 0;
  double precision() const { return found == 0 ? 1.0 : static_cast<double>(right) / found; }
  double recall() const { return truth == 0 ? 1.0 : static_cast<double>(right) / truth; }
  Score& operator+=(const Score& o) {
    truth += o.truth;
    found += o.found;
    right += o.right;
    return *this;
  }
};

/// A door is found where one of its kind (real or not) has its middle within 0.3 m of the true one
/// (0.6 m if it is no real door), and its width within 0.2 m (0.6 m). Each counts once.
inline Score scoreDoors(const hyselam_sim::FloorPlan& plan,
                        const std::vector<hyselam_topo::DoorLine>& doors,
                        std::vector<std::string>* mistakes = nullptr) {
  Score score;
  score.truth = static_cast<int>(plan.doors.size());
  score.found = static_cast<int>(doors.size());
  std::vector<bool> used(doors.size());
  for (const hyselam_sim::PlanDoor& t : plan.doors) {
    const bool real = t.name.rfind(hyselam_sim::kOpeningPrefix, 0) != 0;
    double best = real ? 0.3 : 0.6;
    std::size_t match = doors.size();
    for (std::size_t i = 0; i < doors.size(); ++i) {
      const auto& d = doors[i];
      const double off = std::hypot(0.5 * (d.a.x + d.b.x) - t.at.x, 0.5 * (d.a.y + d.b.y) - t.at.y);
      if (used[i] || d.real != real || off > best ||
          std::abs(d.width - t.width) > (real ? 0.2 : 0.6)) {
        continue;
      }
      best = off;
      match = i;
    }
    if (match < doors.size()) {
      used[match] = true;
      ++score.right;
    } else if (mistakes != nullptr) {
      char text[200];
      std::snprintf(text, sizeof text, "missed %s at %.2f %.2f, %.2f m", t.name.c_str(), t.at.x,
                    t.at.y, t.width);
      mistakes->push_back(text);
    }
  }
  for (std::size_t i = 0; i < doors.size() && mistakes != nullptr; ++i) {
    if (used[i]) continue;
    const auto& d = doors[i];
    char text[200];
    std::snprintf(text, sizeof text, "wrong %s at %.2f %.2f, %.2f m, places %d %d",
                  d.real ? "door" : "opening", 0.5 * (d.a.x + d.b.x), 0.5 * (d.a.y + d.b.y),
                  d.width, d.place_a, d.place_b);
    mistakes->push_back(text);
  }
  return score;
}

inline double distanceTo(const std::vector<hyselam_sim::Segment>& segments, Point2 p) {
  double best = 1e9;
  for (const auto& s : segments) best = std::min(best, hyselam_sim::distance(p, s));
  return best;
}

struct WallScore {
  double true_length = 0.0;   ///< of the faces of walls inside of the places [m]
  double found_length = 0.0;  ///< of the solid walls that were found [m]
  double true_near = 0.0;     ///< of true_length, with a found wall within one cell
  double found_near = 0.0;    ///< of found_length, with a true surface within one cell
  WallScore& operator+=(const WallScore& o) {
    true_length += o.true_length;
    found_length += o.found_length;
    true_near += o.true_near;
    found_near += o.found_near;
    return *this;
  }
};

inline WallScore scoreWalls(const hyselam_sim::FloorPlan& plan, double cell, bool with_furniture,
                            const std::vector<std::vector<hyselam_topo::Wall>>& places) {
  WallScore score;
  std::vector<hyselam_sim::Segment> found;
  for (const auto& walls : places) {
    for (const auto& wall : walls) {
      if (wall.kind != hyselam_topo::WallKind::kSolid) continue;
      const auto line = hyselam_topo::polyline(wall, 0.005);
      for (std::size_t i = 0; i + 1 < line.size(); ++i) found.push_back({line[i], line[i + 1]});
    }
  }
  const auto solid = hyselam_sim::solids(plan, 0.0, with_furniture);
  const auto surfaces = hyselam_sim::edges(solid);
  // Cells are drawn where anything touches them, so a face may be drawn up to a cell ahead.
  const double near = cell + 1e-6;
  using hyselam_sim::operator-;
  using hyselam_sim::operator+;
  using hyselam_sim::operator*;
  const auto along = [&](const hyselam_sim::Segment& s, auto visit) {
    const double l = hyselam_sim::length(s.b - s.a);
    const int n = std::max(1, static_cast<int>(std::ceil(l / (0.5 * cell))));
    for (int i = 0; i < n; ++i) visit(s.a + ((i + 0.5) / n) * (s.b - s.a), l / n);
  };
  for (const auto& s : found) {
    along(s, [&](Point2 p, double l) {
      score.found_length += l;
      if (distanceTo(surfaces, p) <= near) score.found_near += l;
    });
  }
  for (const auto& place : plan.places) {
    for (std::size_t i = 0; i < place.outline.size(); ++i) {
      const hyselam_sim::Segment face{place.outline[i],
                                      place.outline[(i + 1) % place.outline.size()]};
      const Point2 u = (1.0 / hyselam_sim::length(face.b - face.a)) * (face.b - face.a);
      along(face, [&](Point2 p, double l) {
        // Where a wall is behind and nothing in front of it: no doorway, no furniture.
        const Point2 in{-u.y, u.x};
        const auto inside = [&](Point2 q) {
          return std::any_of(solid.begin(), solid.end(), [&](const hyselam_sim::Solid& s) {
            return hyselam_sim::contains(s.outline, q);
          });
        };
        if (!inside(p - 0.05 * in) || inside(p + 0.05 * in)) return;
        score.true_length += l;
        if (distanceTo(found, p) <= near) score.true_near += l;
      });
    }
  }
  return score;
}

}  // namespace plan_truth
