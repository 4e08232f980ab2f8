#include "decoration.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "hyselam_common/rng.hpp"
#include "hyselam_sim/plan_geometry.hpp"

namespace hyselam_sim {
namespace {

using hyselam::Rng;

constexpr double kPanelDepth = 0.02;   // posters and windows stand out so far [m]
constexpr double kPanelEvery = 2.4;    // one spot per so much wall [m]
constexpr double kLeastMargin = 0.25;  // from the end of a wall [m]

Color tinted(Rng& rng, double light, double strength) {
  Color out;
  for (float& channel : out) {
    channel = static_cast<float>(std::clamp(light + strength * (rng.uniform() - 0.5), 0.05, 0.95));
  }
  return out;
}

std::uint32_t seedOf(Rng& rng) {
  return static_cast<std::uint32_t>(rng() >> 32);
}

bool speaksOf(const std::string& name, std::initializer_list<const char*> words) {
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return lower.find(word) != std::string::npos; });
}

// The outline drawn together towards its middle.
Polygon shrunk(const Polygon& outline, double by) {
  Point2 middle;
  for (const Point2& p : outline) middle = middle + (1.0 / static_cast<double>(outline.size())) * p;
  Polygon out;
  for (const Point2& p : outline) {
    const Point2 way = p - middle;
    const double d = length(way);
    out.push_back(d > by ? middle + ((d - by) / d) * way : middle);
  }
  return out;
}

Polygon disc(Point2 center, double radius, int corners) {
  Polygon out;
  for (int i = 0; i < corners; ++i) {
    const double a = 2.0 * hyselam::kPi * i / corners;
    out.push_back(center + radius * Point2{std::cos(a), std::sin(a)});
  }
  return out;
}

// One face of a wall: from `a` to `b` with the room on its left.
struct Face {
  Point2 a;
  Point2 b;
  double height;
};

std::vector<Face> facesOf(const FloorPlan& plan) {
  std::vector<Face> faces;
  for (const Solid& solid : wallSolids(plan)) {
    const double height = plan.walls[solid.index].height;
    const Polygon& o = solid.outline;
    for (std::size_t i = 0; i < o.size(); ++i) {
      const Point2 a = o[i], b = o[(i + 1) % o.size()];
      if (length(b - a) < 1.2) continue;
      // Outlines run counter-clockwise or clockwise: the outside is where the outline is not.
      const Point2 middle = 0.5 * (a + b);
      const Point2 u = (1.0 / length(b - a)) * (b - a);
      const Point2 left{-u.y, u.x};
      faces.push_back(contains(o, middle + 0.01 * left) ? Face{b, a, height} : Face{a, b, height});
    }
  }
  return faces;
}

}  // namespace

std::uint64_t hashOf(const std::string& text, std::uint64_t seed) {
  std::uint64_t h = hyselam::splitmix64(seed);
  for (const char c : text) h = hyselam::mix(h, static_cast<unsigned char>(c));
  return h;
}

RoomStyle roomStyle(std::uint64_t seed, const std::string& name) {
  Rng rng(hashOf(name, seed), 1);
  RoomStyle style;
  const bool wet = speaksOf(name, {"kitchen", "bath", "toilet", "laundry", "wc"});
  const bool rough = speaksOf(name, {"workshop", "store", "garage", "server", "laboratory"});
  style.paint.seed = seedOf(rng);
  style.paint.material = rough && rng.uniform() < 0.5 ? Material::kBrick
                         : wet                        ? Material::kTiles
                                                      : Material::kPaint;
  style.paint.color = tinted(rng, 0.62, style.paint.material == Material::kBrick ? 0.3 : 0.42);
  if (style.paint.material == Material::kBrick) style.paint.color = {0.45f, 0.24f, 0.18f};
  style.floor.seed = seedOf(rng);
  const double choice = rng.uniform();
  style.floor.material = wet || choice < 0.2 ? Material::kTiles
                         : choice < 0.6      ? Material::kCarpet
                                             : Material::kWood;
  style.floor.color = tinted(rng, 0.3, 0.3);
  if (style.floor.material == Material::kWood) {
    const auto tone = static_cast<float>(rng.uniform(0.6, 1.3));
    style.floor.color = {0.42f * tone, 0.27f * tone, 0.15f * tone};
  }
  style.ceiling.seed = seedOf(rng);
  style.ceiling.material = rng.uniform() < 0.5 ? Material::kTiles : Material::kPlain;
  style.ceiling.color = tinted(rng, 0.78, 0.06);
  return style;
}

