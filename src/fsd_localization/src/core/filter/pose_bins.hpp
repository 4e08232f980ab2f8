// Particles sorted into bins of position and heading, by a hash table without allocation per bin.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "fsd_localization/filter/particles.hpp"
#include "hyselam_common/rng.hpp"

namespace fsd_localization {

class PoseBins {
 public:
  struct Bin {
    int x = 0, y = 0, a = 0;
    double weight = 0.0;
    int cluster = -1;
  };

  /// Bins of `cell` [m] and `angle` [rad], for up to `expected` particles.
  PoseBins(double cell, double angle, std::size_t expected)
      : per_meter_(static_cast<float>(1.0 / cell)),
        turn_(std::max(1, static_cast<int>(std::lround(2.0 * hyselam::kPi / angle)))) {
    std::size_t size = 1024;
    while (size < 2 * expected) size *= 2;
    table_.assign(size, -1);
  }

  /// Adds a particle's weight to its bin; returns the bin's number. Bins are numbered as they come.
  int add(const Particles& p, std::size_t i) {
    const int x = static_cast<int>(std::floor(p.x[i] * per_meter_));
    const int y = static_cast<int>(std::floor(p.y[i] * per_meter_));
    const int a = static_cast<int>(
        (static_cast<std::uint64_t>(p.heading[i]) * static_cast<unsigned>(turn_)) >> 32);
    if (last_ < 0 || !is(last_, x, y, a)) {  // neighbours in memory mostly share their bin
      std::int32_t& slot = table_[slotOf(x, y, a)];
      if (slot < 0) {
        slot = static_cast<std::int32_t>(bins.size());
        bins.push_back({x, y, a, 0.0, -1});
      }
      last_ = slot;
    }
    bins[static_cast<std::size_t>(last_)].weight += p.weight[i];
    return last_;
  }
  /// The bin there, or -1. `a` may be one step outside a turn.
  int find(int x, int y, int a) const { return table_[slotOf(x, y, (a + turn_) % turn_)]; }

  std::vector<Bin> bins;

 private:
  bool is(int number, int x, int y, int a) const {
    const Bin& b = bins[static_cast<std::size_t>(number)];
    return b.x == x && b.y == y && b.a == a;
  }
  /// Where the bin is, or the empty place where it would be put.
  std::size_t slotOf(int x, int y, int a) const {
    const std::uint64_t key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 40) ^
                              (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 12) ^
                              static_cast<std::uint64_t>(a);
    const std::size_t mask = table_.size() - 1;
    std::size_t slot = static_cast<std::size_t>(hyselam::splitmix64(key)) & mask;
    while (table_[slot] >= 0 && !is(table_[slot], x, y, a)) slot = (slot + 1) & mask;
    return slot;
  }

  float per_meter_;
  int turn_;
  int last_ = -1;
  std::vector<std::int32_t> table_;
};

}  // namespace fsd_localization
