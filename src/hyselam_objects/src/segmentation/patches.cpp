#include "patches.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

namespace hyselam_objects {

Patches::Patches(const SurfaceGrid& grid, const std::vector<bool>& above,
                 const SegmentParams& params)
    : grid_(grid), above_(above), params_(params), patch_(grid.size(), kNone) {
  growPatches();
  assignEdgePixels();
  measurePatches();
}

bool Patches::isSmooth(std::size_t i) const {
  return above_[i] && grid_.hasNormal(i) &&
         grid_.variation(i) < static_cast<float>(params_.max_surface_variation);
}

bool Patches::isContinuous(std::size_t i, std::size_t j) const {
  const auto turn = static_cast<float>(std::cos(params_.max_smooth_angle));
  const Point step = grid_.point(j) - grid_.point(i);
  return grid_.normal(i).dot(grid_.normal(j)) > turn &&
         std::abs(grid_.normal(i).dot(step)) < 3.0f * grid_.sigma(i) + 0.002f;
}

void Patches::growPatches() {
  std::vector<std::size_t> seeds;
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    if (isSmooth(i)) seeds.push_back(i);
  }
  std::stable_sort(seeds.begin(), seeds.end(), [this](std::size_t a, std::size_t b) {
    return grid_.variation(a) < grid_.variation(b);
  });
  std::deque<std::size_t> front;
  for (const std::size_t seed : seeds) {
    if (patch_[seed] != kNone) continue;
    const int patch = static_cast<int>(patches_++);
    patch_[seed] = patch;
    front.push_back(seed);
    while (!front.empty()) {
      const std::size_t i = front.front();
      front.pop_front();
      grid_.forNeighbors(i, [&](std::size_t j) {
        if (patch_[j] != kNone || !isSmooth(j) || !isContinuous(i, j)) return;
        patch_[j] = patch;
        front.push_back(j);
      });
    }
  }
}

// Pixels at edges belong to the neighboring patch whose surface they are nearest to.
void Patches::assignEdgePixels() {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    if (above_[i] && patch_[i] == kNone) open.push_back(i);
  }
  for (int round = 0; round < 2 * params_.normal_window + 2 && !open.empty(); ++round) {
    std::vector<std::pair<std::size_t, int>> taken;
    std::vector<std::size_t> left;
    for (const std::size_t i : open) {
      float nearest = std::numeric_limits<float>::infinity();
      int best = kNone;
      grid_.forNeighbors(i, [&](std::size_t j) {
        if (patch_[j] == kNone || !grid_.areConnected(i, j)) return;
        const Point step = grid_.point(i) - grid_.point(j);
        const float off = grid_.hasNormal(j) ? std::abs(grid_.normal(j).dot(step)) : step.norm();
        if (off < nearest) {
          nearest = off;
          best = patch_[j];
        }
      });
      if (best == kNone) {
        left.push_back(i);
      } else {
        taken.emplace_back(i, best);
      }
    }
    if (taken.empty()) break;
    for (const auto& [i, patch] : taken) patch_[i] = patch;
    open = std::move(left);
  }
  growRoughPatches(open);
}

// Thin or rough objects: pixels without a smooth neighbor.
void Patches::growRoughPatches(const std::vector<std::size_t>& pixels) {
  for (const std::size_t seed : pixels) {
    if (patch_[seed] != kNone) continue;
    const int patch = static_cast<int>(patches_++);
    std::deque<std::size_t> front{seed};
    patch_[seed] = patch;
    while (!front.empty()) {
      const std::size_t i = front.front();
      front.pop_front();
      grid_.forNeighbors(i, [&](std::size_t j) {
        if (!above_[j] || patch_[j] != kNone || !grid_.areConnected(i, j)) return;
        patch_[j] = patch;
        front.push_back(j);
      });
    }
  }
}

void Patches::measurePatches() {
  patch_of_.assign(patches_, {});
  std::vector<int> pairs(patches_, 0);
  const int reach = params_.normal_window + 2;
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    if (patch_[i] == kNone) continue;
    const auto p = static_cast<std::size_t>(patch_[i]);
    ++patch_of_[p].size;
    for (const auto& [dx, dy] : {std::pair<int, int>{reach, 0}, {0, reach}}) {
      const std::optional<std::size_t> j = grid_.neighbor(i, dx, dy);
      if (!j || patch_[*j] != patch_[i] || !grid_.hasNormal(i) || !grid_.hasNormal(*j)) continue;
      const Point step = (grid_.point(i) - grid_.point(*j)).normalized();
      patch_of_[p].bend += step.dot(grid_.normal(i) - grid_.normal(*j));
      ++pairs[p];
    }
  }
  for (std::size_t p = 0; p < patches_; ++p) {
    if (pairs[p] > 0) patch_of_[p].bend /= static_cast<float>(pairs[p]);
  }
}

std::size_t Patches::innerPixel(std::size_t i, int dx, int dy) const {
  const int patch = patch_[i];
  for (int k = 0; k < params_.normal_window + 1; ++k) {
    const std::optional<std::size_t> next = grid_.neighbor(i, dx, dy);
    if (!next || patch_[*next] != patch) break;
    i = *next;
  }
  return i;
}

}  // namespace hyselam_objects
