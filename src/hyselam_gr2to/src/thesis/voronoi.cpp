#include "hyselam_gr2to/thesis/voronoi.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {

using hyselam::Cell;

namespace {

constexpr std::uint8_t kLine = 255;
// Thinning is done in tiles: what a tile gets depends on nothing farther than the number of passes.
constexpr int kTile = 32;
constexpr int kPasses = 4;

std::int64_t squaredDistance(Cell a, Cell b) {
  const std::int64_t dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

// Puts a cell and the next one to the right or above on the diagram, if a border runs between them.
void markPair(const DistanceMap& d, Cell p, Cell n, double noise, std::uint8_t* mark_p,
              std::uint8_t* mark_n) {
  const Cell sp = d.site(p), sn = d.site(n);
  if (sp == sn) return;
  const std::int32_t dp = d.squared(p), dn = d.squared(n);
  if (dp == 0 || dn == 0 || !separateSites(sp, sn, std::max(dp, dn), noise)) return;
  const std::int64_t loss_p = squaredDistance(p, sn) - dp, loss_n = squaredDistance(n, sp) - dn;
  if (mark_p != nullptr && loss_p <= loss_n) *mark_p = kLine;
  if (mark_n != nullptr && loss_n <= loss_p) *mark_n = kLine;
}

// Whether Guo and Hall's thinning (1989) takes a cell away. Neighbours p2 .. p9: north, then
// clockwise; bit 0 is p2.
bool removable(unsigned n, bool odd) {
  const bool p2 = n & 1, p3 = n & 2, p4 = n & 4, p5 = n & 8, p6 = n & 16, p7 = n & 32, p8 = n & 64,
             p9 = n & 128;
  const int crossings =
      (!p2 && (p3 || p4)) + (!p4 && (p5 || p6)) + (!p6 && (p7 || p8)) + (!p8 && (p9 || p2));
  if (crossings != 1) return false;
  const int n1 = (p9 || p2) + (p3 || p4) + (p5 || p6) + (p7 || p8);
  const int n2 = (p2 || p3) + (p4 || p5) + (p6 || p7) + (p8 || p9);
  const int count = std::min(n1, n2);
  if (count < 2 || count > 3) return false;
  return odd ? !((p2 || p3 || !p5) && p4) : !((p6 || p7 || !p9) && p8);
}

std::array<std::array<bool, 256>, 2> removalTable() {
  std::array<std::array<bool, 256>, 2> table{};
  for (unsigned n = 0; n < 256; ++n) {
    table[0][n] = removable(n, true);
    table[1][n] = removable(n, false);
  }
  return table;
}

}  // namespace

void VoronoiParams::describe(hyselam::ParameterVisitor& visit) {
  visit("noise", noise, hyselam::Range::between(0.5, 10000.0), "cells",
        "bumps of a wall up to this depth make no branch");
}

void VoronoiParams::validate() const {
  hyselam::checkParameters(*this);
}

bool separateSites(Cell a, Cell b, std::int32_t squared, double noise) {
  const auto apart = static_cast<double>(squaredDistance(a, b));
  const double bump = apart - noise * noise;
  return apart > 2.0 && bump > 0.0 && bump * bump > 4.0 * noise * noise * squared;
}

VoronoiDiagram::VoronoiDiagram(const DistanceMap& distances, const VoronoiParams& params)
    : noise_(params.noise),
      borders_(distances.height(), distances.width(), CV_8UC1, cv::Scalar(0)),
      lines_(distances.height(), distances.width(), CV_8UC1, cv::Scalar(0)) {
  params.validate();
  for (int y = 0; y < borders_.rows; ++y) {
    std::uint8_t* row = borders_.ptr<std::uint8_t>(y);
    std::uint8_t* above = y + 1 < borders_.rows ? borders_.ptr<std::uint8_t>(y + 1) : nullptr;
    for (int x = 0; x < borders_.cols; ++x) {
      if (distances.squared({x, y}) == 0) continue;
      if (x + 1 < borders_.cols) {
        markPair(distances, {x, y}, {x + 1, y}, noise_, row + x, row + x + 1);
      }
      if (above != nullptr) markPair(distances, {x, y}, {x, y + 1}, noise_, row + x, above + x);
    }
  }
  for (int ty = 0; ty * kTile < borders_.rows; ++ty) {
    for (int tx = 0; tx * kTile < borders_.cols; ++tx) thinTile(tx, ty);
  }
}

void VoronoiDiagram::update(const DistanceMap& d, const std::vector<RowSpan>& changed) {
  const int tiles_x = (borders_.cols + kTile - 1) / kTile,
            tiles_y = (borders_.rows + kTile - 1) / kTile;
  std::vector<std::uint8_t> dirty(static_cast<std::size_t>(tiles_x) *
                                  static_cast<std::size_t>(tiles_y));
  const auto touch = [&](int x, int y) {
    for (int ty = std::max(0, y - kPasses) / kTile;
         ty <= std::min(borders_.rows - 1, y + kPasses) / kTile; ++ty) {
      for (int tx = std::max(0, x - kPasses) / kTile;
           tx <= std::min(borders_.cols - 1, x + kPasses) / kTile; ++tx) {
        dirty[static_cast<std::size_t>(ty) * static_cast<std::size_t>(tiles_x) +
              static_cast<std::size_t>(tx)] = 1;
      }
    }
  };
  // A cell's mark depends on its own site and those of its four neighbours.
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(borders_.cols));
  const auto refresh = [&](int y, int first, int last) {
    std::uint8_t* row = borders_.ptr<std::uint8_t>(y);
    std::uint8_t* now = marks.data();
    std::fill(now + first, now + last + 1, std::uint8_t{0});
    if (first > 0) markPair(d, {first - 1, y}, {first, y}, noise_, nullptr, now + first);
    for (int x = first; x <= last; ++x) {
      if (x + 1 < borders_.cols) {
        markPair(d, {x, y}, {x + 1, y}, noise_, now + x, x < last ? now + x + 1 : nullptr);
      }
      if (y > 0) markPair(d, {x, y - 1}, {x, y}, noise_, nullptr, now + x);
      if (y + 1 < borders_.rows) markPair(d, {x, y}, {x, y + 1}, noise_, now + x, nullptr);
      if (now[x] == row[x]) continue;
      row[x] = now[x];
      touch(x, y);
    }
  };
  // Spans come in the order of rows. Row y is looked at where it, the row below or the one above
  // has changed.
  std::size_t begin = 0;
  std::vector<std::pair<int, int>> parts;
  for (int y = changed.empty() ? 0 : changed.front().y - 1;
       !changed.empty() && y <= changed.back().y + 1; ++y) {
    while (begin < changed.size() && changed[begin].y < y - 1) ++begin;
    if (y < 0 || y >= borders_.rows) continue;
    parts.clear();
    for (std::size_t i = begin; i < changed.size() && changed[i].y <= y + 1; ++i) {
      const int more = changed[i].y == y ? 1 : 0;
      parts.push_back({std::max(0, changed[i].first - more),
                       std::min(borders_.cols - 1, changed[i].last + more)});
    }
    std::sort(parts.begin(), parts.end());
    for (std::size_t i = 0; i < parts.size();) {
      const int first = parts[i].first;
      int last = parts[i].second;
      while (++i < parts.size() && parts[i].first <= last + 1)
        last = std::max(last, parts[i].second);
      refresh(y, first, last);
    }
  }
  for (int ty = 0; ty < tiles_y; ++ty) {
    for (int tx = 0; tx < tiles_x; ++tx) {
      if (dirty[static_cast<std::size_t>(ty) * static_cast<std::size_t>(tiles_x) +
                static_cast<std::size_t>(tx)] != 0) {
        thinTile(tx, ty);
      }
    }
  }
}

