// Kernel profiles for density estimates on grids: Maffei 2017, 2.2, Eq. 2.14 to 2.16.
#pragma once

#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

enum class KernelProfile { kUniform, kGaussian, kInverted };

/// "uniform", "gaussian", "inverted". @throws hyselam::ParameterError for any other name.
KernelProfile kernelProfileFromString(const std::string& name);
const char* toString(KernelProfile profile);

/// Which kernel, in metres, as in parameter files.
struct KernelSpec {
  KernelProfile profile = KernelProfile::kUniform;
  double bandwidth = 3.0;  ///< radius h [m], > 0
};

/// Describes `kernel`, the profile of all, and `bandwidths`, one kernel each (1 to 8).
void describeKernels(hyselam::ParameterVisitor& visit, std::vector<KernelSpec>& kernels);
/// @throws hyselam::ParameterError unless there are 1 to 8 kernels with finite bandwidths > 0.
void checkKernels(const std::vector<KernelSpec>& kernels);

/// A circular kernel on the cells of a grid.
///
/// Covers the cells whose centre lies closer than `radius` cells to the nucleus (d < h). Whatever
/// the profile, the weights sum to 1 over the covered cells, so a fully free disc has density
/// exactly 1.
class Kernel {
 public:
  static constexpr int kMaxRadius = 127;  ///< [cells]; limit of the flood fill's bit rows

  /// @param radius bandwidth h in cells, 1..kMaxRadius. @throws hyselam::ParameterError outside.
  Kernel(KernelProfile profile, int radius);
  /// The kernel of a specification on a grid: the bandwidth rounded to whole cells.
  Kernel(const KernelSpec& spec, double resolution);

  KernelProfile profile() const { return profile_; }
  int radius() const { return radius_; }
  /// Weight of the cell at offset (dx, dy) from the nucleus; 0 outside the disc.
  double weight(int dx, int dy) const;
  /// Number of cells covered.
  int cellCount() const { return cell_count_; }

 private:
  KernelProfile profile_;
  int radius_;
  int cell_count_ = 0;
  std::vector<double> weight_by_squared_distance_;  // index dx^2 + dy^2 < radius^2
};

}  // namespace fsd_localization
