#include "hyselam_gr2to/thesis/distance_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {

using hyselam::Cell;

namespace {

// As masks of OpenCV have it, so that equal maps are equal bytes.
constexpr std::uint8_t kObstacle = 255;

std::int32_t square(std::int32_t v) {
  return v * v;
}

// By x, then y, in two counting passes.
void sortByColumn(std::vector<Cell>& cells, int width, int height) {
  std::vector<Cell> other(cells.size());
  std::vector<std::size_t> start(static_cast<std::size_t>(std::max(width, height)) + 1);
  const auto pass = [&](const std::vector<Cell>& from, std::vector<Cell>& to, int Cell::*key) {
    std::fill(start.begin(), start.end(), std::size_t{0});
    for (const Cell& c : from) ++start[static_cast<std::size_t>(c.*key) + 1];
    for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    for (const Cell& c : from) to[start[static_cast<std::size_t>(c.*key)]++] = c;
  };
  pass(cells, other, &Cell::y);
  pass(other, cells, &Cell::x);
}

}  // namespace

DistanceMap::DistanceMap(const cv::Mat& obstacles)
    : width_(obstacles.cols), height_(obstacles.rows) {
  if (obstacles.type() != CV_8UC1 || obstacles.empty()) {
    throw hyselam::InputError("obstacles", "", "they must be an 8 bit image with cells");
  }
  if (width_ > kMaxSide || height_ > kMaxSide) {
    throw hyselam::InputError("obstacles", "", "they have more than 32767 x 32767 cells");
  }
  const std::size_t cells = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  obstacle_.resize(cells);
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* row = obstacles.ptr<std::uint8_t>(y);
    std::transform(row, row + width_, &obstacle_[index({0, y})],
                   [](std::uint8_t v) { return v != 0 ? kObstacle : std::uint8_t{0}; });
  }
  nearest_row_.resize(cells);
  nearest_column_.resize(cells);
  squared_.resize(cells);
  changed_.resize(static_cast<std::size_t>(height_));
  parts_.resize(static_cast<std::size_t>(width_) + 1);
  rebuild();
}

void DistanceMap::setObstacle(Cell c, bool obstacle) {
  if (c.x < 0 || c.y < 0 || c.x >= width_ || c.y >= height_) return;
  std::uint8_t& value = obstacle_[index(c)];
  if ((value != 0) == obstacle) return;
  value = obstacle ? kObstacle : std::uint8_t{0};
  edited_.push_back(c);
}

double DistanceMap::distance(Cell c) const {
  const std::int32_t d = squared(c);
  return d == kFar ? std::numeric_limits<double>::infinity() : std::sqrt(static_cast<double>(d));
}

cv::Mat DistanceMap::squaredView() const {
  return cv::Mat(height_, width_, CV_32SC1, const_cast<std::int32_t*>(squared_.data()));
}

// Both sweeps go along rows, so that memory is read in order.
void DistanceMap::rebuild() {
  edited_.clear();
  for (int y = 0; y < height_; ++y) {
    std::int16_t* row = &nearest_row_[index({0, y})];
    const std::int16_t* below = y > 0 ? row - width_ : nullptr;
    const std::uint8_t* obstacle = &obstacle_[index({0, y})];
    for (int x = 0; x < width_; ++x) {
      row[x] = obstacle[x] != 0   ? static_cast<std::int16_t>(y)
               : below != nullptr ? below[x]
                                  : std::int16_t{-1};
    }
  }
  for (int y = height_ - 2; y >= 0; --y) {
    std::int16_t* row = &nearest_row_[index({0, y})];
    const std::int16_t* above = row + width_;
    for (int x = 0; x < width_; ++x) {
      // What the row above takes from itself or from below is no nearer here than what is known.
      const bool nearer = above[x] > y && (row[x] < 0 || above[x] - y < y - row[x]);
      if (nearer) row[x] = above[x];
    }
  }
  for (int y = 0; y < height_; ++y) envelope(y, 0, width_ - 1, 0, width_ - 1);
}

// The nearest obstacles in a column between two rows, of which the ones outside stay as they are.
void DistanceMap::scanColumn(int x, int from, int to) {
  const auto set = [&](int y, int row) {
    std::int16_t& value = nearest_row_[index({x, y})];
    if (value == row) return;
    value = static_cast<std::int16_t>(row);
    changed_[static_cast<std::size_t>(y)].push_back(x);
  };
  int below = from > 0 ? from - 1 : -1;  // an obstacle, or none
  for (int y = from; y <= to;) {
    int above = y;
    while (above <= to && obstacle_[index({x, above})] == 0) ++above;
    const bool has_above = above < height_;
    for (; y < above; ++y) {
      const bool takes_above = has_above && (below < 0 || above - y < y - below);
      set(y, takes_above ? above : below);
    }
    if (y <= to) {
      set(y, y);
      below = y++;
    }
  }
}

