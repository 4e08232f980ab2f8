#include "hyselam_sim/light.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hyselam_sim {
namespace {

using hyselam::Cell;

constexpr double kLampSpacing = 2.5;   // [m]
constexpr double kLampPower = 2.6;     // light 1 m below a lamp
constexpr double kWindowPower = 0.55;  // light 1 m before 1 m^2 of window
constexpr double kBounced = 0.45;      // of a room's mean light that reaches every corner
constexpr double kReach = 14.0;        // [m]
constexpr double kDark = 0.03;         // mean share of the windows' light in a dark room
constexpr std::array<float, 3> kLampColor{1.0f, 0.82f, 0.6f};

int sideOf(Point2 inwards) {
  if (std::abs(inwards.x) >= std::abs(inwards.y)) return inwards.x > 0.0 ? 0 : 2;
  return inwards.y > 0.0 ? 1 : 3;
}

Point2 directionOf(int side) {
  constexpr std::array<Point2, 4> directions{Point2{1, 0}, Point2{0, 1}, Point2{-1, 0},
                                             Point2{0, -1}};
  return directions[static_cast<std::size_t>(side)];
}

bool sees(const PlanRayCaster& walls, Point2 from, Point2 to) {
  const Point2 way = to - from;
  const double d = length(way);
  return d < 1e-9 || walls.cast(from, (1.0 / d) * way, d) >= d - 0.02;
}

}  // namespace

void LightParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("hour", hour, Range::any(), "", "of the day, 0 .. 24");
  visit("clouds", clouds, Range::any(), "", "0: clear sky .. 1: no direct sun");
  visit("lamps", lamps, {{"by_hour", Lamps::kByHour}, {"on", Lamps::kOn}, {"off", Lamps::kOff}},
        "by_hour: before 8, after 17, and in rooms without daylight");
}

void LightParams::validate() const {
  hyselam::checkParameters(*this);
}

Sky::Sky(const LightParams& params)
    : lamps(params.lamps == LightParams::Lamps::kOn ||
            (params.lamps == LightParams::Lamps::kByHour &&
             (params.hour < 8.0 || params.hour >= 17.0))),
      lamps_in_dark(params.lamps != LightParams::Lamps::kOff) {
  const double day = (params.hour - 6.0) / 12.0;  // 0 at sunrise, 1 at sunset
  const double height = std::sin(hyselam::kPi * day);
  const double up = std::clamp(height + 0.08, 0.0, 1.0);
  const double bright = 0.006 + 0.9 * std::pow(up, 0.6);
  const double low = std::clamp(1.0 - 2.5 * height, 0.0, 1.0);  // red mornings and evenings
  const auto gray = static_cast<float>(bright * (0.55 + 0.25 * params.clouds));
  diffuse = {gray * 0.92f, gray * 0.97f, gray * 1.08f};
  if (height <= -0.08) diffuse = {0.25f * gray, 0.32f * gray, 0.6f * gray};
  const auto beam = static_cast<float>(1.5 * std::max(0.0, height) * (1.0 - params.clouds));
  const auto red = static_cast<float>(low);
  sun = {beam, beam * (0.96f - 0.25f * red), beam * (0.88f - 0.5f * red)};
  const double azimuth = hyselam::kPi * day;  // east, south, west
  to_sun = {std::cos(azimuth), -std::sin(azimuth)};
}

std::array<float, 3> Sky::through(Point2 inwards) const {
  const auto facing = static_cast<float>(std::max(0.0, -dot(inwards, to_sun)));
  std::array<float, 3> out{};
  for (std::size_t c = 0; c < 3; ++c) out[c] = diffuse[c] + facing * sun[c];
  return out;
}

namespace {

/// Lamps: a lattice over the floor, one at least in each room.
std::vector<Point2> placeLamps(const FloorRegions& regions, const PlanRayCaster& walls,
                               const hyselam::GridGeometry& geometry) {
  std::vector<Point2> lamps;
  std::vector<bool> lit(static_cast<std::size_t>(regions.rooms()), false);
  const double width = geometry.width * geometry.resolution;
  const double height = geometry.height * geometry.resolution;
  const auto hang = [&](Point2 p) {
    lamps.push_back(p);
    lit[static_cast<std::size_t>(regions.roomAt(p))] = true;
  };
  for (int row = 0; (row + 0.5) * kLampSpacing < height; ++row) {
    for (int col = 0; (col + 0.5) * kLampSpacing < width; ++col) {
      const Point2 p = regions.geometry().origin *
                       Point2{(col + 0.5) * kLampSpacing, (row + 0.5) * kLampSpacing};
      if (regions.onFloor(p) && sees(walls, p, p + Point2{0.4, 0.0}) &&
          sees(walls, p, p - Point2{0.4, 0.0})) {
        hang(p);
      }
    }
  }
  for (int y = 0; y < geometry.height; ++y) {
    for (int x = 0; x < geometry.width; ++x) {
      const Point2 p = geometry.center({x, y});
      if (regions.onFloor(p) && !lit[static_cast<std::size_t>(regions.roomAt(p))]) hang(p);
    }
  }
  return lamps;
}

}  // namespace