// Two double passes of parallel thinning on a copy with a margin that the passes use up.
void VoronoiDiagram::thinTile(int tx, int ty) {
  static const std::array<std::array<bool, 256>, 2> kRemoved = removalTable();
  constexpr int kMargin = kPasses + 1;
  constexpr int kSide = kTile + 2 * kMargin;
  std::uint8_t cells[kSide][kSide] = {};
  const int x0 = tx * kTile - kMargin, y0 = ty * kTile - kMargin;
  const int from = std::max(0, x0), to = std::min(borders_.cols, x0 + kSide);
  struct Local {
    std::uint8_t x, y;
  };
  std::vector<Local> marks;
  for (int y = std::max(0, y0); y < std::min(borders_.rows, y0 + kSide); ++y) {
    const std::uint8_t* row = borders_.ptr<std::uint8_t>(y);
    for (int x = from; x < to; ++x) {
      if (row[x] == 0) continue;
      cells[y - y0][x - x0] = 1;
      if (x > x0 && x < x0 + kSide - 1 && y > y0 && y < y0 + kSide - 1) {
        marks.push_back({static_cast<std::uint8_t>(x - x0), static_cast<std::uint8_t>(y - y0)});
      }
    }
  }
  std::vector<Local> gone;
  for (int pass = 0; pass < kPasses && !marks.empty(); ++pass) {
    gone.clear();
    const auto& removed = kRemoved[static_cast<std::size_t>(pass % 2)];
    const auto kept = [&](const Local& c) {
      const std::uint8_t* up = &cells[c.y + 1][c.x];
      const std::uint8_t* mid = &cells[c.y][c.x];
      const std::uint8_t* down = &cells[c.y - 1][c.x];
      const unsigned n = up[0] + 2u * up[1] + 4u * mid[1] + 8u * down[1] + 16u * down[0] +
                         32u * down[-1] + 64u * mid[-1] + 128u * up[-1];
      if (!removed[n]) return true;
      gone.push_back(c);
      return false;
    };
    marks.erase(std::stable_partition(marks.begin(), marks.end(), kept), marks.end());
    for (const Local& c : gone) cells[c.y][c.x] = 0;
  }
  const int width = std::min(kTile, borders_.cols - tx * kTile);
  for (int y = 0; y < std::min(kTile, borders_.rows - ty * kTile); ++y) {
    std::memset(lines_.ptr<std::uint8_t>(ty * kTile + y) + tx * kTile, 0,
                static_cast<std::size_t>(width));
  }
  for (const Local& c : marks) {
    const int x = c.x - kMargin, y = c.y - kMargin;
    if (x < 0 || y < 0 || x >= kTile || y >= kTile) continue;
    lines_.at<std::uint8_t>(ty * kTile + y, tx * kTile + x) = kLine;
  }
}

}  // namespace hyselam_topo
