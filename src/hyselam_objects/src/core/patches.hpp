// Smooth patches of a frame: where the normals turn slowly.
#pragma once

#include <vector>

#include "surface_grid.hpp"

namespace hyselam_objects {

class Patches {
 public:
  static constexpr int kNone = -1;

  /// Patches of the pixels that are marked in `above`. All must outlive this.
  Patches(const SurfaceGrid& grid, const std::vector<bool>& above, const SegmentParams& params);

  struct Patch {
    int size = 0;
    float bend = 0.0f;  // mean turn of the normals over some pixels [rad]; < 0: hollow
  };

  std::size_t count() const { return patches_; }
  /// Of a pixel; kNone: it is in none.
  int operator[](std::size_t i) const { return patch_[i]; }
  const std::vector<int>& all() const { return patch_; }
  const Patch& patch(int number) const { return patch_of_[static_cast<std::size_t>(number)]; }
  /// The pixel some steps further in the direction, as long as the patch goes on.
  std::size_t inside(std::size_t i, int dx, int dy) const;

 private:
  bool isSmooth(std::size_t i) const;
  bool continues(std::size_t i, std::size_t j) const;
  void grow();
  void fill();
  void measure();

  const SurfaceGrid& grid_;
  const std::vector<bool>& above_;
  const SegmentParams& params_;
  std::vector<int> patch_;
  std::size_t patches_ = 0;
  std::vector<Patch> patch_of_;  ///< by number
};

}  // namespace hyselam_objects
