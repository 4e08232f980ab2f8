#include "hyselam_scan_matching/correlative_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_scan_matching {

namespace {

using hyselam::ParameterError;
using hyselam::Range;

constexpr int kLevels = 7;  // the largest square has 64 cells a side
constexpr double kMaxCellScore = 255.0;
constexpr int kFullScore = 255;
constexpr std::size_t kBoundBlock = 32;  // points between two looks at what is still possible
constexpr std::size_t kMaxCells = std::size_t{1} << 26;
constexpr double kMinHeadingStep = 0.002;  // [rad]

struct Cell {
  int x, y;
};

/// The scan rotated to one heading, in cells of the grid, at the guess's position.
struct RotatedScan {
  double theta;
  std::vector<Cell> cells;
};

struct Candidate {
  std::size_t heading;
  int dx, dy;  // offset of the square's lower left corner [cells]
  int bound;   // sum of cells: not less than any in the square
};

/// A circle of positions that are excluded [cells from the guess].
struct ExcludedCircle {
  double x, y, radius;
};

/// Of the window, each way.
int windowCells(const CorrelativeMatcherParams& p) {
  return static_cast<int>(std::ceil(p.linear_window / p.resolution));
}

/// The level that a search begins at: of the largest squares that the window holds.
int topLevel(int window_cells) {
  int level = 0;
  while (level + 1 < kLevels && (1 << (level + 1)) <= window_cells) ++level;
  return level;
}

bool isBetter(const Candidate& a, const Candidate& b) {
  if (a.bound != b.bound) return a.bound > b.bound;
  if (a.heading != b.heading) return a.heading < b.heading;
  return a.dy != b.dy ? a.dy < b.dy : a.dx < b.dx;
}

/// Whether all positions of a square are excluded: those of its four corners are.
bool isExcluded(const ExcludedCircle& circle, int level, const Candidate& c) {
  const int side = (1 << level) - 1;
  const double dx = std::max(std::abs(c.dx - circle.x), std::abs(c.dx + side - circle.x));
  const double dy = std::max(std::abs(c.dy - circle.y), std::abs(c.dy + side - circle.y));
  return std::hypot(dx, dy) <= circle.radius;
}

}  // namespace

/// One search by branch and bound.
class WindowSearch {
 public:
  WindowSearch(const CorrelativeMatcher& matcher, const SurfacePoints& scan,
               const hyselam::Pose2& guess)
      : matcher_(matcher),
        guess_(guess),
        points_(static_cast<double>(scan.size())),
        cells_(windowCells(matcher.params_)) {
    const double r = matcher.params_.resolution;
    double farthest = 1.0;
    for (const SurfacePoint& p : scan) farthest = std::max(farthest, std::hypot(p.x, p.y));
    // A step of heading moves the farthest point by a cell.
    const double step = std::max(r / farthest, kMinHeadingStep);
    const int steps = static_cast<int>(std::ceil(matcher.params_.angular_window / step));
    for (int t = -steps; t <= steps; ++t) {
      RotatedScan h{guess.theta + t * step, {}};
      const double c = std::cos(h.theta), s = std::sin(h.theta);
      h.cells.reserve(scan.size());
      for (const SurfacePoint& p : scan) {
        h.cells.push_back(
            {static_cast<int>(std::floor((guess.x + c * p.x - s * p.y - matcher.x0_) / r)) -
                 matcher.left_,
             static_cast<int>(std::floor((guess.y + s * p.x + c * p.y - matcher.y0_) / r)) -
                 matcher.low_});
      }
      headings_.push_back(std::move(h));
    }
  }

  std::optional<CorrelativeMatch> run(double min_score, const ExcludedCircle* excluded) {
    best_sum_ = static_cast<int>(std::ceil(min_score * points_ * kMaxCellScore)) - 1;
    const int level = topLevel(cells_);
    for (const Candidate& start : squaresOf(level)) {
      if (start.bound <= best_sum_) break;
      descend(level, start, excluded);
    }
    if (!best_) return std::nullopt;
    const double r = matcher_.params_.resolution;
    return CorrelativeMatch{{guess_.x + best_->dx * r, guess_.y + best_->dy * r,
                             hyselam::normalizeAngle(headings_[best_->heading].theta)},
                            best_sum_ / (points_ * kMaxCellScore)};
  }

