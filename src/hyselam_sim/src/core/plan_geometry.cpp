#include "hyselam_sim/plan_geometry.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_sim {
namespace {

struct Gap {
  double from;
  double to;
};

// The part of a wall's segment that doors open, in metres along the segment.
std::vector<Gap> gapsIn(const FloorPlan& plan, const Segment& s, double thickness) {
  std::vector<Gap> gaps;
  const double l = length(s.b - s.a);
  const Point2 u = (1.0 / l) * (s.b - s.a);
  for (const PlanDoor& door : plan.doors) {
    const Point2 to_door = door.at - s.a;
    const bool parallel = std::abs(cross(u, door.along)) < 1e-6;
    if (!parallel || std::abs(cross(u, to_door)) > 0.5 * thickness + 1e-6) continue;
    const double middle = dot(u, to_door);
    const Gap gap{middle - 0.5 * door.width, middle + 0.5 * door.width};
    if (gap.to > 0.0 && gap.from < l) gaps.push_back(gap);
  }
  std::sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.from < b.from; });
  return gaps;
}

}  // namespace

std::vector<Solid> wallSolids(const FloorPlan& plan) {
  std::vector<Solid> out;
  for (std::size_t w = 0; w < plan.walls.size(); ++w) {
    const PlanWall& wall = plan.walls[w];
    for (std::size_t i = 0; i < wall.segmentCount(); ++i) {
      const Segment s = wall.segment(i);
      const double l = length(s.b - s.a);
      const Point2 u = (1.0 / l) * (s.b - s.a);
      // Pieces are lengthened by half a thickness at their ends, so that corners are filled.
      const double cap = 0.5 * wall.thickness;
      double from = -cap;
      const auto piece = [&](double to) {
        if (to - from < 1e-9) return;
        out.push_back({Solid::Kind::kWall, w,
                       thickSegment(s.a + from * u, s.a + to * u, wall.thickness, 0.0, 0.0)});
      };
      for (const Gap& gap : gapsIn(plan, s, wall.thickness)) {
        piece(gap.from);
        from = std::max(from, gap.to);
      }
      piece(l + cap);
    }
  }
  return out;
}

Polygon doorLeaf(const PlanDoor& door, double time) {
  const Point2 half = (0.5 * door.width) * door.along;
  if (!door.isOpen(time)) {
    return thickSegment(door.at - half, door.at + half, kLeafThickness, 0.0, 0.0);
  }
  if (door.swing == PlanDoor::Swing::kNone) return {};
  const Point2 left{-door.along.y, door.along.x};
  const Point2 out = door.swing == PlanDoor::Swing::kLeft ? left : -1.0 * left;
  // The leaf stands beside the opening's edge, just within it.
  const double inset = 0.5 * kLeafThickness;
  const Point2 hinge = door.hinge == PlanDoor::Hinge::kStart ? door.at - half + inset * door.along
                                                             : door.at + half - inset * door.along;
  return thickSegment(hinge, hinge + door.width * out, kLeafThickness, 0.0, 0.0);
}

std::vector<Solid> solids(const FloorPlan& plan, double time, bool with_furniture) {
  std::vector<Solid> out = wallSolids(plan);
  for (std::size_t i = 0; i < plan.doors.size(); ++i) {
    Polygon leaf = doorLeaf(plan.doors[i], time);
    if (!leaf.empty()) out.push_back({Solid::Kind::kDoor, i, std::move(leaf)});
  }
  if (with_furniture) {
    for (std::size_t i = 0; i < plan.furniture.size(); ++i) {
      out.push_back({Solid::Kind::kFurniture, i, plan.furniture[i].outline});
    }
  }
  return out;
}

std::vector<Segment> edges(const std::vector<Solid>& solids) {
  std::vector<Segment> out;
  for (const Solid& solid : solids) {
    for (std::size_t i = 0; i < solid.outline.size(); ++i) {
      out.push_back({solid.outline[i], solid.outline[(i + 1) % solid.outline.size()]});
    }
  }
  return out;
}

std::string describe(const FloorPlan& plan, const Solid& solid) {
  const auto named = [&](const char* what, const std::string& name) {
    return name.empty() ? what + (" " + std::to_string(solid.index)) : what + (" '" + name + "'");
  };
  switch (solid.kind) {
    case Solid::Kind::kWall:
      return named("wall", plan.walls[solid.index].name);
    case Solid::Kind::kDoor:
      return named("door", plan.doors[solid.index].name);
    case Solid::Kind::kFurniture:
      return named("furniture", plan.furniture[solid.index].name);
  }
  return "";
}

}  // namespace hyselam_sim
