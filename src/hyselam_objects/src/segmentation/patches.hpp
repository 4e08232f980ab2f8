// Smooth patches of a frame: where the normals turn slowly.
#pragma once

#include <vector>

#include "surface_grid.hpp"

namespace hyselam_objects {

class Patches {
 public:
  static constexpr int kNone = -1;

  /// Patches of the pixels marked in `above`. All arguments must outlive this.
  Patches(const SurfaceGrid& grid, const std::vector<bool>& above, const SegmentParams& params);

  struct Patch {
    int size = 0;
    float bend = 0.0f;  ///< mean turn of the normals over some pixels [rad]; < 0: hollow
  };

  std::size_t count() const { return patches_; }
  /// The patch of a pixel, or kNone.
  int operator[](std::size_t i) const { return patch_[i]; }
  const std::vector<int>& all() const { return patch_; }
  const Patch& patch(int number) const { return patch_of_[static_cast<std::size_t>(number)]; }
  /// The pixel some steps further in the direction, at most to the end of the patch.
  std::size_t innerPixel(std::size_t i, int dx, int dy) const;

 private:
  bool isSmooth(std::size_t i) const;
  bool isContinuous(std::size_t i, std::size_t j) const;
  void growPatches();
  void assignEdgePixels();
  void growRoughPatches(const std::vector<std::size_t>& pixels);
  void measurePatches();

  const SurfaceGrid& grid_;
  const std::vector<bool>& above_;
  const SegmentParams& params_;
  std::vector<int> patch_;
  std::size_t patches_ = 0;
  std::vector<Patch> patch_of_;  ///< by number
};

}  // namespace hyselam_objects
