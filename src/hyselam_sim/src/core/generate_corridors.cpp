#include "hyselam_sim/generate_corridors.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"

namespace hyselam_sim {
namespace {

constexpr double kThickness = 0.1;  // of walls [m]

struct Box {
  double x0, y0, x1, y1;
};

Box boxAround(Point2 p, double width, double height) {
  return {p.x - 0.5 * width, p.y - 0.5 * height, p.x + 0.5 * width, p.y + 0.5 * height};
}

Polygon outlineOf(const Box& b) {
  return {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
}

struct Edge {
  int a, b;  // nodes; b is east or north of a
  bool east;
  int passed = 0;
  std::vector<int> offices = {};  // numbers of those with a door to it
};

class Builder {
 public:
  Builder(std::uint64_t seed, const CorridorParams& params)
      : params_(params), rng_(seed, 17), more_(seed, 18) {
    width_ = rng_.uniform(params.min_width, params.max_width);
    for (auto* at : {&x_, &y_}) {
      at->push_back(0.0);
      for (int i = 1; i < params.lines; ++i)
        at->push_back(at->back() + rng_.uniform(params.min_spacing, params.max_spacing));
    }
    chooseCorridors();
    for (const Edge& e : edges_) free_.push_back(corridor(e));
    for (int n = 0; n < nodes(); ++n) furnishNode(n);
    for (const Edge& e : edges_) addRoom(e);
    if (params.offices > 0.0) {
      for (Edge& e : edges_) addOffices(e);
    }
    if (params.furniture > 0.0) {
      for (const Box& hall : halls_) furnish(hall);
      for (const Office& office : offices_) furnish(office.box);
    }
    out_.plan.name = out_.route.plan = "corridors " + std::to_string(seed);
    out_.plan.source = out_.route.source = out_.route.name = out_.plan.name;
    out_.plan.floor_kind = "corridor";
    drawWalls();
    walk();
  }

  CorridorBuilding take() { return std::move(out_); }

 private:
  int nodes() const { return params_.lines * params_.lines; }
  Point2 at(int node) const {
    return {x_[static_cast<std::size_t>(node % params_.lines)],
            y_[static_cast<std::size_t>(node / params_.lines)]};
  }
  Point2 middle(const Edge& e) const { return 0.5 * (at(e.a) + at(e.b)); }
  std::vector<std::size_t> edgesAt(int node) const {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < edges_.size(); ++i)
      if (edges_[i].a == node || edges_[i].b == node) out.push_back(i);
    return out;
  }

  std::string nameOf(int node) const {
    return (edgesAt(node).size() == 1 ? "end " : "meeting ") + std::to_string(node);
  }

  void chooseCorridors() {
    std::vector<Edge> all;
    for (int n = 0; n < nodes(); ++n) {
      if (n % params_.lines + 1 < params_.lines) all.push_back({n, n + 1, true});
      if (n / params_.lines + 1 < params_.lines) all.push_back({n, n + params_.lines, false});
    }
    for (std::size_t i = all.size(); i > 1; --i)
      std::swap(all[i - 1], all[rng_.below(static_cast<std::uint32_t>(i))]);
    std::vector<int> group(static_cast<std::size_t>(nodes()));
    std::iota(group.begin(), group.end(), 0);
    const auto groupOf = [&](int n) { return group[static_cast<std::size_t>(n)]; };
    for (const Edge& e : all) {
      const int a = groupOf(e.a), b = groupOf(e.b);
      if (a == b && rng_.uniform() >= params_.loops) continue;
      for (int& g : group)
        if (g == b) g = a;
      edges_.push_back(e);
    }
  }

  Box corridor(const Edge& e) const {
    Box b{at(e.a).x, at(e.a).y, at(e.b).x, at(e.b).y};
    const double w = 0.5 * width_;
    return {b.x0 - w, b.y0 - w, b.x1 + w, b.y1 + w};
  }

  /// Largest box around a node that keeps clear of what may lie at the next lines.
  double roomAround(int node) const {
    double nearest = 1e9;
    const Point2 p = at(node);
    for (double x : x_)
      if (x != p.x) nearest = std::min(nearest, std::abs(x - p.x));
    for (double y : y_)
      if (y != p.y) nearest = std::min(nearest, std::abs(y - p.y));
    return nearest;
  }

  void furnishNode(int node) {
    const std::vector<std::size_t> here = edgesAt(node);
    std::string kind;
    Box area = boxAround(at(node), width_, width_);
    const double side = std::min(params_.max_hall, roomAround(node) - 1.0);
    if (here.size() == 1) {
      kind = "dead-end";
      if (rng_.uniform() < 0.7)
        area = boxAround(at(node), rng_.uniform(std::max(2.5, width_), 4.5),
                         rng_.uniform(std::max(2.5, width_), 4.5));
      free_.push_back(area);
    } else if (side >= 7.5 && rng_.uniform() < params_.halls) {
      kind = "hall";
      area = boxAround(at(node), side, side);
      free_.push_back(area);
      halls_.push_back(area);
    } else if (here.size() >= 3) {
      kind = "bifurcation";
    } else if (edges_[here[0]].east != edges_[here[1]].east) {
      kind = "corner";
    }
    if (!kind.empty()) out_.plan.areas.push_back({kind, outlineOf(area)});
    taken_.push_back(area);
  }

  /// Whether nothing but the corridor is where a room beside it is to be.
  bool isClear(const Box& room, const Edge& e) const {
    const Box clear{room.x0 - 0.3, room.y0 - 0.3, room.x1 + 0.3, room.y1 + 0.3};
    const Box own = corridor(e);
    for (const std::vector<Box>* boxes : {&free_, &taken_}) {
      for (const Box& b : *boxes) {
        const bool is_own = b.x0 == own.x0 && b.y0 == own.y0 && b.x1 == own.x1 && b.y1 == own.y1;
        if (!is_own && b.x0 < clear.x1 && b.x1 > clear.x0 && b.y0 < clear.y1 && b.y1 > clear.y0) {
          return false;
        }
      }
    }
    return true;
  }

  /// A small room with an open door at the side of a corridor, where nothing else is.
  void addRoom(const Edge& e) {
    if (rng_.uniform() >= params_.rooms) return;
    const double door = rng_.uniform(0.8, 1.2), depth = rng_.uniform(1.5, 5.0),
                 along = rng_.uniform(1.5, 5.0), side = rng_.below(2) == 0 ? -1.0 : 1.0;
    const double gap = 0.5 * width_ + 0.2 + 0.5 * depth;
    const Point2 m = middle(e), to = e.east ? Point2{0.0, side} : Point2{side, 0.0};
    const Point2 center = m + gap * to, sill = m + (0.5 * width_ + 0.1) * to;
    const Box room = e.east ? boxAround(center, along, depth) : boxAround(center, depth, along);
    if (!isClear(room, e)) return;
    free_.push_back(room);
    free_.push_back(e.east ? boxAround(sill, door, 0.4) : boxAround(sill, 0.4, door));
  }

  /// Rooms behind doors along both sides of a corridor, in rows without regular widths.
  void addOffices(Edge& e) {
    const Point2 along = e.east ? Point2{1.0, 0.0} : Point2{0.0, 1.0},
                 across = e.east ? Point2{0.0, 1.0} : Point2{1.0, 0.0};
    const double length = hyselam_sim::length(at(e.b) - at(e.a));
    const auto box = [&](Point2 middle, double w, double d) {
      return e.east ? boxAround(middle, w, d) : boxAround(middle, d, w);
    };
    for (const double side : {-1.0, 1.0}) {
      const double depth = more_.uniform(3.0, 6.5);
      for (double from = 0.5 * width_ + 0.3; from < length - 2.5;) {
        const double w = more_.uniform(2.6, 6.0), door = more_.uniform(0.85, 1.3);
        const double middle = from + 0.5 * w;
        const double slack = 0.5 * (w - door) - 0.1;
        const Point2 sill = at(e.a) + (middle + more_.uniform(-slack, slack)) * along +
                            side * (0.5 * width_ + 0.1) * across;
        const Point2 center =
            at(e.a) + middle * along + side * (0.5 * width_ + 0.2 + 0.5 * depth) * across;
        const Box room = box(center, w, depth);
        const bool wanted = more_.uniform() < params_.offices;
        from += w + 0.4;
        if (!wanted || from > length || !isClear(room, e)) continue;
        free_.push_back(room);
        free_.push_back(box(sill, door, 0.4));
        out_.plan.areas.push_back({"dead-end", outlineOf(room)});
        e.offices.push_back(static_cast<int>(offices_.size()));
        offices_.push_back({room, center, sill});
      }
    }
  }

  /// Things of all sizes, one may walk between them; the middle and the doors stay clear.
  void furnish(const Box& b) {
    const Point2 middle = 0.5 * Point2{b.x0 + b.x1, b.y0 + b.y1};
    std::vector<Box> placed;
    double open = params_.furniture * (b.x1 - b.x0) * (b.y1 - b.y0);
    const int tries = 4 + static_cast<int>((b.x1 - b.x0) * (b.y1 - b.y0));
    const auto gap = [](const Box& one, const Box& other) {
      return std::max({one.x0 - other.x1, other.x0 - one.x1, one.y0 - other.y1, other.y0 - one.y1});
    };
    for (int i = 0; i < tries && open > 0.0; ++i) {
      const double most = std::min(3.0, 0.4 * std::min(b.x1 - b.x0, b.y1 - b.y0));
      const double w = more_.uniform(0.3, most), h = more_.uniform(0.3, most);
      double x = more_.uniform(b.x0, b.x1 - w), y = more_.uniform(b.y0, b.y1 - h);
      // Half of them stand at a wall.
      const std::uint32_t wall = more_.below(8);
      if (wall == 0) x = b.x0;
      if (wall == 1) x = b.x1 - w;
      if (wall == 2) y = b.y0;
      if (wall == 3) y = b.y1 - h;
      const Box thing{x, y, x + w, y + h};
      bool clear = gap(thing, boxAround(middle, 0.0, 0.0)) > 0.8;
      for (const Box& other : placed) clear = clear && gap(thing, other) > 1.0;
      for (const Office& o : offices_)
        clear = clear && gap(thing, boxAround(o.sill, 0.0, 0.0)) > 1.2;
      // Corridors that lead into a hall are not blocked.
      for (const Edge& e : edges_) clear = clear && gap(thing, corridor(e)) > 0.0;
      if (!clear) continue;
      placed.push_back(thing);
      open -= w * h;
      out_.plan.furniture.push_back(
          {"thing " + std::to_string(out_.plan.furniture.size()), outlineOf(thing)});
    }
  }

  /// Walls along the rim of all free boxes, as closed lines.
  void drawWalls() {
    std::vector<double> xs, ys;
    for (Box& b : free_) {
      const double t = 0.5 * kThickness;
      b = {b.x0 - t, b.y0 - t, b.x1 + t, b.y1 + t};
      xs.insert(xs.end(), {b.x0, b.x1});
      ys.insert(ys.end(), {b.y0, b.y1});
    }
    for (auto* v : {&xs, &ys}) {
      std::sort(v->begin(), v->end());
      v->erase(std::unique(v->begin(), v->end()), v->end());
    }
    const int nx = static_cast<int>(xs.size()), ny = static_cast<int>(ys.size());
    const auto isFree = [&](int i, int j) {
      if (i < 0 || j < 0 || i + 1 >= nx || j + 1 >= ny) return false;
      const double x =
          0.5 * (xs[static_cast<std::size_t>(i)] + xs[static_cast<std::size_t>(i) + 1]);
      const double y =
          0.5 * (ys[static_cast<std::size_t>(j)] + ys[static_cast<std::size_t>(j) + 1]);
      return std::any_of(free_.begin(), free_.end(), [&](const Box& b) {
        return x > b.x0 && x < b.x1 && y > b.y0 && y < b.y1;
      });
    };
    // Directed pieces of rim with the free side on the left, from vertex to vertex.
    std::multimap<std::pair<int, int>, std::pair<int, int>> next;
    for (int i = 0; i + 1 < nx; ++i) {
      for (int j = 0; j + 1 < ny; ++j) {
        if (!isFree(i, j)) continue;
        if (!isFree(i, j - 1)) next.insert({{i, j}, {i + 1, j}});
        if (!isFree(i + 1, j)) next.insert({{i + 1, j}, {i + 1, j + 1}});
        if (!isFree(i, j + 1)) next.insert({{i + 1, j + 1}, {i, j + 1}});
        if (!isFree(i - 1, j)) next.insert({{i, j + 1}, {i, j}});
      }
    }
    while (!next.empty()) {
      std::vector<std::pair<int, int>> loop{next.begin()->first};
      while (true) {
        const auto step = next.find(loop.back());
        if (step == next.end()) break;
        loop.push_back(step->second);
        next.erase(step);
      }
      loop.pop_back();  // the first vertex again
      PlanWall wall;
      wall.closed = true;
      wall.thickness = kThickness;
      const std::size_t n = loop.size();
      for (std::size_t k = 0; k < n; ++k) {
        const auto &p = loop[(k + n - 1) % n], &q = loop[k], &r = loop[(k + 1) % n];
        const bool straight = (p.first == q.first) == (q.first == r.first);
        if (!straight)
          wall.points.push_back(
              {xs[static_cast<std::size_t>(q.first)], ys[static_cast<std::size_t>(q.second)]});
      }
      out_.plan.walls.push_back(wall);
    }
    out_.plan.origin = {xs.front() - 0.5, ys.front() - 0.5};
    out_.plan.size = {xs.back() - xs.front() + 1.0, ys.back() - ys.front() + 1.0};
  }

  /// From corridor to corridor, the least passed first.
  void walk() {
    const auto place = [&](const Point2& p, const std::string& name) {
      out_.plan.places.push_back({name, p, {}});
    };
    for (std::size_t i = 0; i < edges_.size(); ++i)
      place(middle(edges_[i]), "corridor " + std::to_string(i));
    for (int n = 0; n < nodes(); ++n) place(at(n), nameOf(n));
    for (std::size_t i = 0; i < offices_.size(); ++i) {
      place(offices_[i].middle, "office " + std::to_string(i));
    }
    const auto go = [&](const std::string& name) {
      RouteStep step;
      step.spot.place = name;
      step.where = "step " + std::to_string(out_.route.steps.size());
      out_.route.steps.push_back(step);
    };
    std::size_t edge = rng_.below(static_cast<std::uint32_t>(edges_.size()));
    out_.route.start.place = "corridor " + std::to_string(edge);
    int node = edges_[edge].b;
    edges_[edge].passed = 1;
    for (int leg = 0; leg < params_.legs; ++leg) {
      const std::vector<std::size_t> here = edgesAt(node);
      std::size_t best = edge;
      if (here.size() == 1) {
        go(nameOf(node));
      } else {
        // A place on the way makes for a sharp turn, without it the way is rounded.
        if (rng_.uniform() < 0.4) go(nameOf(node));
        double least = 1e9;
        for (std::size_t k : here) {
          if (k == edge) continue;
          const double cost = edges_[k].passed + rng_.uniform();
          if (cost < least) {
            least = cost;
            best = k;
          }
        }
      }
      edge = best;
      ++edges_[edge].passed;
      const std::vector<int>& offices = edges_[edge].offices;
      if (!offices.empty() && more_.uniform() < 0.6) {
        const auto k = more_.below(static_cast<std::uint32_t>(offices.size()));
        go("office " + std::to_string(offices[k]));
      }
      go("corridor " + std::to_string(edge));
      node = edges_[edge].a == node ? edges_[edge].b : edges_[edge].a;
    }
  }

  CorridorParams params_;
  struct Office {
    Box box;
    Point2 middle, sill;
  };
  hyselam::Rng rng_;
  hyselam::Rng more_;  // for what is not in every building, which is then the same without it
  double width_ = 2.0;
  std::vector<double> x_, y_;
  std::vector<Edge> edges_;
  std::vector<Box> free_, taken_, halls_;
  std::vector<Office> offices_;
  CorridorBuilding out_;
};

}  // namespace

void CorridorParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("lines", lines, Range::between(2, 8), "", "corridors that may run north and as many east");
  visit("min_width", min_width, Range::between(1.2, 10.0), "m", "of the corridors");
  visit("max_width", max_width, Range::between(1.2, 10.0), "m", "of the corridors");
  visit("min_spacing", min_spacing, Range::above(0.0), "m",
        "between center lines; at least max_width + 2");
  visit("max_spacing", max_spacing, Range::aboveUpTo(0.0, 100.0), "m", "between center lines");
  visit("loops", loops, Range::between(0.0, 1.0), "",
        "share of the corridors that are not needed for a connected building");
  visit("halls", halls, Range::between(0.0, 1.0), "",
        "share of the meeting points with room for it that are halls");
  visit("rooms", rooms, Range::between(0.0, 1.0), "",
        "share of the corridors with an open room at their side");
  visit("max_hall", max_hall, Range::between(7.5, 40.0), "m", "longest side of a hall");
  visit("offices", offices, Range::between(0.0, 1.0), "",
        "share of the stretches beside corridors that are offices behind a door");
  visit("furniture", furniture, Range::between(0.0, 0.4), "",
        "share of the floor in halls and offices that things stand on");
  visit("legs", legs, Range::between(1, 100000), "", "corridors that the route passes");
}

void CorridorParams::validate() const {
  hyselam::checkParameters(*this);
  if (!(max_width >= min_width)) {
    throw hyselam::ParameterError("max_width", max_width, "in min_width .. 10 [m]");
  }
  if (!(min_spacing >= max_width + 2.0)) {
    throw hyselam::ParameterError("min_spacing", min_spacing, ">= max_width + 2 [m]");
  }
  if (!(max_spacing >= min_spacing)) {
    throw hyselam::ParameterError("max_spacing", max_spacing, "in min_spacing .. 100 [m]");
  }
}

CorridorBuilding generateCorridors(std::uint64_t seed, const CorridorParams& params) {
  params.validate();
  return Builder(seed, params).take();
}

}  // namespace hyselam_sim