 private:
  struct Open {
    int level;
    Candidate candidate;
  };

  /// Not less than the score of any position of a square. Where that cannot exceed the best one,
  /// any number that does not is told: the rest of the points is not looked up.
  int bound(int level, const Candidate& c) const {
    const CorrelativeMatcher::Level& grid = matcher_.levels_[static_cast<std::size_t>(level)];
    const int pad = (1 << level) - 1;
    const auto width = static_cast<unsigned>(matcher_.width_ + pad);
    const auto height = static_cast<unsigned>(matcher_.height_ + pad);
    const int dx = c.dx + pad, dy = c.dy + pad;
    const std::vector<Cell>& cells = headings_[c.heading].cells;
    const std::uint8_t* scores = grid.cells.data();
    int sum = 0;
    for (std::size_t begin = 0; begin < cells.size(); begin += kBoundBlock) {
      const std::size_t end = std::min(cells.size(), begin + kBoundBlock);
      for (std::size_t i = begin; i < end; ++i) {
        // Below the grid is far above it in unsigned numbers.
        const auto x = static_cast<unsigned>(cells[i].x + dx);
        const auto y = static_cast<unsigned>(cells[i].y + dy);
        if (x < width && y < height) sum += scores[std::size_t{y} * width + x];
      }
      if (sum + static_cast<int>(cells.size() - end) * kFullScore <= best_sum_) return best_sum_;
    }
    return sum;
  }

  /// bound() of the squares in kSide rows and columns that cover the window, in the order of rows.
  /// Nothing if none of them can exceed the best one.
  static constexpr int kSide = 4;
  using Bounds = std::array<int, kSide * kSide>;
  std::optional<Bounds> bounds(int level, std::size_t heading) const {
    const int side = 1 << level, pad = side - 1;
    const int width = matcher_.width_ + pad, height = matcher_.height_ + pad;
    const std::uint8_t* scores = matcher_.levels_[static_cast<std::size_t>(level)].cells.data();
    const std::vector<Cell>& cells = headings_[heading].cells;
    Bounds sums{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const int x = cells[i].x - cells_ + pad, y = cells[i].y - cells_ + pad;
      const bool inside = x >= 0 && x + (kSide - 1) * side < width;
      for (int row = 0; row < kSide; ++row) {
        const int at_y = y + row * side;
        if (at_y < 0 || at_y >= height) continue;
        const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(at_y) * width + x;
        int* sum = sums.data() + row * kSide;
        for (int column = 0; column < kSide; ++column) {
          const int at_x = x + column * side;
          if (inside || (at_x >= 0 && at_x < width)) sum[column] += scores[from + column * side];
        }
      }
      if ((i + 1) % kBoundBlock == 0) {
        const int most = *std::max_element(sums.begin(), sums.end());
        if (most + static_cast<int>(cells.size() - i - 1) * kFullScore <= best_sum_) return {};
      }
    }
    return sums;
  }

  /// The squares of a level that cover the window, the best bounds first.
  std::vector<Candidate> squaresOf(int level) const {
    std::vector<Candidate> squares;
    const int side = 1 << level, across = 2 * cells_ / side + 1;
    for (std::size_t h = 0; h < headings_.size(); ++h) {
      std::optional<Bounds> together;
      if (across == kSide && !(together = bounds(level, h))) continue;
      for (int row = 0; row < across; ++row) {
        for (int column = 0; column < across; ++column) {
          Candidate c{h, column * side - cells_, row * side - cells_, 0};
          c.bound = together ? (*together)[static_cast<std::size_t>(row * kSide + column)]
                             : bound(level, c);
          if (c.bound > best_sum_) squares.push_back(c);
        }
      }
    }
    std::sort(squares.begin(), squares.end(), isBetter);
    return squares;
  }

