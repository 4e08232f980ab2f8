#include "hyselam_scan_matching/search.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_scan_matching {

namespace {

using hyselam::ParameterError;
using hyselam::Range;

constexpr int kLevels = 7;  // the largest square has 64 cells a side
constexpr double kFull = 255.0;
constexpr std::size_t kMaxCells = std::size_t{1} << 26;

struct Cell {
  int x, y;
};

/// The scan turned to one heading, in cells of the grid, for the guess's position.
struct Turned {
  double theta;
  std::vector<Cell> cells;
};

struct Candidate {
  std::size_t heading;
  int dx, dy;  // offset of the square's lower left corner [cells]
  int bound;   // sum of cells: not less than any in the square
};

}  // namespace

void SearchParams::describe(hyselam::ParameterVisitor& visit) {
  visit("resolution", resolution, Range::above(0.0), "m", "of positions and of the grid of scores");
  visit("reach", reach, Range::above(0.0), "m",
        "distance from a surface at which a point scores 0");
  visit("window", window, Range::above(0.0), "m", "positions searched around the guess, each axis");
  visit("turn", turn, Range::between(0.0, hyselam::kPi), "rad",
        "headings searched around that of the guess");
  visit("least_score", least_score, Range::between(0.0, 1.0), "", "smallest score of a result");
}

void SearchParams::validate() const {
  hyselam::checkParameters(*this);
}

SearchGrid::SearchGrid(const SurfaceMap& map, const SearchParams& params) : params_(params) {
  params.validate();
  if (map.empty()) return;
  const double r = params.resolution;
  double x1 = map.points()[0].x, y1 = map.points()[0].y;
  x0_ = x1;
  y0_ = y1;
  for (const SurfacePoint& p : map.points()) {
    x0_ = std::min(x0_, p.x);
    y0_ = std::min(y0_, p.y);
    x1 = std::max(x1, p.x);
    y1 = std::max(y1, p.y);
  }
  x0_ -= params.reach + r;
  y0_ -= params.reach + r;
  const double columns = (x1 - x0_ + params.reach) / r + 2.0;
  const double rows = (y1 - y0_ + params.reach) / r + 2.0;
  if (columns * rows > static_cast<double>(kMaxCells))
    throw ParameterError("resolution", r, "coarser: the map has too many cells");
  width_ = static_cast<int>(columns);
  height_ = static_cast<int>(rows);
  Level base;
  base.cells.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
  const int reach = static_cast<int>(std::ceil(params.reach / r));
  for (const SurfacePoint& p : map.points()) {
    const int cx = static_cast<int>((p.x - x0_) / r), cy = static_cast<int>((p.y - y0_) / r);
    for (int y = std::max(0, cy - reach); y <= std::min(height_ - 1, cy + reach); ++y) {
      for (int x = std::max(0, cx - reach); x <= std::min(width_ - 1, cx + reach); ++x) {
        const double dx = x0_ + (x + 0.5) * r - p.x, dy = y0_ + (y + 0.5) * r - p.y;
        const double part = 2.0 * (dx * dx + dy * dy) / (params.reach * params.reach);
        if (part >= 2.0) continue;
        const double rounded = 0.5 + kFull * std::exp(-2.0 * part);
        const auto value = static_cast<std::uint8_t>(rounded);
        std::uint8_t& cell =
            base.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                       static_cast<std::size_t>(x)];
        cell = std::max(cell, value);
      }
    }
  }
  levels_.push_back(std::move(base));
  // Each level from the one before: the larger of four squares half its size. Squares reach beyond
  // the upper and right border, where all is 0, and begin beyond the lower and left one: at()
  // knows.
  for (int level = 1; level < kLevels; ++level) {
    const int half = 1 << (level - 1), pad = (1 << level) - 1;
    const int w = width_ + pad, h = height_ + pad;
    Level next;
    next.cells.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const int gx = x - pad, gy = y - pad;  // lower left corner of the square
        next.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
                   static_cast<std::size_t>(x)] =
            std::max({at(level - 1, gx, gy), at(level - 1, gx + half, gy),
                      at(level - 1, gx, gy + half), at(level - 1, gx + half, gy + half)});
      }
    levels_.push_back(std::move(next));
  }
}

std::uint8_t SearchGrid::at(int level, int x, int y) const {
  const int pad = (1 << level) - 1;
  const int px = x + pad, py = y + pad, w = width_ + pad;
  if (px < 0 || py < 0 || px >= w || py >= height_ + pad) return 0;
  return levels_[static_cast<std::size_t>(level)]
      .cells[static_cast<std::size_t>(py) * static_cast<std::size_t>(w) +
             static_cast<std::size_t>(px)];
}

std::optional<Found> SearchGrid::search(const SurfacePoints& scan,
                                        const hyselam::Pose2& guess) const {
  return search(scan, guess, params_.least_score, nullptr);
}