LightMap::LightMap(const FloorRegions& regions, const PlanRayCaster& walls,
                   const std::vector<Window>& windows, double ceiling, double resolution) {
  const hyselam::GridGeometry& fine = regions.geometry();
  geometry_ = fine;
  geometry_.resolution = resolution;
  geometry_.width = static_cast<int>(std::ceil(fine.width * fine.resolution / resolution));
  geometry_.height = static_cast<int>(std::ceil(fine.height * fine.resolution / resolution));
  cells_.assign(geometry_.cellCount(), {});
  lamps_ = placeLamps(regions, walls, geometry_);

  struct Mean {
    std::array<double, kSides + 1> sum{};
    double cells = 0.0;
  };
  std::vector<Mean> means(static_cast<std::size_t>(regions.rooms()));
  for (int y = 0; y < geometry_.height; ++y) {
    for (int x = 0; x < geometry_.width; ++x) {
      const Point2 p = geometry_.center({x, y});
      if (!regions.onFloor(p)) continue;
      auto& cell = cells_[geometry_.index({x, y})];
      for (const Window& window : windows) {
        const Point2 way = p - window.at;
        const double d = length(way);
        const double facing = d > 0.0 ? dot(window.inwards, way) / d : 1.0;
        if (d > kReach || facing <= 0.0) continue;
        if (!sees(walls, p, window.at + 0.05 * window.inwards)) continue;
        cell[static_cast<std::size_t>(sideOf(window.inwards))] += static_cast<float>(
            kWindowPower * window.area * (0.3 + 0.7 * facing) / (0.6 + 0.35 * d * d));
      }
      for (const Point2& lamp : lamps_) {
        const Point2 way = p - lamp;
        const double d2 = dot(way, way);
        if (d2 > 36.0 || !sees(walls, p, lamp)) continue;
        const double h = std::max(0.5, ceiling - 0.8);
        cell[kSides] += static_cast<float>(0.5 * kLampPower / (1.0 + d2 + h * h));
      }
      Mean& mean = means[static_cast<std::size_t>(regions.roomAt(p))];
      for (std::size_t i = 0; i < cell.size(); ++i) mean.sum[i] += static_cast<double>(cell[i]);
      mean.cells += 1.0;
    }
  }
  dark_.assign(geometry_.cellCount(), false);
  for (int y = 0; y < geometry_.height; ++y) {
    for (int x = 0; x < geometry_.width; ++x) {
      const int room = regions.roomAt(geometry_.center({x, y}));
      if (room < 0) continue;
      const Mean& mean = means[static_cast<std::size_t>(room)];
      auto& cell = cells_[geometry_.index({x, y})];
      for (std::size_t i = 0; i < cell.size(); ++i) {
        cell[i] += static_cast<float>(kBounced * mean.sum[i] / std::max(1.0, mean.cells));
      }
      const double daylight = std::accumulate(mean.sum.begin(), mean.sum.end() - 1, 0.0);
      dark_[geometry_.index({x, y})] = daylight < kDark * mean.cells;
    }
  }
}

bool LightMap::lampsShine(Point2 p, const Sky& sky) const {
  const Cell c = geometry_.cellAt(p);
  return sky.lamps || (sky.lamps_in_dark && geometry_.contains(c) && dark_[geometry_.index(c)]);
}

std::array<float, 3> LightMap::at(Point2 p, const Sky& sky) const {
  // Bilinear between the centres of cells.
  const Point2 local = geometry_.origin.inverse() * p;
  const double gx = std::clamp(local.x / geometry_.resolution - 0.5, 0.0,
                               static_cast<double>(geometry_.width - 1));
  const double gy = std::clamp(local.y / geometry_.resolution - 0.5, 0.0,
                               static_cast<double>(geometry_.height - 1));
  const int x = static_cast<int>(gx), y = static_cast<int>(gy);
  const auto fx = static_cast<float>(gx - x), fy = static_cast<float>(gy - y);
  std::array<float, kSides + 1> share{};
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const Cell c{std::min(x + dx, geometry_.width - 1), std::min(y + dy, geometry_.height - 1)};
      const float weight = (dx ? fx : 1.0f - fx) * (dy ? fy : 1.0f - fy);
      const auto& cell = cells_[geometry_.index(c)];
      for (std::size_t i = 0; i < share.size(); ++i) share[i] += weight * cell[i];
    }
  }
  std::array<float, 3> out{};
  for (int side = 0; side < kSides; ++side) {
    const std::array<float, 3> passed = sky.through(directionOf(side));
    for (std::size_t c = 0; c < 3; ++c) out[c] += share[static_cast<std::size_t>(side)] * passed[c];
  }
  if (lampsShine(p, sky)) {
    for (std::size_t c = 0; c < 3; ++c) out[c] += share[kSides] * kLampColor[c];
  }
  return out;
}

}  // namespace hyselam_sim
