#include "hyselam_sim/generate_plan.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"

namespace hyselam_sim {

const char* const kOpeningPrefix = "opening ";

namespace {

constexpr double kThickness = 0.2;
constexpr double kMargin = 0.6;         // of the drawing around the floor [m]
constexpr double kCornerClear = 0.15;   // between a door and the corner of its room, at least [m]
constexpr double kNarrowOpening = 2.6;  // [m]

struct Box {
  double x0, y0, x1, y1;
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
};

// An edge of a place along x or, if upright, along y; in millimetres, so that equal is equal.
struct Face {
  bool upright;
  long line, from, to;
};

// Two boxes side by side, by index.
struct Side {
  std::size_t a, b;
  Point2 from, to;  // the common part of their edges
};

class Generator {
 public:
  Generator(std::uint64_t seed, const PlanParams& params)
      : params_(params), rng_(seed, 0x706c616e), seed_(seed) {
    static const std::uint64_t kLayouts = 3;
    layout_ = params.layout == PlanParams::Layout::kAny
                  ? static_cast<PlanParams::Layout>(1 + seed % kLayouts)
                  : params.layout;
  }

  FloorPlan run() {
    plan_.name = "generated_" + std::to_string(seed_);
    plan_.source = plan_.name;
    switch (layout_) {
      case PlanParams::Layout::kCorridor:
        corridor();
        break;
      case PlanParams::Layout::kCorner:
        corner();
        break;
      default:
        flat();
    }
    raiseWalls();
    if (params_.furniture) furnish();
    frame();
    return std::move(plan_);
  }

 private:
  // Lengths are multiples of 5 cm, as architects would have them.
  double between(double low, double high) {
    return low + 0.05 * std::floor(rng_.uniform() * ((high - low) / 0.05 + 1.0));
  }
  bool chance(double p) { return rng_.uniform() < p; }

  void addPlace(const std::string& name, const std::vector<Point2>& edge,
                const std::vector<Point2>& inner, Point2 at) {
    for (std::size_t i = 0; i < edge.size(); ++i) {
      const Point2 a = edge[i], b = edge[(i + 1) % edge.size()];
      const bool upright = std::abs(a.x - b.x) < std::abs(a.y - b.y);
      const auto line = std::lround(1e3 * (upright ? a.x : a.y));
      const auto from = std::lround(1e3 * (upright ? a.y : a.x)),
                 to = std::lround(1e3 * (upright ? b.y : b.x));
      faces_.push_back({upright, line, std::min(from, to), std::max(from, to)});
    }
    plan_.places.push_back({name, at, inner});
  }
  std::size_t addRoom(const Box& b, const std::string& kind) {
    const double t = 0.5 * kThickness;
    addPlace(
        kind + " " + std::to_string(rooms_.size() + 1),
        {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}},
        {{b.x0 + t, b.y0 + t}, {b.x1 - t, b.y0 + t}, {b.x1 - t, b.y1 - t}, {b.x0 + t, b.y1 - t}},
        {0.5 * (b.x0 + b.x1), 0.5 * (b.y0 + b.y1)});
    rooms_.push_back(b);
    return rooms_.size() - 1;
  }

  double doorWidth(double room_for) {
    const double common_low = std::max(params_.min_door, std::min(0.8, params_.max_door)),
                 common_high = std::min(params_.max_door, std::max(1.1, params_.min_door));
    const double width = chance(0.6) ? between(common_low, common_high)
                                     : between(params_.min_door, params_.max_door);
    return std::min(width, room_for);
  }

