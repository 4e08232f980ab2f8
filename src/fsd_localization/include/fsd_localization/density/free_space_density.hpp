// Free-space density (FSD) of one cell: the kernel-weighted share of the cells around it that are
// free and connected with it (Maffei 2017, 3.2.2, Alg. 3.1). The flood fill handles a whole row of
// cells at once.
#pragma once

#include <limits>
#include <memory>
#include <optional>

#include "fsd_localization/density/bit_plane.hpp"
#include "fsd_localization/density/kernel.hpp"
#include "hyselam_common/occupancy_grid.hpp"

namespace fsd_localization {

/// The density of one kernel at one cell, 0..1, with bounds where cells are unknown.
struct Density {
  /// Psi: kernel sum over the free cells connected to the center within the disc; unknown cells
  /// stop the flood fill. 0 where the center is not free.
  double soft = 0.0;
  /// What Psi would be if every unknown cell were free. soft <= true density <= upper.
  double upper = 0.0;
  /// Psi-diamond: equals soft where no unknown cell touches the filled region, else empty.
  std::optional<double> hard;
};

/// Computes densities with one kernel. Cheap to call, expensive to construct; const calls may run
/// in several threads at once.
class FreeSpaceDensity {
 public:
  explicit FreeSpaceDensity(const Kernel& kernel);
  ~FreeSpaceDensity();
  FreeSpaceDensity(FreeSpaceDensity&&) noexcept;
  FreeSpaceDensity& operator=(FreeSpaceDensity&&) noexcept;

  const Kernel& kernel() const;

  /// Psi only (fastest); sufficient for the density of every map cell.
  double soft(const FreeSpaceGrid& space, hyselam::Cell center) const;
  /// Psi, its upper bound and Psi-diamond.
  Density density(const FreeSpaceGrid& space, hyselam::Cell center) const;

 private:
  class Flood;
  template <int W>  // 64-bit words per row of cells
  class RowFlood;
  // Number of contiguous groups of free cells just outside the kernel, each with more than the
  // fraction `min_share` of the kernel's perimeter; see frontier_count.hpp.
  friend int frontierCount(const FreeSpaceDensity& density, const FreeSpaceGrid& space,
                           hyselam::Cell center, double min_share);
  std::unique_ptr<Flood> flood_;
};

}  // namespace fsd_localization
