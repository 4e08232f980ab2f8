// The building as a camera sees it: upright prisms with surfaces, made from a floor plan.
//
// Plans say where walls, doors and furniture are, not what they look like. Paint, floors, windows,
// posters and the style of furniture follow from the seed and the names, so that a plan always
// looks the same and its rooms look different from each other.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_sim/floor_plan.hpp"
#include "hyselam_sim/floor_regions.hpp"
#include "hyselam_sim/light.hpp"
#include "hyselam_sim/route.hpp"

namespace hyselam_sim {

/// Linear red, green, blue.
using Color = std::array<float, 3>;

enum class Material {
  kPaint,     ///< even, with a skirting board where a wall meets the floor
  kBrick,     ///< courses of bricks
  kTiles,     ///< square tiles with joints
  kWood,      ///< grain along the surface
  kCarpet,    ///< speckled
  kCupboard,  ///< doors with handles
  kShelf,     ///< boards with coloured backs of books or boxes
  kPoster,    ///< a picture made of coloured patches
  kWindow,    ///< shines by daylight
  kLamp,      ///< shines if lamps are on
  kPlain      ///< one colour
};

struct Surface {
  Material material = Material::kPlain;
  Color color{0.5f, 0.5f, 0.5f};  ///< share of the light that it throws back, 0 .. 1
  std::uint32_t seed = 0;         ///< of its pattern
};

/// An upright prism.
struct Body {
  Polygon outline;    ///< convex, in the plan frame
  double from = 0.0;  ///< height of its underside above the floor [m]
  double to = 1.0;    ///< of its top [m]
  Surface side;
  Surface top;
  /// Who it belongs to: 0 the building, 1 + i furniture i of the plan, then things, then people.
  std::uint32_t owner = 0;
  bool painted = false;  ///< its sides wear the paint of the room in front of them
};

/// A small thing that can be carried.
struct Thing {
  enum class Shape { kBox, kCylinder };
  std::string name;  ///< unique
  std::string kind;  ///< what people call it: "cup"
  Shape shape = Shape::kBox;
  Pose2 pose;                                 ///< of its middle, plan frame
  double z = 0.0;                             ///< height of its underside above the floor [m]
  std::array<double, 3> size{0.1, 0.1, 0.1};  ///< length, width, height [m]; of a cylinder the
                                              ///< length is the diameter
  Color color{0.8f, 0.1f, 0.1f};
};

struct SceneParams {
  std::uint64_t seed = 1;     ///< of paint, windows and posters
  double door_height = 2.05;  ///< [m]
  double window_share = 0.7;  ///< of the spots at outer walls that could have a window, 0 .. 1
  double poster_share = 0.5;  ///< the same for posters at all walls
  std::vector<Thing> things;

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Everything that does not move, with its light. Immutable after construction; all queries may run
/// concurrently.
class Scene {
 public:
  /// @throws hyselam::InputError for a plan that rasterize() refuses, hyselam::ParameterError for a
  /// parameter out of range.
  explicit Scene(const FloorPlan& plan, const SceneParams& params = {});

  const FloorPlan& plan() const { return plan_; }
  const FloorRegions& regions() const { return regions_; }
  const LightMap& light() const { return light_; }
  double ceiling() const { return ceiling_; }  ///< its height [m]

  /// Walls, lintels, windows, posters, furniture, things: what stands still.
  const std::vector<Body>& bodies() const { return bodies_; }
  /// Door leaves at that time [s].
  std::vector<Body> doors(double time) const;
  /// People at that time, who make room for a robot at `robot`.
  std::vector<Body> people(const std::vector<Person>& people, double time, Point2 robot) const;

  const Surface& floor(int room) const;
  const Surface& ceilingSurface(int room) const;
  /// Paint of the walls of a room.
  const Surface& paint(int room) const;

  /// Name of the owner in Body::owner; "" for the building and unknown ones.
  std::string ownerName(std::uint32_t owner) const;

 private:
  FloorPlan plan_;
  SceneParams params_;
  FloorRegions regions_;
  double ceiling_;
  std::vector<Surface> floors_, ceilings_, paints_;  ///< by room, one more for outside
  std::vector<Body> bodies_;
  LightMap light_;
};

}  // namespace hyselam_sim
