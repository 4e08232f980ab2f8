// The flood of Alg. 3.1 on rows of bits: a whole row of cells is flooded by a few operations on
// long numbers. Densities are here, frontiers (Alg. 6.1) in frontier_count.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "fsd_localization/density/free_space_density.hpp"

namespace fsd_localization {

using hyselam::Cell;

/// The floods of one kernel, whatever the width of its rows.
class FreeSpaceDensity::Flood {
 public:
  explicit Flood(const Kernel& k) : kernel(k) {}
  virtual ~Flood() = default;
  virtual double soft(const FreeSpaceGrid& space, Cell center) const = 0;
  virtual Density density(const FreeSpaceGrid& space, Cell center) const = 0;
  virtual int frontierCount(const FreeSpaceGrid& space, Cell center, double min_share) const = 0;

  const Kernel kernel;
};

/// A flood whose rows fit W words: the disc and a ring of one cell around it, 2 h + 1 cells wide,
/// and one spare bit for the end of a run.
template <int W>
class FreeSpaceDensity::RowFlood final : public Flood {
 public:
  explicit RowFlood(const Kernel& k)
      : Flood(k),
        h_(k.radius()),
        disc_(static_cast<std::size_t>(2 * h_ + 1), Row{}),
        row_sum_(static_cast<std::size_t>(2 * h_ + 1) * static_cast<std::size_t>(2 * h_ + 2)) {
    for (int j = 0; j <= 2 * h_; ++j) {
      float* sum = rowSum(j);
      double total = 0.0;
      for (int i = 0; i <= 2 * h_; ++i) {
        sum[i] = static_cast<float>(total);
        const double w = kernel.weight(i - h_, j - h_);
        total += w;
        if (w > 0.0) disc_[at(j)].words[i / 64] |= std::uint64_t{1} << (i % 64);
      }
      sum[2 * h_ + 1] = static_cast<float>(total);
    }
  }

  double soft(const FreeSpaceGrid& space, Cell center) const override {
    Rows free{}, reached{};
    cutOut(space.free, center, free);
    if (!fillFromCenter(free, reached)) return 0.0;
    return kernelSum(reached);
  }

  Density density(const FreeSpaceGrid& space, Cell center) const override {
    Rows free{}, unknown{}, reached{};
    cutOut(space.free, center, free);
    cutOut(space.unknown, center, unknown);
    const bool center_free = fillFromCenter(free, reached);
    Density result;
    if (center_free) result.soft = kernelSum(reached);

    bool touches_unknown = bitAt(unknown[h_], h_);
    for (int j = 1; j < 2 * h_ && !touches_unknown; ++j) {
      touches_unknown = (spread(reached, j) & unknown[j]).any();
    }
    result.upper = result.soft;
    if (!touches_unknown) {
      result.hard = result.soft;
      return result;
    }
    for (int j = 0; j <= 2 * h_; ++j) free[j] = free[j] | unknown[j];
    if (fillFromCenter(free, reached)) result.upper = kernelSum(reached);
    return result;
  }

  /// Alg. 6.1, in frontier_count.cpp.
  int frontierCount(const FreeSpaceGrid& space, Cell center, double min_share) const override;

 private:
  using Row = BitRow<W>;
  using Rows = std::array<Row, static_cast<std::size_t>(64 * W)>;  // 2 h + 1 of them are used

  static std::size_t at(int j) { return static_cast<std::size_t>(j); }
  static bool bitAt(const Row& row, int i) { return (row.words[i / 64] >> (i % 64) & 1U) != 0; }
  float* rowSum(int j) { return &row_sum_[at(j) * at(2 * h_ + 2)]; }
  const float* rowSum(int j) const { return &row_sum_[at(j) * at(2 * h_ + 2)]; }

  Row wholeRow(const BitPlane& plane, Cell center, int j) const {
    return plane.row<W>(center.x - h_, center.y - h_ + j);
  }
  void cutOut(const BitPlane& plane, Cell center, Rows& out) const {
    for (int j = 0; j <= 2 * h_; ++j) out[j] = wholeRow(plane, center, j) & disc_[at(j)];
  }

