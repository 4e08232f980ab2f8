#include "fsd_localization/search/score_lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace fsd_localization {

using hyselam::Point2;
using hyselam::Pose2;

namespace {

constexpr int kTile = ScoreLattice::kTile;
constexpr int kStrip = 32;                    // tiles that are bounded together, side by side
constexpr std::size_t kAtOnce = 25;           // points, before the rest is given up
constexpr std::size_t kMaxExpanded = 500000;  // tiles: a bound on time; not reached on buildings
constexpr std::size_t kAskEvery = 256;        // tiles, whether the search is still wanted

int floorDiv(int a, int b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

int cellOffset(double metres) {
  return static_cast<int>(std::floor(metres / ScoreLattice::kCell + 0.5));
}

/// Each element becomes the maximum of it and of the one `ahead`, if there is one.
void maximumWith(std::vector<std::uint8_t>& table, std::size_t ahead) {
  for (std::size_t i = 0; i + ahead < table.size(); ++i) {
    table[i] = std::max(table[i], table[i + ahead]);
  }
}

}  // namespace

ScoreLattice::ScoreLattice(const hyselam::OccupancyGrid& map,
                           const std::vector<std::uint8_t>& distance,
                           const OccupancyThresholds& thresholds) {
  fill(map, distance, thresholds);
  makeTiles();
}

void ScoreLattice::fill(const hyselam::OccupancyGrid& map,
                        const std::vector<std::uint8_t>& distance,
                        const OccupancyThresholds& thresholds) {
  const hyselam::GridGeometry& g = map.geometry;
  const double side = g.resolution / kCell;  // of a cell of the map [lattice cells]
  width_ = static_cast<int>(std::ceil(g.width * side - 1e-9));
  height_ = static_cast<int>(std::ceil(g.height * side - 1e-9));
  stride_ = width_ + 2 * kTile;
  score_.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height_ + 2 * kTile),
                0);
  free_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
  std::array<std::uint8_t, 256> by_distance{};  // the last: nothing near
  for (std::size_t d = 0; d < 255; ++d) {
    const double metres = 0.01 * static_cast<double>(d);
    by_distance[d] = static_cast<std::uint8_t>(
        std::lround(255.0 * std::exp(-0.5 * metres * metres / (kSigma * kSigma))));
  }
  for (int ly = 0; ly < height_; ++ly) {
    // The cells of the map whose middles lie in the lattice's cell; where those are larger, one.
    const auto range = [&](int l, int limit) {
      int from = static_cast<int>(std::ceil(l / side - 0.5));
      int to = static_cast<int>(std::ceil((l + 1) / side - 0.5));
      if (from >= to) from = static_cast<int>((l + 0.5) / side), to = from + 1;
      return std::pair<int, int>{std::max(0, from), std::min(limit, to)};
    };
    const auto [y0, y1] = range(ly, g.height);
    for (int lx = 0; lx < width_; ++lx) {
      const auto [x0, x1] = range(lx, g.width);
      std::uint8_t nearest = 255, free = 0;
      for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
          const std::int8_t value = map.at({x, y});
          nearest = std::min(nearest, distance[g.index({x, y})]);
          free |= static_cast<std::uint8_t>(thresholds.isFree(value));
        }
      }
      scoreAt(lx, ly) = by_distance[nearest];
      free_[static_cast<std::size_t>(ly) * static_cast<std::size_t>(width_) +
            static_cast<std::size_t>(lx)] = free;
    }
  }
}

