// Floors and ceilings are the layers of an OctoMap that are occupied over a large area.
#include <algorithm>
#include <cmath>

#include "hyselam_gr2to/octomap/octomap_compression.hpp"

namespace hyselam_topo {
namespace {

constexpr double kOccupiedFrom = 0.5;
constexpr double kSlabWindow = 0.25;     // a floor that is not quite level fills so much height [m]
constexpr double kSlabShare = 0.35;      // of the largest slab, to be one too
constexpr double kSlabAboveWalls = 2.0;  // times what a usual layer has
constexpr double kMinStoreyHeight = 1.8;  // [m]
constexpr double kSlabThickness = 1.0;    // from a ceiling to the floor above it, at most [m]
constexpr double kEdgeShare = 0.7;        // of its fullest layer; table tops have less
constexpr double kMinFreeShare = 0.1;     // of the slab's area must be free 1 m above it

/// Occupied and free area of each layer [m^2].
struct Profile {
  std::int32_t lowest = 0;
  double resolution = 0.0;
  std::vector<double> occupied, free;

  int layers() const { return static_cast<int>(occupied.size()); }
  double lower(int layer) const { return (lowest + layer) * resolution; }
  int layersIn(double metres) const {
    return std::max(1, static_cast<int>(std::lround(metres / resolution)));
  }
};

Profile profileOf(const VoxelMap& map) {
  Profile profile;
  profile.resolution = map.resolution;
  if (map.leaves.empty()) return profile;
  std::int32_t low = map.leaves[0].z, high = low;
  for (const VoxelLeaf& leaf : map.leaves) {
    low = std::min(low, leaf.z);
    high = std::max(high, leaf.z + leaf.size);
  }
  profile.lowest = low;
  const auto sums = [&](bool of_occupied) {
    // Differences between neighbouring layers first: a large leaf costs as much as a small one.
    std::vector<double> layers(static_cast<std::size_t>(high - low) + 1, 0.0);
    for (const VoxelLeaf& leaf : map.leaves) {
      if ((leaf.probability >= kOccupiedFrom) != of_occupied) continue;
      const double side = leaf.size;
      layers[static_cast<std::size_t>(leaf.z - low)] += side * side;
      layers[static_cast<std::size_t>(leaf.z - low + leaf.size)] -= side * side;
    }
    double sum = 0.0;
    for (double& layer : layers) layer = (sum += layer) * map.resolution * map.resolution;
    layers.pop_back();
    return layers;
  };
  profile.occupied = sums(true);
  profile.free = sums(false);
  return profile;
}

/// The sums of `window` neighbouring layers around each layer.
std::vector<double> windowed(const std::vector<double>& layers, int window) {
  const int n = static_cast<int>(layers.size());
  std::vector<double> sums(layers.size(), 0.0);
  for (int i = 0; i < n; ++i) {
    const int begin = std::max(0, i - window / 2), end = std::min(n, i - window / 2 + window);
    for (int k = begin; k < end; ++k) {
      sums[static_cast<std::size_t>(i)] += layers[static_cast<std::size_t>(k)];
    }
  }
  return sums;
}

/// Layers in the middle of slabs, lowest first, at least the height of a storey apart.
std::vector<int> slabsOf(const Profile& profile) {
  std::vector<int> slabs;
  if (profile.layers() == 0) return slabs;
  const std::vector<double> sums = windowed(profile.occupied, profile.layersIn(kSlabWindow));
  std::vector<double> sorted;
  for (const double sum : sums) {
    if (sum > 0.0) sorted.push_back(sum);
  }
  if (sorted.empty()) return slabs;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2),
                   sorted.end());
  const double usual = sorted[sorted.size() / 2];
  const double largest = *std::max_element(sums.begin(), sums.end());
  const double threshold = std::max(kSlabShare * largest, kSlabAboveWalls * usual);
  const int apart = profile.layersIn(kMinStoreyHeight);
  std::vector<int> order(sums.size());
  for (int i = 0; i < profile.layers(); ++i) order[static_cast<std::size_t>(i)] = i;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return sums[static_cast<std::size_t>(a)] > sums[static_cast<std::size_t>(b)];
  });
  for (const int layer : order) {
    if (sums[static_cast<std::size_t>(layer)] < threshold) break;
    const bool far = std::all_of(slabs.begin(), slabs.end(),
                                 [&](int other) { return std::abs(layer - other) >= apart; });
    if (far) slabs.push_back(layer);
  }
  std::sort(slabs.begin(), slabs.end());
  return slabs;
}

/// The outermost layer of a slab in a direction: a ceiling and the floor above it are one slab.
int edgeOf(const Profile& profile, int slab, int direction) {
  const auto occupied = [&](int i) { return profile.occupied[static_cast<std::size_t>(i)]; };
  const int reach = profile.layersIn(kSlabWindow), thickness = profile.layersIn(kSlabThickness);
  int fullest = slab;
  for (int i = std::max(0, slab - reach); i <= std::min(profile.layers() - 1, slab + reach); ++i) {
    if (occupied(i) > occupied(fullest)) fullest = i;
  }
  int edge = fullest;
  for (int k = 1; k <= thickness; ++k) {
    const int i = fullest + direction * k;
    if (i < 0 || i >= profile.layers()) break;
    if (occupied(i) >= kEdgeShare * occupied(fullest)) edge = i;
  }
  return edge;
}

}  // namespace

std::vector<Storey> findStoreys(const VoxelMap& map) {
  const Profile profile = profileOf(map);
  const std::vector<int> slabs = slabsOf(profile);
  std::vector<Storey> storeys;
  for (std::size_t i = 0; i < slabs.size(); ++i) {
    const bool last = i + 1 == slabs.size();
    const int floor = edgeOf(profile, slabs[i], +1);
    const int ceiling = last ? profile.layers() : edgeOf(profile, slabs[i + 1], -1);
    const int breast = floor + profile.layersIn(1.0);
    if (breast >= ceiling || breast >= profile.layers()) continue;
    Storey storey;
    storey.floor = profile.lower(floor + 1);
    storey.ceiling = profile.lower(ceiling);
    storey.area = profile.free[static_cast<std::size_t>(breast)];
    const bool high_enough = storey.ceiling - storey.floor >= 0.8 * kMinStoreyHeight;
    const double slab_area = profile.occupied[static_cast<std::size_t>(floor)];
    if (high_enough && storey.area >= kMinFreeShare * slab_area) storeys.push_back(storey);
  }
  return storeys;
}

}  // namespace hyselam_topo