  /// All cells of `open` that a run of `open` joins to `seed` (a subset of `open`) within the row.
  static Row fillRow(const Row& open, Row seed) {
    const Row rest = open & ~seed;
    if (!(rest & (seed.template left<1>() | seed.template right<1>())).any()) return seed;
    seed = (open & ~(open + seed)) | seed;  // rightwards: the carry runs to the end of each run
    Row gap = open & ~seed;
    if (!(gap & seed.template left<1>()).any()) return seed;
    return fillLeft<1>(open, seed);
  }
  /// Leftwards in doubling steps (Kogge-Stone): `pass` tells where the last K steps were all open.
  template <int K>
  static Row fillLeft(const Row& pass, Row seed) {
    seed = seed | (pass & seed.template left<K>());
    if constexpr (2 * K < 64 * W) {
      return fillLeft<2 * K>(pass & pass.template left<K>(), seed);
    } else {
      return seed;
    }
  }

  /// The component of `open` that holds the center; false (and all empty) where the center is not
  /// open.
  bool fillFromCenter(const Rows& open, Rows& reached) const {
    const int n = 2 * h_ + 1;
    if (!bitAt(open[h_], h_)) {
      std::fill_n(reached.begin(), n, Row{});
      return false;
    }
    Row seed{};
    seed.words[h_ / 64] = std::uint64_t{1} << (h_ % 64);
    reached[h_] = fillRow(open[h_], seed);
    // Outwards once; most surroundings are done then.
    Row missed{};
    for (int j = h_ + 1; j < n; ++j) {
      reached[j] = fillRow(open[j], reached[j - 1] & open[j]);
      missed = missed | (reached[j] & open[j - 1] & ~reached[j - 1]);
    }
    for (int j = h_ - 1; j >= 0; --j) {
      reached[j] = fillRow(open[j], reached[j + 1] & open[j]);
      missed = missed | (reached[j] & open[j + 1] & ~reached[j + 1]);
    }
    while (missed.any()) {  // the free space folds back: sweep to and fro until nothing is added
      for (int j = 1; j < n; ++j) {
        reached[j] = fillRow(open[j], reached[j] | (reached[j - 1] & open[j]));
      }
      missed = Row{};
      for (int j = n - 2; j >= 0; --j) {
        reached[j] = fillRow(open[j], reached[j] | (reached[j + 1] & open[j]));
        missed = missed | (reached[j] & open[j + 1] & ~reached[j + 1]);
      }
    }
    return true;
  }

  /// Kernel sum over the set cells: each run [a, b) gives rowSum(b) - rowSum(a).
  double kernelSum(const Rows& cells) const {
    double total = 0.0;
    for (int j = 1; j < 2 * h_; ++j) {
      const Row& row = cells[j];
      if (!row.any()) continue;
      const float* prefix = rowSum(j);
      if (row == disc_[at(j)]) {
        total += prefix[2 * h_ + 1];
        continue;
      }
      const Row ends = row ^ row.template right<1>();
      float inside = -1.0F, row_total = 0.0F;
      for (int w = 0; w < W; ++w) {
        for (std::uint64_t bits = ends.words[w]; bits != 0; bits &= bits - 1) {
          row_total += inside * prefix[64 * w + __builtin_ctzll(bits)];
          inside = -inside;
        }
      }
      total += row_total;
    }
    return total;
  }

  /// The 4-neighbours of the set cells, seen from row j.
  Row spread(const Rows& cells, int j) const {
    Row out = cells[j].template left<1>() | cells[j].template right<1>();
    if (j > 0) out = out | cells[j - 1];
    if (j < 2 * h_) out = out | cells[j + 1];
    return out;
  }

  /// Number of 8-connected groups with more than `min_size` cells; empties `cells`.
  int countGroups(Rows& cells, double min_size) const;
  /// Whether the cell was set; clears it.
  static bool take(Rows& cells, int i, int j);

  int h_;
  std::vector<Row> disc_;       // bit i of row j: offset (i - h, j - h) lies in the disc
  std::vector<float> row_sum_;  // prefix sums of the kernel along each row
};

}  // namespace fsd_localization
