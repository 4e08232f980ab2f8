#include "fsd_localization/density/free_space_density.hpp"

#include "row_flood.hpp"

namespace fsd_localization {

FreeSpaceDensity::FreeSpaceDensity(const Kernel& kernel) {
  const int bits = 2 * kernel.radius() + 2;
  if (bits <= 64) {
    flood_ = std::make_unique<RowFlood<1>>(kernel);
  } else if (bits <= 128) {
    flood_ = std::make_unique<RowFlood<2>>(kernel);
  } else if (bits <= 192) {
    flood_ = std::make_unique<RowFlood<3>>(kernel);
  } else {
    flood_ = std::make_unique<RowFlood<4>>(kernel);
  }
}
FreeSpaceDensity::~FreeSpaceDensity() = default;
FreeSpaceDensity::FreeSpaceDensity(FreeSpaceDensity&&) noexcept = default;
FreeSpaceDensity& FreeSpaceDensity::operator=(FreeSpaceDensity&&) noexcept = default;

const Kernel& FreeSpaceDensity::kernel() const {
  return flood_->kernel;
}
double FreeSpaceDensity::soft(const FreeSpaceGrid& space, Cell center) const {
  return flood_->soft(space, center);
}
Density FreeSpaceDensity::density(const FreeSpaceGrid& space, Cell center) const {
  return flood_->density(space, center);
}

}  // namespace fsd_localization