WallDecoration decorateWalls(const FloorPlan& plan, const FloorRegions& regions,
                             const SceneParams& params) {
  WallDecoration out;
  const std::vector<Face> faces = facesOf(plan);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Face& face = faces[f];
    Rng rng(hyselam::mix(params.seed, 77), f);
    const double l = length(face.b - face.a);
    const Point2 u = (1.0 / l) * (face.b - face.a);
    const Point2 out_of_wall{-u.y, u.x};
    const int spots = static_cast<int>(l / kPanelEvery);
    for (int i = 0; i < spots; ++i) {
      const double share = rng.uniform(), width_draw = rng.uniform(), shift = rng.uniform();
      const std::uint32_t pattern = seedOf(rng);
      const double middle = (i + 0.35 + 0.3 * shift) * l / spots;
      const Point2 at = face.a + middle * u;
      if (!regions.onFloor(at + 0.3 * out_of_wall)) continue;
      const bool outer =
          !regions.onFloor(at - 0.5 * out_of_wall) && !regions.onFloor(at - 0.9 * out_of_wall);
      const bool window = outer && share < params.window_share;
      if (!window && share > (outer ? params.window_share : 0.0) + params.poster_share) continue;
      double width = window ? 0.9 + 0.9 * width_draw : 0.5 + 0.8 * width_draw;
      width = std::min(width, 2.0 * (std::min(middle, l - middle) - kLeastMargin));
      if (width < 0.3) continue;
      const double from = window ? 0.95 : 1.05 + 0.25 * shift;
      const double to = std::min(face.height - 0.15, window ? 2.15 : from + 0.5 + 0.5 * shift);
      if (to < from + 0.2) continue;
      const Point2 half = (0.5 * width) * u;
      Body panel;
      panel.outline = {at - half, at + half, at + half + kPanelDepth * out_of_wall,
                       at - half + kPanelDepth * out_of_wall};
      panel.from = from;
      panel.to = to;
      panel.side = {window ? Material::kWindow : Material::kPoster, {1.0f, 1.0f, 1.0f}, pattern};
      panel.top = {Material::kPlain, {0.8f, 0.8f, 0.8f}, 0};
      out.bodies.push_back(panel);
      if (!window) continue;
      out.windows.push_back({at, out_of_wall, width * (to - from)});
      // The frame: a sill below and a bar above.
      for (const double z : {from - 0.06, to}) {
        Body frame = panel;
        frame.side = frame.top = {Material::kPlain, {0.82f, 0.82f, 0.8f}, 0};
        frame.from = z;
        frame.to = z + 0.06;
        frame.outline[2] = at + half + 3.0 * kPanelDepth * out_of_wall;
        frame.outline[3] = at - half + 3.0 * kPanelDepth * out_of_wall;
        out.bodies.push_back(frame);
      }
    }
  }
  return out;
}

std::vector<Body> furnitureBodies(const Furniture& furniture, std::uint64_t seed) {
  Rng rng(hashOf(furniture.name, seed), 2);
  const Surface wood{
      Material::kWood,
      {static_cast<float>(rng.uniform(0.25, 0.6)), static_cast<float>(rng.uniform(0.18, 0.4)),
       static_cast<float>(rng.uniform(0.1, 0.25))},
      seedOf(rng)};
  const Surface paint{Material::kPlain, tinted(rng, 0.4, 0.6), seedOf(rng)};
  const auto with = [&](const Polygon& outline, double from, double to, const Surface& side,
                        const Surface& top) {
    Body body;
    body.outline = outline;
    body.from = from;
    body.to = to;
    body.side = side;
    body.top = top;
    return body;
  };
  const std::string& name = furniture.name;
  const double h = furniture.height;
  if (speaksOf(name, {"table", "desk", "bench", "island"})) {
    std::vector<Body> bodies{with(furniture.outline, h - 0.04, h, wood, wood)};
    const Polygon inner = shrunk(furniture.outline, 0.09);
    const std::size_t step = std::max<std::size_t>(1, inner.size() / 4);
    for (std::size_t i = 0; i < inner.size(); i += step) {
      bodies.push_back(with(disc(inner[i], 0.03, 6), 0.0, h - 0.04, paint, paint));
    }
    return bodies;
  }
  if (speaksOf(name, {"sofa", "couch", "chair"})) {
    const Surface cloth{Material::kCarpet, tinted(rng, 0.35, 0.6), seedOf(rng)};
    return {with(furniture.outline, 0.0, 0.55 * h, cloth, cloth),
            with(shrunk(furniture.outline, 0.12), 0.0, h, cloth, cloth)};
  }
  if (speaksOf(name, {"shelf", "rack", "book"})) {
    return {with(furniture.outline, 0.0, h, {Material::kShelf, wood.color, wood.seed}, wood)};
  }
  if (h > 1.2 || speaksOf(name, {"cupboard", "kitchenette", "counter", "basin"})) {
    const Surface front{Material::kCupboard, rng.uniform() < 0.5 ? wood.color : paint.color,
                        wood.seed};
    return {with(furniture.outline, 0.0, h, front, wood)};
  }
  return {with(furniture.outline, 0.0, h, rng.uniform() < 0.5 ? wood : paint, wood)};
}

}  // namespace hyselam_sim