void ScoreLattice::makeTiles() {
  tiles_across_ = (width_ + kTile - 1) / kTile;
  tiles_up_ = (height_ + kTile - 1) / kTile;
  tile_free_.assign(
      static_cast<std::size_t>(tiles_across_ + kStrip) * static_cast<std::size_t>(tiles_up_), 0);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      tile_free_[static_cast<std::size_t>(y / kTile * (tiles_across_ + kStrip) + x / kTile)] |=
          free_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                static_cast<std::size_t>(x)];
    }
  }
  // In each cell the maximum of the square of a tile's size to the right and up; the margins are as
  // wide as a tile, so nothing comes from the next row.
  std::vector<std::uint8_t> best = score_;
  for (int ahead = 1; ahead < kTile; ahead *= 2) {
    maximumWith(best, static_cast<std::size_t>(ahead));
    maximumWith(best, static_cast<std::size_t>(ahead) * static_cast<std::size_t>(stride_));
  }
  // A tile's row and column -1 hold squares that begin left of the lattice or below it.
  tile_stride_ = tiles_across_ + 1 + 2 * kStrip;
  const std::size_t plane = planeSize();
  tiles_.assign(plane * kTile * kTile, 0);
  for (int y = -kTile; y < height_; ++y) {
    for (int x = -kTile; x < width_; ++x) {
      const int tx = floorDiv(x, kTile), ty = floorDiv(y, kTile);
      const int rx = x - tx * kTile, ry = y - ty * kTile;
      tiles_[static_cast<std::size_t>(ry * kTile + rx) * plane +
             static_cast<std::size_t>((ty + 1) * tile_stride_ + tx + 1 + kStrip)] =
          best[indexOf(x, y)];
    }
  }
}

/// One search: bounds of all tiles, then the best tiles cell by cell.
class LatticeSearch {
 public:
  LatticeSearch(const ScoreLattice& lattice, const std::vector<Point2>& points)
      : lattice_(lattice), count_(std::min(points.size(), ScoreLattice::kMaxPoints)) {
    cells_.reserve(count_ * ScoreLattice::kHeadings);
    for (int h = 0; h < ScoreLattice::kHeadings; ++h) {
      const double a = 2.0 * hyselam::kPi * h / ScoreLattice::kHeadings;
      const double c = std::cos(a), s = std::sin(a);
      for (std::size_t i = 0; i < count_; ++i) {
        const Point2& p = points[i];
        cells_.push_back({cellOffset(c * p.x - s * p.y), cellOffset(s * p.x + c * p.y)});
      }
    }
  }

  std::vector<ScoreLattice::Pose> run(const ScoreLattice::Limits& limits,
                                      const std::function<bool()>& cancelled) {
    std::vector<ScoreLattice::Pose> poses;
    if (count_ == 0) return poses;
    lowest_ = static_cast<int>(
        std::ceil(std::max(0.0, limits.min_score) * 255.0 * static_cast<double>(count_)));
    drop_ = static_cast<int>(limits.max_drop * 255.0 * static_cast<double>(count_));
    open_.resize(255 * count_ + 1);
    for (int h = 0; h < ScoreLattice::kHeadings; ++h) {
      if (cancelled && cancelled()) return poses;
      boundTiles(h);
    }
    std::vector<bool> taken(lattice_.tileCount() *
                            (ScoreLattice::kHeadings / ScoreLattice::kTileHeadings));
    std::size_t expanded = 0;
    for (int bound = static_cast<int>(open_.size()) - 1; bound >= lowest_; --bound) {
      auto& bucket = open_[static_cast<std::size_t>(bound)];
      while (!bucket.empty()) {
        const Node node = bucket.back();
        bucket.pop_back();
        const std::size_t number = numberOf(node);
        if (taken[number]) continue;
        if (node.cell < 0) {
          if (++expanded % kAskEvery == 0 && cancelled && cancelled()) return poses;
          if (expanded <= kMaxExpanded) expand(node);
          continue;
        }
        taken[number] = true;
        poses.push_back(poseOf(node, bound));
        if (poses.size() == limits.max_poses) return poses;
      }
    }
    return poses;
  }