  // An opening of the given width somewhere between two points of a wall.
  void cut(Point2 from, Point2 to, double width, bool real) {
    const double l = length(to - from);
    const Point2 u = (1.0 / l) * (to - from);
    const double clear = 0.5 * width + (real ? kCornerClear : 0.0) + 0.5 * kThickness;
    double s = 0.5 * l;
    if (l > 2.0 * clear)
      s = chance(0.3) ? (chance(0.5) ? clear : l - clear) : between(clear, l - clear);
    PlanDoor door;
    door.width = width;
    door.at = from + std::clamp(s, 0.5 * width, l - 0.5 * width) * u;
    door.along = u;
    door.name = (real ? "door " : kOpeningPrefix) + std::to_string(plan_.doors.size() + 1);
    if (real && params_.leaves && width <= 1.1 && chance(0.5)) {
      door.swing = chance(0.5) ? PlanDoor::Swing::kLeft : PlanDoor::Swing::kRight;
      door.hinge = chance(0.5) ? PlanDoor::Hinge::kStart : PlanDoor::Hinge::kEnd;
    }
    plan_.doors.push_back(door);
  }
  // Jambs of at least a quarter of a metre in all, so that a door is narrower than its places.
  bool cutDoor(Point2 from, Point2 to) {
    const double room_for = length(to - from) - kThickness - 2.0 * kCornerClear;
    if (room_for < params_.min_door) return false;
    cut(from, to, doorWidth(room_for), true);
    return true;
  }
  bool cutOpening(Point2 from, Point2 to) {
    const double widest = 0.6 * (length(to - from) - kThickness);
    if (!params_.openings || widest < kNarrowOpening) return false;
    cut(from, to, between(kNarrowOpening, widest), false);
    return true;
  }

  // A row of rooms from x0 to about x0 + total; returns where it ends. `door_y` is the edge with
  // the corridor.
  double row(double x0, double total, double y0, double y1, double door_y) {
    double x = x0;
    bool entered = false, may_skip = false;
    for (std::size_t n = 0; x < x0 + total - 1.0; ++n) {
      double w = between(2.6, 6.0);
      if (x0 + total - (x + w) < 2.6) w = x0 + total - x;
      const Box box{x, y0, x + w, y1};
      addRoom(box, "room");
      const Point2 from{x, y0}, to{x, y1};
      bool joined = false;
      if (n > 0 && chance(0.15)) joined = cutOpening(from, to);
      if (n > 0 && !joined && chance(0.2)) joined = cutDoor(from, to);
      may_skip = joined && entered;
      if (!may_skip || chance(0.7)) {
        entered = cutDoor({x, door_y}, {x + w, door_y});
      } else {
        entered = false;
      }
      x += w;
    }
    return x;
  }

  void corridor() {
    const double total = between(14.0, 28.0), c = between(1.6, 2.6), d1 = between(3.5, 6.0),
                 d2 = between(3.5, 6.0);
    const double t = 0.5 * kThickness;
    const double y0 = d1, y1 = d1 + c + kThickness;
    addPlace("corridor", {{0, y0}, {total, y0}, {total, y1}, {0, y1}},
             {{t, y0 + t}, {total - t, y0 + t}, {total - t, y1 - t}, {t, y1 - t}},
             {0.5 * total, 0.5 * (y0 + y1)});
    row(0.0, total, 0.0, y0, y0);
    row(0.0, total, y1, y1 + d2, y1);
    if (chance(0.6)) {
      const double low = between(0.0, 0.4 * d1), high = y1 + between(0.5 * d2, d2);
      addRoom({total, low, total + between(4.5, 7.0), high}, "hall");
      if (params_.openings && chance(0.6)) {
        cut({total, y0}, {total, y1}, c, false);
      } else {
        cutDoor({total, y0}, {total, y1});
      }
    }
  }

  void corner() {
    const double total = between(12.0, 20.0), c = between(1.6, 2.4) + kThickness,
                 d = between(3.5, 5.5), up = between(7.0, 14.0), e = between(3.5, 5.0),
                 f = between(3.5, std::min(5.5, up));
    const double t = 0.5 * kThickness, y1 = d + c, top = y1 + up, x1 = total - c;
    addPlace("corridor", {{0, d}, {total, d}, {total, top}, {x1, top}, {x1, y1}, {0, y1}},
             {{t, d + t},
              {total - t, d + t},
              {total - t, top - t},
              {x1 + t, top - t},
              {x1 + t, y1 - t},
              {t, y1 - t}},
             {total - 0.5 * c, d + 0.5 * c});
    row(0.0, total, 0.0, d, d);
    row(0.0, x1 - e, y1, y1 + f, y1);
    for (double y = y1; y < top - 1.0;) {
      double h = between(2.8, 5.0);
      if (top - (y + h) < 2.8) h = top - y;
      addRoom({x1 - e, y, x1, y + h}, "room");
      cutDoor({x1, y}, {x1, y + h});
      y += h;
    }
  }

