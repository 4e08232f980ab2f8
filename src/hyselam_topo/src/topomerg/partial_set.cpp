#include "partial_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hyselam_topo::merging {
namespace {

/// For rounding errors of the interval's ends [rad].
constexpr double kSlackMargin = 1e-12;

}  // namespace

void keepReachable(const MatchProblem& problem, PartialSet& partial) {
  PlaceSet reached, front = partial.has.neighbors & partial.open;
  while (!front.empty()) {
    reached |= front;
    PlaceSet next;
    front.forEach([&](std::size_t v) { next |= problem.neighbors[v]; });
    front = (next & partial.open) - reached;
  }
  partial.open = reached;
}

void boundCenter(const MatchProblem& problem, PartialSet& partial) {
  if (!partial.has.hasCenter()) {
    partial.radius = std::numeric_limits<double>::infinity();
    return;
  }
  const double x = partial.has.x(), y = partial.has.y();
  // How far the center can move along each axis: vertices are added while they pull it on.
  struct Pull {
    double offset, weight;
  };
  std::array<Pull, PlaceSet::kCapacity> pulls;
  const auto farthest = [&](double dx, double dy) {
    std::size_t count = 0;
    partial.open.forEach([&](std::size_t v) {
      const double offset = dx * (problem.x[v] - x) + dy * (problem.y[v] - y);
      if (offset > 0.0 && problem.weight[v] > 0.0) pulls[count++] = {offset, problem.weight[v]};
    });
    std::sort(pulls.begin(), pulls.begin() + static_cast<std::ptrdiff_t>(count),
              [](const Pull& a, const Pull& b) { return a.offset > b.offset; });
    double moment = 0.0, weight = partial.has.weight;
    for (std::size_t k = 0; k < count && pulls[k].offset * weight > moment; ++k) {
      moment += pulls[k].offset * pulls[k].weight;
      weight += pulls[k].weight;
    }
    return moment / weight;
  };
  const double east = farthest(1, 0), west = farthest(-1, 0);
  const double north = farthest(0, 1), south = farthest(0, -1);
  partial.x = x + 0.5 * (east - west);
  partial.y = y + 0.5 * (north - south);
  partial.radius = std::hypot(0.5 * (east + west), 0.5 * (north + south)) * (1.0 + 1e-12);
}

BearingInterval bearingTo(double from_x, double from_y, const PartialSet& partial) {
  const double dx = partial.x - from_x, dy = partial.y - from_y;
  const double d = std::hypot(dx, dy);
  BearingInterval seen;
  if (!(partial.radius < d)) return seen;
  seen.bearing = std::atan2(dy, dx);
  seen.slack = partial.radius > 0.0 ? std::asin(partial.radius / d) + kSlackMargin : 0.0;
  return seen;
}

}  // namespace hyselam_topo::merging