  int bestNear(const Pose2& pose) const {
    const int cx = static_cast<int>(std::floor(pose.x / ScoreLattice::kCell));
    const int cy = static_cast<int>(std::floor(pose.y / ScoreLattice::kCell));
    const int turn =
        static_cast<int>(std::lround(pose.theta / (2.0 * hyselam::kPi) * ScoreLattice::kHeadings));
    int best = -1;
    for (int h = turn - 1; h <= turn + 1; ++h) {
      const int heading =
          (h % ScoreLattice::kHeadings + ScoreLattice::kHeadings) % ScoreLattice::kHeadings;
      for (int y = cy - 1; y <= cy + 1; ++y) {
        for (int x = cx - 1; x <= cx + 1; ++x) {
          if (x < 0 || y < 0 || x >= lattice_.width_ || y >= lattice_.height_) continue;
          best = std::max(best, sumAt(heading, x, y));
        }
      }
    }
    return best;
  }

  std::size_t count() const { return count_; }

 private:
  struct Cell {
    int x, y;
  };
  struct Node {
    int x, y;  // tile
    int heading;
    int cell;  // in the tile; -1: the tile as a whole
    int sum;   // of the cell
  };
  using Sums = std::array<std::uint16_t, kStrip>;

  /// Of positions within a tile and headings within kTileHeadings.
  std::size_t numberOf(const Node& n) const {
    return static_cast<std::size_t>(
        ((n.heading / ScoreLattice::kTileHeadings) * lattice_.tiles_up_ + n.y) *
            lattice_.tiles_across_ +
        n.x);
  }

