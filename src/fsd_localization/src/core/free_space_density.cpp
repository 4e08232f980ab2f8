#include "fsd_localization/free_space_density.hpp"

#include <algorithm>
#include <vector>

namespace fsd_localization {

using hyselam::Cell;

class FreeSpaceDensity::Flood {
 public:
  explicit Flood(const Kernel& k) : kernel(k) {}
  virtual ~Flood() = default;
  virtual double soft(const FreeSpace& space, Cell centre) const = 0;
  virtual Density density(const FreeSpace& space, Cell centre) const = 0;
  virtual int frontiers(const FreeSpace& space, Cell centre, double min_share) const = 0;

  const Kernel kernel;
};

/// A flood whose rows fit W words: the disc and a ring of one cell around it, 2 h + 1 cells wide,
/// and one spare bit for the end of a run.
template <int W>
class FreeSpaceDensity::WideFlood final : public Flood {
 public:
  explicit WideFlood(const Kernel& k)
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

  double soft(const FreeSpace& space, Cell centre) const override {
    Rows free{}, reached{};
    cut(space.free, centre, free);
    if (!fillFromCentre(free, reached)) return 0.0;
    return sum(reached);
  }

  Density density(const FreeSpace& space, Cell centre) const override {
    Rows free{}, unknown{}, reached{};
    cut(space.free, centre, free);
    cut(space.unknown, centre, unknown);
    const bool centre_free = fillFromCentre(free, reached);
    Density result;
    if (centre_free) result.soft = sum(reached);

    bool touches_unknown = bitAt(unknown[h_], h_);
    for (int j = 1; j < 2 * h_ && !touches_unknown; ++j)
      touches_unknown = (spread(reached, j) & unknown[j]).any();
    result.upper = result.soft;
    if (!touches_unknown) {
      result.hard = result.soft;
      return result;
    }
    for (int j = 0; j <= 2 * h_; ++j) free[j] = free[j] | unknown[j];
    if (fillFromCentre(free, reached)) result.upper = sum(reached);
    return result;
  }

  int frontiers(const FreeSpace& space, Cell centre, double min_share) const override {
    Rows free{}, reached{}, border{};
    cut(space.free, centre, free);
    if (!fillFromCentre(free, reached)) return 0;
    for (int j = 0; j <= 2 * h_; ++j)
      border[j] = spread(reached, j) & whole(space.free, centre, j) & ~disc_[at(j)];
    return countGroups(border, min_share * 2.0 * hyselam::kPi * h_);
  }

 private:
  using Row = BitRow<W>;
  using Rows = std::array<Row, static_cast<std::size_t>(64 * W)>;  // 2 h + 1 of them are used

  static std::size_t at(int j) { return static_cast<std::size_t>(j); }
  static bool bitAt(const Row& row, int i) { return (row.words[i / 64] >> (i % 64) & 1U) != 0; }
  float* rowSum(int j) { return &row_sum_[at(j) * at(2 * h_ + 2)]; }
  const float* rowSum(int j) const { return &row_sum_[at(j) * at(2 * h_ + 2)]; }

  Row whole(const BitPlane& plane, Cell centre, int j) const {
    return plane.row<W>(centre.x - h_, centre.y - h_ + j);
  }
  void cut(const BitPlane& plane, Cell centre, Rows& out) const {
    for (int j = 0; j <= 2 * h_; ++j) out[j] = whole(plane, centre, j) & disc_[at(j)];
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
    if constexpr (2 * K < 64 * W)
      return fillLeft<2 * K>(pass & pass.template left<K>(), seed);
    else
      return seed;
  }

  /// The component of `open` that holds the centre; false (and all empty) where the centre is shut.
  bool fillFromCentre(const Rows& open, Rows& reached) const {
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
      for (int j = 1; j < n; ++j)
        reached[j] = fillRow(open[j], reached[j] | (reached[j - 1] & open[j]));
      missed = Row{};
      for (int j = n - 2; j >= 0; --j) {
        reached[j] = fillRow(open[j], reached[j] | (reached[j + 1] & open[j]));
        missed = missed | (reached[j] & open[j + 1] & ~reached[j + 1]);
      }
    }
    return true;
  }

  /// Kernel sum over the set cells: each run [a, b) gives rowSum(b) - rowSum(a).
  double sum(const Rows& cells) const {
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
      for (int w = 0; w < W; ++w)
        for (std::uint64_t bits = ends.words[w]; bits != 0; bits &= bits - 1) {
          row_total += inside * prefix[64 * w + __builtin_ctzll(bits)];
          inside = -inside;
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
  int countGroups(Rows& cells, double min_size) const {
    int groups = 0;
    std::vector<Cell> stack;
    for (int j = 0; j <= 2 * h_; ++j)
      for (int w = 0; w < W; ++w)
        while (cells[j].words[w] != 0) {
          const int i = 64 * w + __builtin_ctzll(cells[j].words[w]);
          int size = 0;
          stack.assign(1, {i, j});
          take(cells, i, j);
          while (!stack.empty()) {
            const Cell c = stack.back();
            stack.pop_back();
            ++size;
            for (int y = std::max(c.y - 1, 0); y <= std::min(c.y + 1, 2 * h_); ++y)
              for (int x = std::max(c.x - 1, 0); x <= std::min(c.x + 1, 2 * h_); ++x)
                if (take(cells, x, y)) stack.push_back({x, y});
          }
          if (size > min_size) ++groups;
        }
    return groups;
  }
  static bool take(Rows& cells, int i, int j) {
    std::uint64_t& word = cells[at(j)].words[i / 64];
    const std::uint64_t bit = std::uint64_t{1} << (i % 64);
    const bool was_set = (word & bit) != 0;
    word &= ~bit;
    return was_set;
  }

  int h_;
  std::vector<Row> disc_;       // bit i of row j: offset (i - h, j - h) lies in the disc
  std::vector<float> row_sum_;  // prefix sums of the kernel along each row
};

FreeSpaceDensity::FreeSpaceDensity(const Kernel& kernel) {
  const int bits = 2 * kernel.radius() + 2;
  if (bits <= 64)
    flood_ = std::make_unique<WideFlood<1>>(kernel);
  else if (bits <= 128)
    flood_ = std::make_unique<WideFlood<2>>(kernel);
  else if (bits <= 192)
    flood_ = std::make_unique<WideFlood<3>>(kernel);
  else
    flood_ = std::make_unique<WideFlood<4>>(kernel);
}
FreeSpaceDensity::~FreeSpaceDensity() = default;
FreeSpaceDensity::FreeSpaceDensity(FreeSpaceDensity&&) noexcept = default;
FreeSpaceDensity& FreeSpaceDensity::operator=(FreeSpaceDensity&&) noexcept = default;

const Kernel& FreeSpaceDensity::kernel() const {
  return flood_->kernel;
}
double FreeSpaceDensity::soft(const FreeSpace& space, Cell centre) const {
  return flood_->soft(space, centre);
}
Density FreeSpaceDensity::density(const FreeSpace& space, Cell centre) const {
  return flood_->density(space, centre);
}
int FreeSpaceDensity::frontiers(const FreeSpace& space, Cell centre, double min_share) const {
  return flood_->frontiers(space, centre, min_share);
}

}  // namespace fsd_localization
