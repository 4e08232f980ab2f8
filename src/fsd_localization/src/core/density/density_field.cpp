#include "fsd_localization/density/density_field.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

FreeSpaceGrid freeSpaceOf(const hyselam::OccupancyGrid& map,
                          const OccupancyThresholds& thresholds) {
  const auto& g = map.geometry;
  if (g.width <= 0 || g.height <= 0 || map.cells.size() != g.cellCount()) {
    throw hyselam::InputError("map", "size", "cell count does not fit width x height, or no cells");
  }
  FreeSpaceGrid space(g.width, g.height);
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      const int v = map.at({x, y});
      if (thresholds.isFree(v)) {
        space.free.set(x, y, true);
      } else if (!thresholds.isOccupied(v)) {
        space.unknown.set(x, y, true);
      }
    }
  }
  return space;
}

DensityField densityField(const FreeSpaceGrid& space, const Kernel& kernel, int threads,
                          const std::function<void(double)>& progress) {
  DensityField field;
  field.width = space.free.width();
  field.height = space.free.height();
  field.values.assign(
      static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height), 0.0F);
  const FreeSpaceDensity density(kernel);

  std::atomic<int> next_row{0};
  const auto work = [&](bool report) {
    for (int y = next_row++; y < field.height; y = next_row++) {
      float* row =
          &field.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(field.width)];
      for (int x = 0; x < field.width; ++x) {
        if (space.free.get(x, y)) row[x] = static_cast<float>(density.soft(space, {x, y}));
      }
      if (report && progress) progress(static_cast<double>(y + 1) / field.height);
    }
  };
  const int count =
      threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::vector<std::thread> helpers;
  for (int i = 1; i < count; ++i) helpers.emplace_back(work, false);
  work(true);
  for (std::thread& t : helpers) t.join();
  return field;
}

void GradientParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("max_spread", max_direction_spread, Range::aboveUpTo(0.0, hyselam::kPi), "rad",
        "a gradient whose neighbors differ by more has no direction");
  visit("min_slope", min_slope, Range::atLeast(0.0), "1/m", "nor has one of a flatter field");
}

void GradientParams::validate() const {
  hyselam::checkParameters(*this);
  if (!std::isfinite(min_slope)) {
    throw hyselam::ParameterError("gradient_min_slope", min_slope, "finite");
  }
}

std::optional<double> stableDescent(const float* patch, int row_stride, double resolution,
                                    const GradientParams& params) {
  // Sobel sums weigh the change over two cells with 4 on either side: 8 cells' worth of slope.
  const double floor = 8.0 * resolution * params.min_slope;
  const float floor2 = static_cast<float>(floor * floor);
  const float cos_spread = static_cast<float>(std::cos(params.max_direction_spread));
  float cx = 0.0F, cy = 0.0F;
  const auto sobel = [&](int x, int y, float& gx, float& gy) {
    const float* below = patch + (y - 1) * row_stride + x;
    const float* mid = below + row_stride;
    const float* above = mid + row_stride;
    gx = above[1] + 2.0F * mid[1] + below[1] - above[-1] - 2.0F * mid[-1] - below[-1];
    gy = above[-1] + 2.0F * above[0] + above[1] - below[-1] - 2.0F * below[0] - below[1];
  };
  sobel(2, 2, cx, cy);
  const float c2 = cx * cx + cy * cy;
  if (!(c2 > floor2) || c2 == 0.0F) return std::nullopt;
  for (int y = 1; y <= 3; ++y) {
    for (int x = 1; x <= 3; ++x) {
      if (x == 2 && y == 2) continue;
      float gx = 0.0F, gy = 0.0F;
      sobel(x, y, gx, gy);
      const float g2 = gx * gx + gy * gy;
      if (!(g2 > floor2) || gx * cx + gy * cy < cos_spread * std::sqrt(g2 * c2)) {
        return std::nullopt;
      }
    }
  }
  return std::atan2(static_cast<double>(-cy), static_cast<double>(-cx));
}

}  // namespace fsd_localization
