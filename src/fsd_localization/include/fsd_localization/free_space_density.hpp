// Free-space density of one cell (thesis 3.2.2, Alg. 3.1) and the frontiers of its free space (6.3,
// Alg. 6.1), by a flood that handles a whole row of cells at once.
#pragma once

#include <limits>
#include <memory>
#include <optional>

#include "fsd_localization/bit_plane.hpp"
#include "fsd_localization/kernel.hpp"
#include "hyselam_common/occupancy_grid.hpp"

namespace fsd_localization {

/// What the free space around one cell looks like through one kernel. Densities lie in [0, 1].
struct Density {
  /// Psi: kernel sum over the free cells connected to the centre within the disc; unknown cells
  /// stop the flood. 0 where the centre is not free.
  double soft = 0.0;
  /// What Psi would be if every unknown cell were free. soft <= true density <= upper.
  double upper = 0.0;
  /// Psi-diamond: equals soft where no unknown cell touches the flooded region, else empty.
  std::optional<double> hard;
};

/// Computes densities through one kernel. Cheap to call, not to construct; const calls may run in
/// several threads at once.
class FreeSpaceDensity {
 public:
  explicit FreeSpaceDensity(const Kernel& kernel);
  ~FreeSpaceDensity();
  FreeSpaceDensity(FreeSpaceDensity&&) noexcept;
  FreeSpaceDensity& operator=(FreeSpaceDensity&&) noexcept;

  const Kernel& kernel() const;

  /// Psi alone, the quickest question: what a density field needs of a map.
  double soft(const FreeSpace& space, hyselam::Cell centre) const;
  /// Psi, its upper bound and Psi-diamond.
  Density density(const FreeSpace& space, hyselam::Cell centre) const;
  /// Number of frontiers of free space: 8-connected groups of reachable free cells just outside the
  /// kernel (d >= h, beside a flooded cell) with more than `min_share` of the kernel's perimeter.
  /// The rim of a digital disc is joined diagonally, hence 8-connected.
  int frontiers(const FreeSpace& space, hyselam::Cell centre, double min_share = 0.05) const;

 private:
  class Flood;
  template <int W>
  class WideFlood;
  std::unique_ptr<Flood> flood_;
};

}  // namespace fsd_localization
