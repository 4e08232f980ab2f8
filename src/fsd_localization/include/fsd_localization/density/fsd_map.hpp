// A map prepared for localisation by free-space density: for every cell and kernel, density and
// direction of descent in two bytes, so that looking up a particle touches one cache line.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fsd_localization/density/density_field.hpp"

namespace fsd_localization {

struct FsdMapParams {
  std::vector<KernelSpec> kernels = {{KernelProfile::kUniform, 1.5},
                                     {KernelProfile::kUniform, 3.0},
                                     {KernelProfile::kUniform, 5.0}};
  OccupancyThresholds thresholds;
  GradientParams gradient;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError naming the first value out of range (1..8 kernels).
  void validate() const;
};

/// Cell layout: byte 2 k holds the density of kernel k, byte 2 k + 1 its descent direction; padded
/// to 8 (up to 4 kernels) or 16 bytes.
class FsdMap {
 public:
  static constexpr std::uint8_t kNotFree = 255;     ///< density byte of a cell that is not free
  static constexpr std::uint8_t kMaxDensity = 254;  ///< density 1
  static constexpr std::uint8_t kStable = 0x80;  ///< set in the direction byte where there is one

  /// Computes all fields. @param threads, progress as in densityField().
  /// @throws hyselam::InputError, hyselam::ParameterError.
  FsdMap(const hyselam::OccupancyGrid& map, const FsdMapParams& params, int threads = 0,
         const std::function<void(double)>& progress = {});

  /// As the constructor, but looks for the result in `cache_path` first and leaves it there after
  /// (atomically). A cache made from another map or other parameters, or a damaged one, is made
  /// anew; `*from_cache` is set accordingly. A cache that cannot be written is no error, but the
  /// next start takes as long again: `*problem` is the reason then, otherwise empty.
  static FsdMap cached(const std::string& cache_path, const hyselam::OccupancyGrid& map,
                       const FsdMapParams& params, int threads = 0,
                       const std::function<void(double)>& progress = {}, bool* from_cache = nullptr,
                       std::string* problem = nullptr);

  const hyselam::GridGeometry& geometry() const { return geometry_; }
  const FsdMapParams& params() const { return params_; }
  int kernelCount() const { return static_cast<int>(params_.kernels.size()); }
  int cellStride() const { return stride_; }
  const std::uint8_t* data() const { return cells_.data(); }
  std::size_t bytes() const { return cells_.size(); }

  bool isFree(hyselam::Cell c) const { return geometry_.contains(c) && cell(c)[0] != kNotFree; }
  /// Density of a free cell, to 1/508.
  double density(hyselam::Cell c, int kernel) const { return cell(c)[2 * kernel] / 254.0; }
  /// Direction in which the density falls, in the grid's axes, to 1.4 degrees; empty if unstable.
  std::optional<double> descent(hyselam::Cell c, int kernel) const;
  /// Row-major indices of all free cells, ascending.
  const std::vector<std::uint32_t>& freeCells() const { return free_cells_; }

  /// FNV-1a over the map's cells, geometry and the parameters: what a cache must agree with.
  static std::uint64_t fingerprint(const hyselam::OccupancyGrid& map, const FsdMapParams& params);

 private:
  FsdMap() = default;
  void allocate(const hyselam::OccupancyGrid& map, const FsdMapParams& params);
  void listFreeCells();
  /// False, with any cells, where the file is missing, damaged or of another map.
  bool readCells(const std::string& cache_path, std::uint64_t key);
  /// @throws hyselam::InputError
  void writeCells(const std::string& cache_path, std::uint64_t key) const;
  const std::uint8_t* cell(hyselam::Cell c) const {
    return &cells_[geometry_.index(c) * static_cast<std::size_t>(stride_)];
  }

  hyselam::GridGeometry geometry_;
  FsdMapParams params_;
  int stride_ = 8;
  std::vector<std::uint8_t> cells_;
  std::vector<std::uint32_t> free_cells_;
};

/// Seven bits for a full turn, as in the direction bytes.
inline std::uint8_t directionByte(double angle) {
  return static_cast<std::uint8_t>(std::lround(angle / (2.0 * hyselam::kPi) * 128.0) & 0x7F);
}

}  // namespace fsd_localization
