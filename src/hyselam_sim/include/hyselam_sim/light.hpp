// How much light falls where: daylight through windows by the hour, lamps under the ceiling.
#pragma once

#include <array>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_sim/floor_regions.hpp"
#include "hyselam_sim/geometry.hpp"
#include "hyselam_sim/plan_ray_caster.hpp"

namespace hyselam_sim {

/// A source of daylight: the middle of a window, the direction it shines to, its area.
struct Window {
  Point2 at;
  Point2 inwards;     ///< unit vector
  double area = 1.0;  ///< [m^2]
};

struct LightParams {
  double hour = 12.0;   ///< of the day, 0 .. 24
  double clouds = 0.3;  ///< 0: clear sky .. 1: no direct sun
  enum class Lamps { kByHour, kOn, kOff };
  Lamps lamps = Lamps::kByHour;  ///< kByHour: before 8, after 17, and in rooms without daylight

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// The sky at an hour. y points north; the sun rises in the east at 6 and sets at 18.
struct Sky {
  explicit Sky(const LightParams& params);
  /// What a window that shines in that direction passes on, by colour; a bright noon gives about 1.
  std::array<float, 3> through(Point2 inwards) const;
  std::array<float, 3> diffuse;  ///< from everywhere
  std::array<float, 3> sun;      ///< from the sun's side
  Point2 to_sun;                 ///< level unit vector
  bool lamps = false;            ///< on everywhere
  bool lamps_in_dark = false;    ///< on where daylight does not reach
};

/// Light at points of the floor, for any hour. Immutable after construction.
class LightMap {
 public:
  /// `walls`: what stops light; `resolution` [m], > 0.
  LightMap(const FloorRegions& regions, const PlanRayCaster& walls,
           const std::vector<Window>& windows, double ceiling, double resolution = 0.25);

  /// Light by colour at a point; about 1 in a well-lit room by day.
  std::array<float, 3> at(Point2 p, const Sky& sky) const;
  /// Whether the lamps over a point shine.
  bool lampsShine(Point2 p, const Sky& sky) const;
  /// Where the lamps hang.
  const std::vector<Point2>& lamps() const { return lamps_; }

 private:
  static constexpr int kSides = 4;  ///< windows that shine east, north, west, south
  hyselam::GridGeometry geometry_;
  std::vector<std::array<float, kSides + 1>> cells_;  ///< share of each side's windows, lamps
  std::vector<bool> dark_;                            ///< cells of rooms without daylight
  std::vector<Point2> lamps_;
};

}  // namespace hyselam_sim