std::optional<Found> SearchGrid::rival(const SurfacePoints& scan, const hyselam::Pose2& guess,
                                       const hyselam::Pose2& best, double apart,
                                       double least_score) const {
  const Apart zone{(best.x - guess.x) / params_.resolution, (best.y - guess.y) / params_.resolution,
                   apart / params_.resolution};
  return search(scan, guess, least_score, &zone);
}

std::optional<Found> SearchGrid::search(const SurfacePoints& scan, const hyselam::Pose2& guess,
                                        double least_score, const Apart* apart) const {
  if (scan.empty() || levels_.empty()) return std::nullopt;
  const double r = params_.resolution;
  double far = 1.0;
  for (const SurfacePoint& p : scan) far = std::max(far, std::hypot(p.x, p.y));
  // A step of heading moves the farthest point by a cell.
  const double step = std::max(r / far, 0.002);
  const int turns = static_cast<int>(std::ceil(params_.turn / step));
  const int cells = static_cast<int>(std::ceil(params_.window / r));
  std::vector<Turned> headings;
  for (int t = -turns; t <= turns; ++t) {
    Turned h{guess.theta + t * step, {}};
    const double c = std::cos(h.theta), s = std::sin(h.theta);
    h.cells.reserve(scan.size());
    for (const SurfacePoint& p : scan)
      h.cells.push_back({static_cast<int>(std::floor((guess.x + c * p.x - s * p.y - x0_) / r)),
                         static_cast<int>(std::floor((guess.y + s * p.x + c * p.y - y0_) / r))});
    headings.push_back(std::move(h));
  }
  const auto bound = [&](int level, const Candidate& c) {
    int sum = 0;
    for (const Cell& cell : headings[c.heading].cells)
      sum += at(level, cell.x + c.dx, cell.y + c.dy);
    return sum;
  };
  const auto better = [](const Candidate& a, const Candidate& b) {
    if (a.bound != b.bound) return a.bound > b.bound;
    if (a.heading != b.heading) return a.heading < b.heading;
    return a.dy != b.dy ? a.dy < b.dy : a.dx < b.dx;
  };
  // All positions of a square are too near if its four corners are.
  const auto within = [](const Apart& zone, int of_level, const Candidate& c) {
    const int side = (1 << of_level) - 1;
    const double dx = std::max(std::abs(c.dx - zone.x), std::abs(c.dx + side - zone.x));
    const double dy = std::max(std::abs(c.dy - zone.y), std::abs(c.dy + side - zone.y));
    return std::hypot(dx, dy) <= zone.radius;
  };
  int level = 0;
  while (level + 1 < kLevels && (1 << (level + 1)) <= cells) ++level;
  std::vector<Candidate> first;
  for (std::size_t h = 0; h < headings.size(); ++h)
    for (int dy = -cells; dy <= cells; dy += 1 << level)
      for (int dx = -cells; dx <= cells; dx += 1 << level) {
        Candidate c{h, dx, dy, 0};
        c.bound = bound(level, c);
        first.push_back(c);
      }
  std::sort(first.begin(), first.end(), better);

  const auto points = static_cast<double>(scan.size());
  int best_sum = static_cast<int>(std::ceil(least_score * points * kFull)) - 1;
  std::optional<Candidate> best;
  struct Open {
    int level;
    Candidate candidate;
  };
  std::vector<Open> stack;
  for (const Candidate& start : first) {
    if (start.bound <= best_sum) break;
    stack.push_back({level, start});
    while (!stack.empty()) {
      const Open open = stack.back();
      stack.pop_back();
      if (open.candidate.bound <= best_sum) continue;
      if (apart != nullptr && within(*apart, open.level, open.candidate)) continue;
      if (open.level == 0) {
        best_sum = open.candidate.bound;
        best = open.candidate;
        continue;
      }
      const int half = 1 << (open.level - 1);
      std::vector<Candidate> parts;
      for (int qy = 0; qy < 2; ++qy)
        for (int qx = 0; qx < 2; ++qx) {
          Candidate c{open.candidate.heading, open.candidate.dx + qx * half,
                      open.candidate.dy + qy * half, 0};
          if (c.dx > cells || c.dy > cells) continue;
          c.bound = bound(open.level - 1, c);
          if (c.bound > best_sum) parts.push_back(c);
        }
      std::sort(parts.begin(), parts.end(), better);
      for (auto it = parts.rbegin(); it != parts.rend(); ++it)
        stack.push_back({open.level - 1, *it});
    }
  }
  if (!best) return std::nullopt;
  return Found{{guess.x + best->dx * r, guess.y + best->dy * r,
                hyselam::normalizeAngle(headings[best->heading].theta)},
               best_sum / (points * kFull)};
}

}  // namespace hyselam_scan_matching