  int sumAt(int heading, int x, int y) const {
    const Cell* cells = &cells_[static_cast<std::size_t>(heading) * count_];
    int sum = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const int px = x + cells[i].x, py = y + cells[i].y;
      if (px >= 0 && py >= 0 && px < lattice_.width_ && py < lattice_.height_) {
        sum += lattice_.score_[lattice_.indexOf(px, py)];
      }
    }
    return sum;
  }

  /// Whether, after `done` points, one of the sums may still become good enough.
  template <std::size_t N>
  bool isHopeful(const std::array<std::uint16_t, N>& sums, std::size_t done) const {
    std::uint16_t best = 0;
    for (const std::uint16_t s : sums) best = std::max(best, s);
    return best + 255 * static_cast<int>(count_ - done) >= lowest_;
  }

  /// Opens the tiles of a heading that may hold something good enough; the best one at once, for
  /// its cells tell what is.
  void boundTiles(int heading) {
    struct Shift {
      int tx, ty;
      const std::uint8_t* plane;
    };
    const std::size_t plane = lattice_.planeSize();
    std::vector<Shift> shifts(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      const Cell& c = cells_[static_cast<std::size_t>(heading) * count_ + i];
      const int tx = floorDiv(c.x, kTile), ty = floorDiv(c.y, kTile);
      shifts[i] = {
          tx, ty,
          &lattice_
               .tiles_[static_cast<std::size_t>((c.y - ty * kTile) * kTile + (c.x - tx * kTile)) *
                       plane]};
    }
    bounds_.clear();
    Bound best{0, 0, -1};
    const int across = lattice_.tiles_across_, up = lattice_.tiles_up_;
    for (int y = 0; y < up; ++y) {
      for (int x = 0; x < across; x += kStrip) {
        const std::uint8_t* free =
            &lattice_.tile_free_[static_cast<std::size_t>(y * (across + kStrip) + x)];
        if (std::all_of(free, free + kStrip, [](std::uint8_t f) { return f == 0; })) continue;
        Sums sums{};
        std::size_t i = 0;
        while (i < count_) {
          const std::size_t end = std::min(count_, i + kAtOnce);
          for (; i < end; ++i) {
            const int row = y + shifts[i].ty, column = x + shifts[i].tx;
            if (row < -1 || row >= up || column < -kStrip || column >= across) continue;
            const std::uint8_t* s =
                shifts[i].plane + (row + 1) * lattice_.tile_stride_ + column + 1 + kStrip;
            for (std::size_t k = 0; k < kStrip; ++k) {
              sums[k] = static_cast<std::uint16_t>(sums[k] + s[k]);
            }
          }
          if (!isHopeful(sums, i)) break;
        }
        if (i < count_) continue;
        for (int k = 0; k < kStrip; ++k) {
          const int sum = sums[static_cast<std::size_t>(k)];
          if (free[k] == 0 || sum < lowest_) continue;
          bounds_.push_back({x + k, y, sum});
          if (sum > best.sum) best = bounds_.back();
        }
      }
    }
    if (best.sum >= 0) expand({best.x, best.y, heading, -1, 0});
    for (const Bound& b : bounds_) {
      if (b.sum >= lowest_ && (b.x != best.x || b.y != best.y)) {
        open_[static_cast<std::size_t>(b.sum)].push_back({b.x, b.y, heading, -1, 0});
      }
    }
  }

  /// Opens the best free cell of a tile, for one heading.
  void expand(const Node& tile) {
    const Cell* cells = &cells_[static_cast<std::size_t>(tile.heading) * count_];
    std::array<std::uint16_t, static_cast<std::size_t>(kTile * kTile)> sums{};
    const int x0 = tile.x * kTile, y0 = tile.y * kTile;
    std::size_t i = 0;
    while (i < count_) {
      const std::size_t end = std::min(count_, i + kAtOnce);
      for (; i < end; ++i) {
        const int x = x0 + cells[i].x, y = y0 + cells[i].y;
        if (x < -kTile || y < -kTile || x >= lattice_.width_ || y >= lattice_.height_) continue;
        const std::uint8_t* s = &lattice_.score_[lattice_.indexOf(x, y)];
        std::uint16_t* sum = sums.data();
        for (int r = 0; r < kTile; ++r, s += lattice_.stride_, sum += kTile) {
          for (int k = 0; k < kTile; ++k) sum[k] = static_cast<std::uint16_t>(sum[k] + s[k]);
        }
      }
      if (!isHopeful(sums, i)) return;
    }
    int best = -1;
    for (int k = 0; k < kTile * kTile; ++k) {
      const int x = x0 + k % kTile, y = y0 + k / kTile;
      if (x >= lattice_.width_ || y >= lattice_.height_) continue;
      const bool free =
          lattice_.free_[static_cast<std::size_t>(y) * static_cast<std::size_t>(lattice_.width_) +
                         static_cast<std::size_t>(x)] != 0;
      if (free &&
          (best < 0 || sums[static_cast<std::size_t>(k)] > sums[static_cast<std::size_t>(best)])) {
        best = k;
      }
    }
    if (best < 0) return;
    const int sum = sums[static_cast<std::size_t>(best)];
    lowest_ = std::max(lowest_, sum - drop_);
    if (sum >= lowest_) {
      open_[static_cast<std::size_t>(sum)].push_back({tile.x, tile.y, tile.heading, best, sum});
    }
  }

  ScoreLattice::Pose poseOf(const Node& n, int sum) const {
    const int x = n.x * kTile + n.cell % kTile, y = n.y * kTile + n.cell / kTile;
    return {{(x + 0.5) * ScoreLattice::kCell, (y + 0.5) * ScoreLattice::kCell,
             hyselam::normalizeAngle(2.0 * hyselam::kPi * n.heading / ScoreLattice::kHeadings)},
            sum / (255.0 * static_cast<double>(count_))};
  }

  struct Bound {
    int x, y, sum;
  };
  const ScoreLattice& lattice_;
  std::size_t count_;
  std::vector<Cell> cells_;              // of the points, by heading
  std::vector<std::vector<Node>> open_;  // by bound
  std::vector<Bound> bounds_;            // of one heading
  int lowest_ = 0, drop_ = 0;
};

std::vector<ScoreLattice::Pose> ScoreLattice::search(const std::vector<Point2>& points,
                                                     const Limits& limits,
                                                     const std::function<bool()>& cancelled) const {
  return LatticeSearch(*this, points).run(limits, cancelled);
}

std::optional<double> ScoreLattice::bestNear(const std::vector<Point2>& points,
                                             const Pose2& pose) const {
  const LatticeSearch search(*this, points);
  const int best = search.count() == 0 ? -1 : search.bestNear(pose);
  if (best < 0) return std::nullopt;
  return best / (255.0 * static_cast<double>(search.count()));
}

}  // namespace fsd_localization
