#include "hyselam_scan_matching/correlative_matcher.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_scan_matching {

namespace {

using hyselam::ParameterError;
using hyselam::Range;

constexpr int kLevels = 7;  // the largest square has 64 cells a side
constexpr double kMaxCellScore = 255.0;
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
        cells_(static_cast<int>(
            std::ceil(matcher.params_.linear_window / matcher.params_.resolution))) {
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
            {static_cast<int>(std::floor((guess.x + c * p.x - s * p.y - matcher.x0_) / r)),
             static_cast<int>(std::floor((guess.y + s * p.x + c * p.y - matcher.y0_) / r))});
      }
      headings_.push_back(std::move(h));
    }
  }

  std::optional<CorrelativeMatch> run(double min_score, const ExcludedCircle* excluded) {
    best_sum_ = static_cast<int>(std::ceil(min_score * points_ * kMaxCellScore)) - 1;
    int level = 0;
    while (level + 1 < kLevels && (1 << (level + 1)) <= cells_) ++level;
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

  int bound(int level, const Candidate& c) const {
    int sum = 0;
    for (const Cell& cell : headings_[c.heading].cells) {
      sum += matcher_.at(level, cell.x + c.dx, cell.y + c.dy);
    }
    return sum;
  }

  /// The squares of a level that cover the window, the best bounds first.
  std::vector<Candidate> squaresOf(int level) const {
    std::vector<Candidate> squares;
    for (std::size_t h = 0; h < headings_.size(); ++h) {
      for (int dy = -cells_; dy <= cells_; dy += 1 << level) {
        for (int dx = -cells_; dx <= cells_; dx += 1 << level) {
          Candidate c{h, dx, dy, 0};
          c.bound = bound(level, c);
          squares.push_back(c);
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
  rasterize(map);
  buildPyramid();
}

void CorrelativeMatcher::rasterize(const SurfaceMap& map) {
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
  const double columns = (x1 - x0_ + params_.max_distance) / r + 2.0;
  const double rows = (y1 - y0_ + params_.max_distance) / r + 2.0;
  if (columns * rows > static_cast<double>(kMaxCells)) {
    throw ParameterError("resolution", r, "coarser: the map has too many cells");
  }
  width_ = static_cast<int>(columns);
  height_ = static_cast<int>(rows);
  Level base;
  base.cells.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
  const int reach = static_cast<int>(std::ceil(params_.max_distance / r));
  for (const SurfacePoint& p : map.points()) {
    const int cx = static_cast<int>((p.x - x0_) / r), cy = static_cast<int>((p.y - y0_) / r);
    for (int y = std::max(0, cy - reach); y <= std::min(height_ - 1, cy + reach); ++y) {
      for (int x = std::max(0, cx - reach); x <= std::min(width_ - 1, cx + reach); ++x) {
        const double dx = x0_ + (x + 0.5) * r - p.x, dy = y0_ + (y + 0.5) * r - p.y;
        const double part =
            2.0 * (dx * dx + dy * dy) / (params_.max_distance * params_.max_distance);
        if (part >= 2.0) continue;
        const double rounded = 0.5 + kMaxCellScore * std::exp(-2.0 * part);
        const auto value = static_cast<std::uint8_t>(rounded);
        std::uint8_t& cell =
            base.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                       static_cast<std::size_t>(x)];
        cell = std::max(cell, value);
      }
    }
  }
  levels_.push_back(std::move(base));
}

/// Each level from the one before: the maximum of four squares of half its size. Squares reach
/// beyond the upper and right border, where all is 0, and begin beyond the lower and left one: see
/// at().
void CorrelativeMatcher::buildPyramid() {
  for (int level = 1; level < kLevels; ++level) {
    const int half = 1 << (level - 1), pad = (1 << level) - 1;
    const int w = width_ + pad, h = height_ + pad;
    Level next;
    next.cells.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const int gx = x - pad, gy = y - pad;  // lower left corner of the square
        next.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
                   static_cast<std::size_t>(x)] =
            std::max({at(level - 1, gx, gy), at(level - 1, gx + half, gy),
                      at(level - 1, gx, gy + half), at(level - 1, gx + half, gy + half)});
      }
    }
    levels_.push_back(std::move(next));
  }
}

std::uint8_t CorrelativeMatcher::at(int level, int x, int y) const {
  const int pad = (1 << level) - 1;
  const int px = x + pad, py = y + pad, w = width_ + pad;
  if (px < 0 || py < 0 || px >= w || py >= height_ + pad) return 0;
  return levels_[static_cast<std::size_t>(level)]
      .cells[static_cast<std::size_t>(py) * static_cast<std::size_t>(w) +
             static_cast<std::size_t>(px)];
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
