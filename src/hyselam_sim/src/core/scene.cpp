#include "hyselam_sim/scene.hpp"

#include <algorithm>
#include <cmath>

#include "decoration.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_sim/plan_geometry.hpp"

namespace hyselam_sim {
namespace {

double ceilingOf(const FloorPlan& plan) {
  double height = 0.0;
  for (const PlanWall& wall : plan.walls) height = std::max(height, wall.height);
  return height;
}

double thicknessAt(const FloorPlan& plan, const PlanDoor& door) {
  double best = 1e9, thickness = 0.2;
  for (const PlanWall& wall : plan.walls) {
    for (std::size_t i = 0; i < wall.segmentCount(); ++i) {
      const double d = distance(door.at, wall.segment(i));
      if (d < best) {
        best = d;
        thickness = wall.thickness;
      }
    }
  }
  return thickness;
}

Polygon discOutline(Point2 center, double radius, int corners) {
  Polygon out;
  for (int i = 0; i < corners; ++i) {
    const double a = 2.0 * hyselam::kPi * (i + 0.5) / corners;
    out.push_back(center + radius * Point2{std::cos(a), std::sin(a)});
  }
  return out;
}

Polygon outlineOf(const Thing& thing) {
  if (thing.shape == Thing::Shape::kCylinder) {
    return discOutline({thing.pose.x, thing.pose.y}, 0.5 * thing.size[0], 14);
  }
  const double l = 0.5 * thing.size[0], w = 0.5 * thing.size[1];
  Polygon out;
  for (const Point2& p : {Point2{-l, -w}, Point2{l, -w}, Point2{l, w}, Point2{-l, w}}) {
    out.push_back(thing.pose * p);
  }
  return out;
}

std::string nameOfRoom(const FloorPlan& plan, const FloorRegions& regions, int room) {
  for (const PlanPlace& place : plan.places) {
    if (regions.roomAt(place.at) == room) return place.name;
  }
  return "room " + std::to_string(room);
}

LightMap lightOf(const FloorPlan& plan, const FloorRegions& regions,
                 const std::vector<Window>& windows, double ceiling) {
  // Light passes open doors; furniture stops too little of it to matter.
  FloorPlan open = plan;
  for (PlanDoor& door : open.doors) {
    door.initially_open = true;
    door.schedule.clear();
    door.swing = PlanDoor::Swing::kNone;
  }
  return LightMap(regions, PlanRayCaster(edges(solids(open, 0.0, false))), windows, ceiling);
}

// What stands still.
std::vector<Body> build(const FloorPlan& plan, const SceneParams& params, double ceiling,
                        const WallDecoration& walls) {
  std::vector<Body> bodies;
  const Surface plain{Material::kPaint, {0.7f, 0.7f, 0.68f}, 5};
  for (Solid& solid : wallSolids(plan)) {
    Body body;
    body.outline = std::move(solid.outline);
    body.to = plan.walls[solid.index].height;
    body.side = body.top = plain;
    body.painted = true;
    bodies.push_back(std::move(body));
  }
  for (const PlanDoor& door : plan.doors) {
    if (params.door_height >= ceiling - 0.01 || door.name.rfind("opening ", 0) == 0) continue;
    const Point2 half = (0.5 * door.width) * door.along;
    Body lintel;
    lintel.outline =
        thickSegment(door.at - half, door.at + half, thicknessAt(plan, door), 0.0, 0.0);
    lintel.from = params.door_height;
    lintel.to = ceiling;
    lintel.side = lintel.top = plain;
    lintel.painted = true;
    bodies.push_back(std::move(lintel));
  }
  bodies.insert(bodies.end(), walls.bodies.begin(), walls.bodies.end());
  for (std::size_t i = 0; i < plan.furniture.size(); ++i) {
    for (Body& body : furnitureBodies(plan.furniture[i], params.seed)) {
      body.owner = static_cast<std::uint32_t>(1 + i);
      bodies.push_back(std::move(body));
    }
  }
  for (std::size_t i = 0; i < params.things.size(); ++i) {
    const Thing& thing = params.things[i];
    Body body;
    body.outline = outlineOf(thing);
    body.from = thing.z;
    body.to = thing.z + thing.size[2];
    body.side = body.top = {Material::kPlain, thing.color, 0};
    body.owner = static_cast<std::uint32_t>(1 + plan.furniture.size() + i);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

}  // namespace

void SceneParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("seed", seed, Range::atLeast(0), "", "of paint, windows and posters");
  visit("door_height", door_height, Range::between(1.0, 10.0), "m", "of all doors");
  visit("window_share", window_share, Range::between(0.0, 1.0), "",
        "of the spots at outer walls that could have a window");
  visit("poster_share", poster_share, Range::between(0.0, 1.0), "",
        "the same for posters at all walls");
}

void SceneParams::validate() const {
  hyselam::checkParameters(*this);
}

Scene::Scene(const FloorPlan& plan, const SceneParams& params)
    : plan_((params.validate(), plan)),
      params_(params),
      regions_(plan),
      ceiling_(ceilingOf(plan)),
      light_([&] {
        const WallDecoration walls = decorateWalls(plan_, regions_, params_);
        bodies_ = build(plan_, params_, ceiling_, walls);
        return lightOf(plan_, regions_, walls.windows, ceiling_);
      }()) {
  for (int room = 0; room <= regions_.rooms(); ++room) {
    RoomStyle style = roomStyle(params_.seed, nameOfRoom(plan_, regions_, room));
    paints_.push_back(style.paint);
    floors_.push_back(style.floor);
    ceilings_.push_back(style.ceiling);
  }
  for (const Point2& lamp : light_.lamps()) {
    Body body;
    body.outline = {lamp + Point2{-0.3, -0.3}, lamp + Point2{0.3, -0.3}, lamp + Point2{0.3, 0.3},
                    lamp + Point2{-0.3, 0.3}};
    body.from = ceiling_ - 0.06;
    body.to = ceiling_;
    body.side = body.top = {Material::kLamp, {0.9f, 0.9f, 0.88f}, 0};
    bodies_.push_back(std::move(body));
  }
}

std::vector<Body> Scene::doors(double time) const {
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < plan_.doors.size(); ++i) {
    Body body;
    body.outline = doorLeaf(plan_.doors[i], time);
    if (body.outline.empty()) continue;
    body.to = params_.door_height - 0.02;
    const std::uint64_t h = hashOf(plan_.doors[i].name, params_.seed + i);
    const float tone = 0.7f + 0.6f * static_cast<float>(h >> 40) / 16777216.0f;
    body.side = {
        Material::kWood, {0.5f * tone, 0.36f * tone, 0.24f * tone}, static_cast<std::uint32_t>(h)};
    body.top = body.side;
    bodies.push_back(std::move(body));
  }
  return bodies;
}

std::vector<Body> Scene::people(const std::vector<Person>& people, double time,
                                Point2 robot) const {
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < people.size(); ++i) {
    const std::optional<Point2> at = people[i].at(time);
    if (!at) continue;
    const Point2 middle = makeRoom(*at, robot);
    hyselam::Rng rng(hashOf(people[i].name, params_.seed + i), 3);
    const auto cloth = [&rng] {
      Color color;
      for (float& channel : color) channel = static_cast<float>(rng.uniform(0.03, 0.7));
      return Surface{Material::kPlain, color, 0};
    };
    const Surface trousers = cloth(), shirt = cloth();
    const Surface skin{Material::kPlain, {0.6f, 0.42f, 0.32f}, 0};
    const double r = people[i].radius, tall = rng.uniform(1.6, 1.85);
    const auto add = [&](double radius, double from, double to, const Surface& surface) {
      Body body;
      body.outline = discOutline(middle, radius, 10);
      body.from = from;
      body.to = to;
      body.side = body.top = surface;
      body.owner =
          static_cast<std::uint32_t>(1 + plan_.furniture.size() + params_.things.size() + i);
      bodies.push_back(std::move(body));
    };
    add(0.75 * r, 0.0, 0.5 * tall, trousers);
    add(0.9 * r, 0.5 * tall, 0.84 * tall, shirt);
    add(0.4 * r, 0.84 * tall, tall, skin);
  }
  return bodies;
}

namespace {
const Surface& styleOf(const std::vector<Surface>& styles, int room) {
  const bool known = room >= 0 && static_cast<std::size_t>(room) < styles.size();
  return known ? styles[static_cast<std::size_t>(room)] : styles.back();
}
}  // namespace

const Surface& Scene::floor(int room) const {
  return styleOf(floors_, room);
}
const Surface& Scene::ceilingSurface(int room) const {
  return styleOf(ceilings_, room);
}
const Surface& Scene::paint(int room) const {
  return styleOf(paints_, room);
}

std::string Scene::ownerName(std::uint32_t owner) const {
  if (owner == 0) return "";
  const std::size_t i = owner - 1;
  if (i < plan_.furniture.size()) return plan_.furniture[i].name;
  const std::size_t thing = i - plan_.furniture.size();
  return thing < params_.things.size() ? params_.things[thing].name : "";
}

}  // namespace hyselam_sim