  /// Depth first, the best quarter of a square before the others.
  void descend(int level, const Candidate& start, const ExcludedCircle* excluded) {
    std::vector<Open> stack = {{level, start}};
    while (!stack.empty()) {
      const Open open = stack.back();
      stack.pop_back();
      if (open.candidate.bound <= best_sum_) continue;
      if (excluded != nullptr && isExcluded(*excluded, open.level, open.candidate)) continue;
      if (open.level == 0) {
        best_sum_ = open.candidate.bound;
        best_ = open.candidate;
        continue;
      }
      const int half = 1 << (open.level - 1);
      std::vector<Candidate> quarters;
      for (int qy = 0; qy < 2; ++qy) {
        for (int qx = 0; qx < 2; ++qx) {
          Candidate c{open.candidate.heading, open.candidate.dx + qx * half,
                      open.candidate.dy + qy * half, 0};
          if (c.dx > cells_ || c.dy > cells_) continue;
          c.bound = bound(open.level - 1, c);
          if (c.bound > best_sum_) quarters.push_back(c);
        }
      }
      std::sort(quarters.begin(), quarters.end(), isBetter);
      for (auto it = quarters.rbegin(); it != quarters.rend(); ++it) {
        stack.push_back({open.level - 1, *it});
      }
    }
  }

  const CorrelativeMatcher& matcher_;
  const hyselam::Pose2 guess_;
  const double points_;  ///< of the scan
  const int cells_;      ///< of the window, each way
  std::vector<RotatedScan> headings_;
  int best_sum_ = 0;
  std::optional<Candidate> best_;
};

void CorrelativeMatcherParams::describe(hyselam::ParameterVisitor& visit) {
  visit("resolution", resolution, Range::above(0.0), "m", "of positions and of the grid of scores");
  visit("max_distance", max_distance, Range::above(0.0), "m",
        "distance from the nearest surface at which the score of a point is 0");
  visit("linear_window", linear_window, Range::above(0.0), "m",
        "positions searched around the guess, each axis");
  visit("angular_window", angular_window, Range::between(0.0, hyselam::kPi), "rad",
        "headings searched around that of the guess");
  visit("min_score", min_score, Range::between(0.0, 1.0), "", "matches below are not reported");
}

void CorrelativeMatcherParams::validate() const {
  hyselam::checkParameters(*this);
}

CorrelativeMatcher::CorrelativeMatcher(const SurfaceMap& map,
                                       const CorrelativeMatcherParams& params)
    : params_(params) {
  params.validate();
  if (map.empty()) return;
  rasterize(map, nullptr);
  buildPyramid();
}

CorrelativeMatcher::CorrelativeMatcher(const SurfaceMap& map,
                                       const CorrelativeMatcherParams& params,
                                       const SurfacePoints& scan, const hyselam::Pose2& guess)
    : params_(params) {
  params.validate();
  if (map.empty()) return;
  double farthest = 0.0;
  for (const SurfacePoint& p : scan) farthest = std::max(farthest, std::hypot(p.x, p.y));
  // The largest squares reach beyond the window.
  const int cells = windowCells(params) + (1 << topLevel(windowCells(params))) + 2;
  const Surroundings needed{guess.x, guess.y, farthest + cells * params.resolution};
  rasterize(map, &needed);
  buildPyramid();
}

namespace {

/// The score of a point so far from a surface: `part` is 2 (distance / max_distance)^2, below 2.
std::uint8_t scoreAt(double part) {
  const double rounded = 0.5 + kMaxCellScore * std::exp(-2.0 * part);
  return static_cast<std::uint8_t>(rounded);
}

/// scoreAt() by steps of `part`: where both ends of a step have the same score, all between do.
class ScoreTable {
 public:
  ScoreTable() {
    for (std::size_t i = 0; i <= kSteps; ++i) ends_[i] = scoreAt(static_cast<double>(i) / kPerPart);
  }
  std::uint8_t at(double part) const {
    const auto i = static_cast<std::size_t>(part * kPerPart);
    return ends_[i] == ends_[i + 1] ? ends_[i] : scoreAt(part);
  }

 private:
  static constexpr std::size_t kSteps = 8192;
  static constexpr double kPerPart = kSteps / 2.0;
  std::array<std::uint8_t, kSteps + 1> ends_{};
};

}  // namespace

