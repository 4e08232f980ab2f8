#include "straight_corridors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/pose2.hpp"

namespace hyselam_topo {
namespace {

constexpr double kNarrowest = 0.9, kWidest = 4.0;  // [m]
constexpr double kLeastWall = 1.5;                 // [m] of wall on a line that is looked at
constexpr double kLeastElongation = 3.0;  // walls carry on along both sides of a room as well
constexpr int kSway = 3;                  // [cells] faces of a line lie so far from it at most
constexpr double kBlocked = 0.65;         // no corridor goes on where less of its width is free
constexpr double kCrowded = 0.85;         // nor is it likely one where less is
// Log-odds of a metre of corridor, by what stands at its sides.
constexpr double kBothWalls = 1.0, kOneWall = -0.1, kNoWall = -0.8, kCrowd = -2.0;
constexpr double kLargest = 32000.0;  // [cells] of a turned map
constexpr double kPrior = -2.5;       // log-odds of two lines before anything was seen of them

/// Cells of walls beside free ones, not more than are needed for a direction.
std::vector<cv::Point> facesOf(const cv::Mat& free, const cv::Mat& walls) {
  constexpr std::size_t kMost = 5000;
  std::vector<cv::Point> faces;
  for (int y = 1; y + 1 < free.rows; ++y) {
    const std::uint8_t* wall = walls.ptr<std::uint8_t>(y);
    const std::uint8_t *here = free.ptr<std::uint8_t>(y), *below = free.ptr<std::uint8_t>(y - 1),
                       *above = free.ptr<std::uint8_t>(y + 1);
    for (int x = 1; x + 1 < free.cols; ++x)
      if (wall[x] != 0 && (here[x - 1] | here[x + 1] | below[x] | above[x]) != 0)
        faces.emplace_back(x, y);
  }
  const std::size_t step = faces.size() / kMost + 1;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < faces.size(); i += step) faces[kept++] = faces[i];
  faces.resize(kept);
  return faces;
}

/// How well the faces lie on few lines along an angle and across it: the sum of squares of how many
/// lie on each.
double sharpness(const std::vector<cv::Point>& faces, double angle, std::vector<int>& counts) {
  const double c = std::cos(angle), s = std::sin(angle);
  const int half = static_cast<int>(counts.size()) / 4;
  std::fill(counts.begin(), counts.end(), 0);
  for (const cv::Point& p : faces) {
    ++counts[static_cast<std::size_t>(half + static_cast<int>(p.y * c - p.x * s))];
    ++counts[static_cast<std::size_t>(3 * half + static_cast<int>(p.x * c + p.y * s))];
  }
  double sum = 0.0;
  for (const int count : counts) sum += static_cast<double>(count) * count;
  return sum;
}

/// The direction along which most walls run, modulo a right angle [rad].
double mainDirection(const cv::Mat& free, const cv::Mat& walls) {
  const std::vector<cv::Point> faces = facesOf(free, walls);
  const int half = free.cols + free.rows + 2;
  std::vector<int> counts(static_cast<std::size_t>(4 * half), 0);
  double best = 0.0, most = -1.0;
  const auto tryAround = [&](double middle, double reach, double step) {
    for (double d = -reach; d < reach; d += step) {
      const double sharp = sharpness(faces, middle + d, counts);
      if (sharp > most) most = sharp, best = middle + d;
    }
  };
  tryAround(hyselam::radians(45.0), hyselam::radians(45.0), hyselam::radians(1.0));
  tryAround(best, hyselam::radians(1.0), hyselam::radians(0.2));
  return best;
}

/// What a cell of a turned map holds.
constexpr std::uint8_t kFreeCell = 1, kWallCell = 2;

/// The map turned so that corridors run along rows.
struct TurnedMap {
  cv::Mat cells;      // CV_8U
  cv::Mat from_here;  // 2 x 3, cells here to cells of the map
};

/// CV_16U, the free cells of a column in all rows before one.
cv::Mat freeBelow(const cv::Mat& cells) {
  CV_Assert(cells.rows <= std::numeric_limits<std::uint16_t>::max());
  cv::Mat below(cells.rows + 1, cells.cols, CV_16U);
  below.row(0).setTo(0);
  for (int y = 0; y < cells.rows; ++y) {
    const std::uint8_t* row = cells.ptr<std::uint8_t>(y);
    const std::uint16_t* before = below.ptr<std::uint16_t>(y);
    std::uint16_t* after = below.ptr<std::uint16_t>(y + 1);
    for (int x = 0; x < cells.cols; ++x)
      after[x] = static_cast<std::uint16_t>(before[x] + (row[x] & kFreeCell));
  }
  return below;
}

TurnedMap turn(const cv::Mat& free, const cv::Mat& walls, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const int width = static_cast<int>(std::ceil(std::abs(free.cols * c) + std::abs(free.rows * s)));
  const int height = static_cast<int>(std::ceil(std::abs(free.cols * s) + std::abs(free.rows * c)));
  // Here to there: turned by the angle about the middles.
  const double mx = 0.5 * (width - 1), my = 0.5 * (height - 1);
  const double nx = 0.5 * (free.cols - 1), ny = 0.5 * (free.rows - 1);
  TurnedMap t;
  t.from_here = (cv::Mat_<double>(2, 3) << c, -s, nx - c * mx + s * my, s, c, ny - s * mx - c * my);
  cv::Mat cells(free.size(), CV_8U);
  for (int y = 0; y < cells.rows; ++y) {
    const std::uint8_t *f = free.ptr<std::uint8_t>(y), *w = walls.ptr<std::uint8_t>(y);
    std::uint8_t* out = cells.ptr<std::uint8_t>(y);
    for (int x = 0; x < cells.cols; ++x)
      out[x] = static_cast<std::uint8_t>((f[x] & kFreeCell) | (w[x] & kWallCell));  // 0 or 255
  }
  if (angle == 0.0)
    t.cells = cells;
  else
    cv::warpAffine(cells, t.cells, t.from_here, {width, height},
                   cv::INTER_NEAREST | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT, 0);
  return t;
}

/// The same map for what runs across: turned on by a right angle, which moves whole cells.
TurnedMap turnAcross(const TurnedMap& t) {
  TurnedMap across;
  cv::rotate(t.cells, across.cells, cv::ROTATE_90_COUNTERCLOCKWISE);
  const double last = t.cells.cols - 1;  // (x, y) here is (last - y, x) there
  const auto *a = t.from_here.ptr<double>(0), *b = t.from_here.ptr<double>(1);
  across.from_here =
      (cv::Mat_<double>(2, 3) << a[1], -a[0], a[0] * last + a[2], b[1], -b[0], b[0] * last + b[2]);
  return across;
}

/// A line along rows at which faces of walls lie.
struct WallLine {
  int row;                         // of the first free cells
  std::vector<std::uint8_t> face;  // for each column
};

/// Faces whose free side has the higher rows (`up` 1) or the lower ones (-1).
std::vector<WallLine> findWallLines(const TurnedMap& map, int up, double resolution) {
  const int rows = map.cells.rows, columns = map.cells.cols;
  cv::Mat faces(rows, columns, CV_8U, cv::Scalar(0));
  std::vector<int> counts(static_cast<std::size_t>(rows), 0);
  for (int y = 2; y + 2 < rows; ++y) {
    const std::uint8_t* here = map.cells.ptr<std::uint8_t>(y);
    const std::uint8_t* behind = map.cells.ptr<std::uint8_t>(y - up);
    const std::uint8_t* further = map.cells.ptr<std::uint8_t>(y - 2 * up);
    std::uint8_t* out = faces.ptr<std::uint8_t>(y);
    int count = 0;
    for (int x = 0; x < columns; ++x) {
      const int wall = (behind[x] | further[x]) & kWallCell;
      out[x] = static_cast<std::uint8_t>(here[x] & ~behind[x] & kFreeCell & (wall / kWallCell));
      count += out[x];
    }
    counts[static_cast<std::size_t>(y)] = count;
  }
  const auto around = [&](int y) {
    const auto i = static_cast<std::size_t>(y);
    return counts[i - 1] + counts[i] + counts[i + 1];
  };
  std::vector<WallLine> lines;
  const int least = static_cast<int>(kLeastWall / resolution);
  for (int y = 3; y + 3 < rows; ++y) {
    const int here = around(y);
    if (here < least || here < around(y - 1) || here <= around(y + 1)) continue;
    const auto at = counts.begin() + y;
    const int row = y - 1 + static_cast<int>(std::max_element(at - 1, at + 2) - (at - 1));
    WallLine line{row, std::vector<std::uint8_t>(static_cast<std::size_t>(columns), 0)};
    for (int v = std::max(0, y - kSway); v <= std::min(rows - 1, y + kSway); ++v) {
      const std::uint8_t* face = faces.ptr<std::uint8_t>(v);
      for (int x = 0; x < columns; ++x) line.face[static_cast<std::size_t>(x)] |= face[x];
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

struct Run {
  int low, high;    // rows, both in it
  int first, last;  // columns, both in it
  double odds;
};

/// The runs of columns whose log-odds are highest, each with all that stands at its sides.
void findRuns(const cv::Mat& below, const WallLine& low, const WallLine& high, double resolution,
              std::vector<Run>& runs) {
  const int height = high.row - low.row + 1;
  const std::uint16_t* before = below.ptr<std::uint16_t>(low.row);
  const std::uint16_t* after = below.ptr<std::uint16_t>(high.row + 1);
  double sum = 0.0, best = 0.0;
  int start = 0, best_last = -1;
  const auto close = [&](int from) {
    if (best + kPrior > 0.0) runs.push_back({low.row, high.row, start, best_last, best + kPrior});
    sum = best = 0.0;
    start = from;
  };
  for (int x = 0; x < below.cols; ++x) {
    const double share = static_cast<double>(after[x] - before[x]) / height;
    const int sides =
        low.face[static_cast<std::size_t>(x)] + high.face[static_cast<std::size_t>(x)];
    if (share < kBlocked) {
      close(x + 1);
      continue;
    }
    const double metre = share < kCrowded ? kCrowd
                         : sides == 2     ? kBothWalls
                         : sides == 1     ? kOneWall
                                          : kNoWall;
    sum += metre * resolution;
    if (sum > best) best = sum, best_last = x;
    if (sum <= 0.0 || sum < best + kPrior) close(x + 1);
  }
  close(below.cols);
}

/// The surest first, without those that mostly cover one before them.
std::vector<Run> withoutCopies(std::vector<Run> runs) {
  std::stable_sort(runs.begin(), runs.end(),
                   [](const Run& a, const Run& b) { return a.odds > b.odds; });
  std::vector<Run> kept;
  const auto box = [](const Run& r) {
    return cv::Rect(r.first, r.low, r.last - r.first + 1, r.high - r.low + 1);
  };
  for (const Run& run : runs) {
    const bool copy = std::any_of(kept.begin(), kept.end(), [&](const Run& other) {
      return 4 * (box(run) & box(other)).area() > std::min(box(run).area(), box(other).area());
    });
    if (!copy) kept.push_back(run);
  }
  return kept;
}

cv::Point2d fromHere(const TurnedMap& map, double x, double y) {
  const auto* a = map.from_here.ptr<double>(0);
  const auto* b = map.from_here.ptr<double>(1);
  return {a[0] * x + a[1] * y + a[2], b[0] * x + b[1] * y + b[2]};
}

/// The corridors along the rows of a turned map.
void findAlongRows(const TurnedMap& map, double resolution,
                   std::vector<StraightCorridor>& corridors) {
  const std::vector<WallLine> low = findWallLines(map, 1, resolution);
  const std::vector<WallLine> high = findWallLines(map, -1, resolution);
  const cv::Mat below = freeBelow(map.cells);
  std::vector<Run> runs;
  for (const WallLine& a : low)
    for (const WallLine& b : high) {
      const double width = (b.row - a.row + 1) * resolution;
      if (width >= kNarrowest && width <= kWidest) findRuns(below, a, b, resolution, runs);
    }
  for (const Run& run : withoutCopies(std::move(runs))) {
    const double length = run.last - run.first + 1, width = run.high - run.low + 1;
    if (length < kLeastElongation * width) continue;
    const double middle = 0.5 * (run.low + run.high);
    corridors.emplace_back(fromHere(map, run.first - 0.5, middle),
                           fromHere(map, run.last + 0.5, middle), 0.5 * width, run.odds);
  }
}

}  // namespace

std::pair<int, int> StraightCorridor::columns(int row, double beyond, int width) const {
  double first = 0.0, last = width - 1.0;
  // Of the columns those with low <= slope x + offset <= high, and one more to either side.
  const auto clip = [&](double slope, double offset, double low, double high) {
    if (std::abs(slope) < 1e-6) {
      if (offset < low - 1.0 || offset > high + 1.0) last = -1.0;
      return;
    }
    const auto [a, b] = std::minmax({(low - offset) / slope, (high - offset) / slope});
    first = std::max(first, a - 1.0);
    last = std::min(last, b + 1.0);
  };
  const double up = row - start_.y;
  clip(-along_.y, along_.x * up + along_.y * start_.x, -half_width_, half_width_);
  clip(along_.x, along_.y * up - along_.x * start_.x, -beyond, length_ + beyond);
  if (last < first) return {0, 0};
  return {static_cast<int>(std::ceil(first)), static_cast<int>(std::floor(last)) + 1};
}

std::vector<StraightCorridor> findStraightCorridors(const FreeSpace& space,
                                                    const cv::Mat& furniture) {
  std::vector<StraightCorridor> corridors;
  // What OpenCV turns has sides of 16 bits: a map of 1.6 km has no corridors but its borders.
  if (std::hypot(space.free.cols, space.free.rows) >= kLargest) return corridors;
  const cv::Mat walls = space.occupied & ~furniture;
  const TurnedMap along = turn(space.free, walls, mainDirection(space.free, walls));
  findAlongRows(along, space.resolution, corridors);
  findAlongRows(turnAcross(along), space.resolution, corridors);
  std::stable_sort(
      corridors.begin(), corridors.end(),
      [](const StraightCorridor& a, const StraightCorridor& b) { return a.odds() > b.odds(); });
  return corridors;
}

}  // namespace hyselam_topo