// Lower envelope of the parabolas of columns low .. high over the cells first .. last of a row
// (Meijster, Roerdink, Hesselink 2000).
void DistanceMap::envelope(int y, int first, int last, int low, int high) {
  const std::size_t start = index({0, y});
  const std::int16_t* rows = &nearest_row_[start];
  Part* parts = parts_.data();
  int top = -1;
  for (int u = low; u <= high; ++u) {
    if (rows[u] < 0) continue;
    const std::int32_t gap = square(y - rows[u]);
    while (top >= 0) {
      const Part& p = parts[top];
      if (square(p.from - p.column) + p.gap_squared <= square(p.from - u) + gap) break;
      --top;
    }
    std::int32_t from = first;
    if (top >= 0) {
      const Part& p = parts[top];
      // u is strictly nearer than p from here on; ties stay with the smaller column.
      const std::int64_t excess =
          std::int64_t{u - p.column} * (u + p.column) + gap - std::int64_t{p.gap_squared};
      const std::int64_t twice = 2 * std::int64_t{u - p.column};
      const std::int64_t limit = twice * last;
      if (excess >= limit) continue;
      from = excess <= std::numeric_limits<std::uint32_t>::max()
                 ? static_cast<std::int32_t>(static_cast<std::uint32_t>(excess) /
                                             static_cast<std::uint32_t>(twice)) +
                       1
                 : static_cast<std::int32_t>(excess / twice) + 1;
    }
    parts[++top] = {u, from, gap};
  }
  std::int16_t* columns = &nearest_column_[start];
  std::int32_t* out = &squared_[start];
  if (top < 0) {
    std::fill(columns + first, columns + last + 1, std::int16_t{-1});
    std::fill(out + first, out + last + 1, kFar);
    return;
  }
  int end = last;
  for (; top >= 0; --top) {
    const Part& p = parts[top];
    for (int x = p.from; x <= end; ++x) {
      columns[x] = static_cast<std::int16_t>(p.column);
      out[x] = square(x - p.column) + p.gap_squared;
    }
    end = p.from - 1;
  }
}

// Cells of a row that a change of columns first .. last can reach: those whose old distance is not
// less than the way to these columns. The distance falls by at most 1 from cell to cell and the way
// grows by 1, so the first cell out of reach ends the search.
RowSpan DistanceMap::affected(int y, int first, int last) const {
  const std::int32_t* d = &squared_[index({0, y})];
  RowSpan span{y, first, last};
  while (span.first > 0) {
    const std::int64_t way = first - (span.first - 1);
    if (d[span.first - 1] < way * way) break;
    --span.first;
  }
  while (span.last + 1 < width_) {
    const std::int64_t way = span.last + 1 - last;
    if (d[span.last + 1] < way * way) break;
    ++span.last;
  }
  return span;
}

std::vector<RowSpan> DistanceMap::update() {
  std::vector<RowSpan> spans;
  if (edited_.empty()) return spans;
  if (edited_.size() > obstacle_.size() / 4) {
    rebuild();
    for (int y = 0; y < height_; ++y) spans.push_back({y, 0, width_ - 1});
    return spans;
  }
  sortByColumn(edited_, width_, height_);
  // A column changes between the obstacles that enclose its edited cells.
  int lowest = height_, highest = -1;
  for (std::size_t i = 0; i < edited_.size();) {
    const int x = edited_[i].x;
    int from = edited_[i].y, to = from;
    ++i;
    while (from > 0 && obstacle_[index({x, from - 1})] == 0) --from;
    for (;;) {
      while (to + 1 < height_ && obstacle_[index({x, to + 1})] == 0) ++to;
      const int above = to + 1;  // an obstacle, perhaps a new one, or the edge of the map
      for (; i < edited_.size() && edited_[i].x == x && edited_[i].y <= above; ++i) {
        to = std::max(to, edited_[i].y);
      }
      if (to < above) break;
    }
    scanColumn(x, from, to);
    lowest = std::min(lowest, from);
    highest = std::max(highest, to);
  }
  edited_.clear();

  for (int y = lowest; y <= highest; ++y) {
    std::vector<int>& columns = changed_[static_cast<std::size_t>(y)];
    if (columns.empty()) continue;
    // Reach is judged by the old distances, so all spans are found before any is computed. Close
    // columns go together.
    const std::size_t begin = spans.size();
    for (std::size_t i = 0; i < columns.size();) {
      const int first = columns[i];
      int last = first;
      while (i < columns.size() && columns[i] <= last + 4) last = columns[i++];
      RowSpan span = affected(y, first, last);
      while (spans.size() > begin && spans.back().last + 1 >= span.first) {
        span.first = std::min(span.first, spans.back().first);
        span.last = std::max(span.last, spans.back().last);
        spans.pop_back();
      }
      spans.push_back(span);
    }
    columns.clear();
    // Nearest columns grow along a row: those of the unchanged cells beside a span bound its own.
    const std::int16_t* nearest = &nearest_column_[index({0, y})];
    for (std::size_t s = begin; s < spans.size(); ++s) {
      const RowSpan& span = spans[s];
      const int low = span.first > 0 ? std::max<int>(nearest[span.first - 1], 0) : 0;
      const int high = span.last + 1 < width_ && nearest[span.last + 1] >= 0
                           ? nearest[span.last + 1]
                           : width_ - 1;
      envelope(y, span.first, span.last, low, high);
    }
  }
  return spans;
}

std::vector<RowSpan> DistanceMap::update(const cv::Mat& obstacles) {
  if (obstacles.type() != CV_8UC1 || obstacles.cols != width_ || obstacles.rows != height_) {
    throw hyselam::InputError("obstacles", "", "they must keep their size");
  }
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* row = obstacles.ptr<std::uint8_t>(y);
    const std::uint8_t* old = &obstacle_[index({0, y})];
    constexpr int kChunk = 64;
    for (int x = 0; x < width_; x += kChunk) {
      const int end = std::min(x + kChunk, width_);
      if (std::memcmp(row + x, old + x, static_cast<std::size_t>(end - x)) == 0) continue;
      for (int u = x; u < end; ++u) {
        if ((row[u] != 0) != (old[u] != 0)) setObstacle({u, y}, row[u] != 0);
      }
    }
  }
  return update();
}

}  // namespace hyselam_topo