void CorrelativeMatcher::rasterize(const SurfaceMap& map, const Surroundings* needed) {
  static const ScoreTable scores;
  const double r = params_.resolution;
  double x1 = map.points()[0].x, y1 = map.points()[0].y;
  x0_ = x1;
  y0_ = y1;
  for (const SurfacePoint& p : map.points()) {
    x0_ = std::min(x0_, p.x);
    y0_ = std::min(y0_, p.y);
    x1 = std::max(x1, p.x);
    y1 = std::max(y1, p.y);
  }
  x0_ -= params_.max_distance + r;
  y0_ -= params_.max_distance + r;
  double columns = (x1 - x0_ + params_.max_distance) / r + 2.0;
  double rows = (y1 - y0_ + params_.max_distance) / r + 2.0;
  if (needed != nullptr) {  // whole cells are left out at each side
    const auto cut = [&](double from, double middle, int* first, double* count) {
      const double low = std::floor((middle - needed->reach - from) / r);
      const double high = std::floor((middle + needed->reach - from) / r);
      const double begin = std::clamp(low, 0.0, *count - 1.0);
      *count = std::clamp(high, begin, *count - 1.0) - begin + 1.0;
      *first = static_cast<int>(begin);
    };
    cut(x0_, needed->x, &left_, &columns);
    cut(y0_, needed->y, &low_, &rows);
  }
  if (columns * rows > static_cast<double>(kMaxCells)) {
    throw ParameterError("resolution", r, "coarser: the map has too many cells");
  }
  width_ = static_cast<int>(columns);
  height_ = static_cast<int>(rows);
  Level base;
  base.cells.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
  const int reach = static_cast<int>(std::ceil(params_.max_distance / r));
  for (const SurfacePoint& p : map.points()) {
    const int cx = static_cast<int>((p.x - x0_) / r) - left_,
              cy = static_cast<int>((p.y - y0_) / r) - low_;
    for (int y = std::max(0, cy - reach); y <= std::min(height_ - 1, cy + reach); ++y) {
      for (int x = std::max(0, cx - reach); x <= std::min(width_ - 1, cx + reach); ++x) {
        const double dx = x0_ + (x + left_ + 0.5) * r - p.x, dy = y0_ + (y + low_ + 0.5) * r - p.y;
        const double part =
            2.0 * (dx * dx + dy * dy) / (params_.max_distance * params_.max_distance);
        if (part >= 2.0) continue;
        std::uint8_t& cell =
            base.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                       static_cast<std::size_t>(x)];
        cell = std::max(cell, scores.at(part));
      }
    }
  }
  levels_.push_back(std::move(base));
}

/// Each level from the one before: the maximum of four squares of half its size. Squares reach
/// beyond the upper and right border, where all is 0, and begin as far beyond the lower and left
/// one.
void CorrelativeMatcher::buildPyramid() {
  const int top = topLevel(windowCells(params_));
  for (int level = 1; level <= top; ++level) {
    const std::size_t half = std::size_t{1} << (level - 1);
    const std::size_t w = static_cast<std::size_t>(width_) + half - 1,
                      h = levels_.back().cells.size() / w;
    const std::size_t wide = w + half, high = h + half;
    const std::uint8_t* from = levels_.back().cells.data();
    Level next;
    next.cells.assign(wide * high, 0);
    const auto raise = [](const std::uint8_t* values, std::size_t n, std::uint8_t* to) {
      for (std::size_t i = 0; i < n; ++i) to[i] = std::max(to[i], values[i]);
    };
    // Along the rows in place, then along the columns from the last row on, which changes nothing
    // that is still to be read.
    for (std::size_t y = 0; y < h; ++y) {
      std::uint8_t* row = next.cells.data() + y * wide;
      std::copy(from + y * w, from + (y + 1) * w, row);
      raise(from + y * w, w, row + half);
    }
    for (std::size_t y = high; y-- > half;) {
      raise(next.cells.data() + (y - half) * wide, wide, next.cells.data() + y * wide);
    }
    levels_.push_back(std::move(next));
  }
}

std::optional<CorrelativeMatch> CorrelativeMatcher::match(const SurfacePoints& scan,
                                                          const hyselam::Pose2& guess) const {
  if (scan.empty() || levels_.empty()) return std::nullopt;
  return WindowSearch(*this, scan, guess).run(params_.min_score, nullptr);
}

std::optional<CorrelativeMatch> CorrelativeMatcher::secondBest(const SurfacePoints& scan,
                                                               const hyselam::Pose2& guess,
                                                               const hyselam::Pose2& best,
                                                               double min_distance,
                                                               double min_score) const {
  if (scan.empty() || levels_.empty()) return std::nullopt;
  const double r = params_.resolution;
  const ExcludedCircle near{(best.x - guess.x) / r, (best.y - guess.y) / r, min_distance / r};
  return WindowSearch(*this, scan, guess).run(min_score, &near);
}

}  // namespace hyselam_scan_matching