  void flat() {
    const std::size_t nx = 2 + rng_.below(3), ny = 2 + rng_.below(2);
    std::vector<double> xs{0.0}, ys{0.0};
    for (std::size_t i = 0; i < nx; ++i) xs.push_back(xs.back() + between(3.2, 6.5));
    for (std::size_t i = 0; i < ny; ++i) ys.push_back(ys.back() + between(3.2, 6.0));
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) addRoom({xs[i], ys[j], xs[i + 1], ys[j + 1]}, "room");
    }
    std::vector<Side> sides;
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) {
        const std::size_t k = j * nx + i;
        if (i + 1 < nx) sides.push_back({k, k + 1, {xs[i + 1], ys[j]}, {xs[i + 1], ys[j + 1]}});
        if (j + 1 < ny) sides.push_back({k, k + nx, {xs[i], ys[j + 1]}, {xs[i + 1], ys[j + 1]}});
      }
    }
    for (std::size_t i = sides.size(); i > 1; --i) {
      std::swap(sides[i - 1], sides[rng_.below(static_cast<std::uint32_t>(i))]);
    }
    // A random tree joins all rooms; some more doors make loops.
    std::vector<std::size_t> group(rooms_.size());
    for (std::size_t i = 0; i < group.size(); ++i) group[i] = i;
    for (const Side& s : sides) {
      const std::size_t ga = group[s.a], gb = group[s.b];
      if (ga == gb && !chance(0.2)) continue;
      if (!(chance(0.25) && cutOpening(s.from, s.to)) && !cutDoor(s.from, s.to)) continue;
      std::replace(group.begin(), group.end(), gb, ga);
    }
  }

  bool clearOfDoors(const Box& b) const {
    return std::all_of(plan_.doors.begin(), plan_.doors.end(), [&](const PlanDoor& d) {
      const double dx = std::max({b.x0 - d.at.x, d.at.x - b.x1, 0.0}),
                   dy = std::max({b.y0 - d.at.y, d.at.y - b.y1, 0.0});
      return std::hypot(dx, dy) > 0.5 * d.width + 0.9;
    });
  }

  // A cupboard or desk at a wall, a table in the middle; whatever is in the way of a door is left
  // out.
  void furnish() {
    for (std::size_t i = 0; i < rooms_.size(); ++i) {
      const Box& room = rooms_[i];
      const double t = 0.5 * kThickness;
      std::vector<Box> placed;
      for (int k = 0; k < 3; ++k) {
        double w = between(0.6, 1.6), h = between(0.5, 0.8);
        if (chance(0.5)) std::swap(w, h);
        const double free_x = room.width() - kThickness - w,
                     free_y = room.height() - kThickness - h;
        double x = room.x0 + t + between(0.0, free_x), y = room.y0 + t + between(0.0, free_y);
        if (k == 0 && room.width() > 4.0 && room.height() > 4.0) {
          x = 0.5 * (room.x0 + room.x1 - w);
          y = 0.5 * (room.y0 + room.y1 - h);
        } else if (chance(0.5)) {
          x = chance(0.5) ? room.x0 + t : room.x1 - t - w;
        } else {
          y = chance(0.5) ? room.y0 + t : room.y1 - t - h;
        }
        const Box b{x, y, x + w, y + h};
        const bool apart = std::all_of(placed.begin(), placed.end(), [&](const Box& o) {
          return b.x0 > o.x1 + 0.7 || b.x1 < o.x0 - 0.7 || b.y0 > o.y1 + 0.7 || b.y1 < o.y0 - 0.7;
        });
        if (!apart || !clearOfDoors(b)) continue;
        placed.push_back(b);
        plan_.furniture.push_back({"furniture " + std::to_string(plan_.furniture.size() + 1),
                                   {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}},
                                   k == 0 ? 0.75 : 1.6});
      }
    }
  }

  // One wall for all edges of places that lie on one line and touch: a door is in one wall only.
  void raiseWalls() {
    std::sort(faces_.begin(), faces_.end(), [](const Face& a, const Face& b) {
      return std::tie(a.upright, a.line, a.from, a.to) < std::tie(b.upright, b.line, b.from, b.to);
    });
    for (std::size_t i = 0; i < faces_.size();) {
      Face wall = faces_[i];
      for (; i < faces_.size() && faces_[i].upright == wall.upright &&
             faces_[i].line == wall.line && faces_[i].from <= wall.to;
           ++i) {
        wall.to = std::max(wall.to, faces_[i].to);
      }
      const double line = 1e-3 * static_cast<double>(wall.line),
                   from = 1e-3 * static_cast<double>(wall.from),
                   to = 1e-3 * static_cast<double>(wall.to);
      PlanWall out;
      out.name = "wall " + std::to_string(plan_.walls.size() + 1);
      out.points = wall.upright ? std::vector<Point2>{{line, from}, {line, to}}
                                : std::vector<Point2>{{from, line}, {to, line}};
      out.thickness = kThickness;
      plan_.walls.push_back(out);
    }
  }

  // Turns everything and fits the drawing around it.
  void frame() {
    const Pose2 turn{0.0, 0.0, params_.rotation};
    Point2 low{1e9, 1e9}, high{-1e9, -1e9};
    for (PlanWall& wall : plan_.walls) {
      for (Point2& p : wall.points) {
        p = turn * p;
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      }
    }
    for (PlanPlace& place : plan_.places) {
      place.at = turn * place.at;
      for (Point2& p : place.outline) p = turn * p;
    }
    for (PlanDoor& door : plan_.doors) {
      door.at = turn * door.at;
      door.along = turn * door.along;
    }
    for (Furniture& f : plan_.furniture) {
      for (Point2& p : f.outline) p = turn * p;
    }
    plan_.origin = low - Point2{kMargin, kMargin};
    plan_.size = high - low + Point2{2.0 * kMargin, 2.0 * kMargin};
  }

  PlanParams params_;
  PlanParams::Layout layout_ = PlanParams::Layout::kAny;
  hyselam::Rng rng_;
  std::uint64_t seed_;
  FloorPlan plan_;
  std::vector<Box> rooms_;
  std::vector<Face> faces_;
};

}  // namespace

void PlanParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("layout", layout,
        {{"any", Layout::kAny},
         {"corridor", Layout::kCorridor},
         {"corner", Layout::kCorner},
         {"flat", Layout::kFlat}},
        "of the rooms; any: chosen by the seed");
  visit("min_door", min_door, Range::between(0.5, 2.2), "m", "narrowest door");
  visit("max_door", max_door, Range::between(0.5, 2.2), "m", "widest door");
  visit("openings", openings, "with passages wider than doors");
  visit("leaves", leaves, "half of the narrow doors have a leaf that stands open");
  visit("furniture", furniture, "tables, desks, cupboards, clear of the doors");
  visit("rotation", rotation, Range::between(-1e6, 1e6), "rad", "of the whole floor");
}

void PlanParams::validate() const {
  hyselam::checkParameters(*this);
  if (!(max_door >= min_door)) {
    throw hyselam::ParameterError("max_door", max_door, "within min_door .. 2.2 m");
  }
}

FloorPlan generatePlan(std::uint64_t seed, const PlanParams& params) {
  params.validate();
  return Generator(seed, params).run();
}

}  // namespace hyselam_sim
