#include "ray_fans.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alongside.hpp"
#include "cell_runs.hpp"
#include "row_marks.hpp"

namespace hyselam_topo {
namespace {

constexpr double kNarrow = 0.5;     // [m] passages up to this may be gaps between rays
constexpr double kWallNear = 0.1;   // [m] an obstacle so near to a side stands there
constexpr double kThinWall = 0.35;  // [m] what is thinner between two seen spaces may be a wall

/// Log-odds that a piece is seen between rays: of each side that nobody has seen, and of each wall.
constexpr double kUnseen = 1.0, kWall = -2.0;

// Log-odds that a labelled part is no place but what few rays saw: a wedge behind a door or a
// window fills little of its rectangle, or is narrow.
constexpr double kPerShare = 6.0, kEvenShare = 0.67;   // of its limits that nobody has seen
constexpr double kPerFilled = 8.0, kEvenFilled = 0.7;  // of its smallest rectangle
constexpr double kNarrowPlace = 1.2;                   // [m] narrower ones count as wedges
constexpr double kNarrowFilled = 0.5;
constexpr double kEvenArea = 5.0;  // [m^2]

struct Sides {
  int unseen = 0, walls = 0;
  double odds() const { return kUnseen * unseen + kWall * walls; }
};

/// Of cells that are not free: what a free cell beside them tells.
enum Side : std::uint8_t { kUnseenSide = 0, kWallSide = 1, kThinSide = 2 };

cv::Mat sidesOf(const cv::Mat& free, const cv::Mat& occupied, double resolution) {
  const auto square = [&](double size) {
    const int cells = static_cast<int>(std::lround(size / resolution)) | 1;
    return cv::getStructuringElement(cv::MORPH_RECT, {cells, cells});
  };
  cv::Mat near_wall, seen, closed;
  cv::dilate(occupied, near_wall, square(2.0 * kWallNear));
  cv::bitwise_or(free, occupied, seen);
  cv::morphologyEx(seen, closed, cv::MORPH_CLOSE, square(kThinWall));
  cv::Mat sides(free.size(), CV_8U, cv::Scalar(kUnseenSide));
  sides.setTo(kThinSide, closed);
  sides.setTo(kWallSide, near_wall);
  return sides;
}

/// What stands at the sides of each piece of `cells`: cells next to it that are not free.
std::vector<Sides> sidesOf(const CellRuns& cells, const cv::Mat& free, const cv::Mat& kinds) {
  std::vector<Sides> sides(static_cast<std::size_t>(cells.pieces));
  const cv::Rect inside({0, 0}, free.size());
  for (const CellRun& run : cells.runs) {
    Sides& s = sides[static_cast<std::size_t>(run.piece)];
    const auto look = [&](int x, int y) {
      if (!inside.contains({x, y}) || free.at<std::uint8_t>(y, x) != 0) return;
      const std::uint8_t kind = kinds.at<std::uint8_t>(y, x);
      s.walls += kind == kWallSide;
      s.unseen += kind != kWallSide;
    };
    look(run.first - 1, run.y);
    look(run.last + 1, run.y);
    for (int x = run.first; x <= run.last; ++x) look(x, run.y - 1), look(x, run.y + 1);
  }
  return sides;
}

void clear(const CellRun& run, cv::Mat& free) {
  std::uint8_t* row = free.ptr<std::uint8_t>(run.y);
  std::fill(row + run.first, row + run.last + 1, std::uint8_t{0});
}

}  // namespace

void closeRayFans(cv::Mat& free, const cv::Mat& occupied, double resolution) {
  std::future<cv::Mat> kinds =
      alongside([free, &occupied, resolution] { return sidesOf(free, occupied, resolution); });
  cv::Mat wide;
  const int narrow = static_cast<int>(std::lround(kNarrow / resolution)) | 1;
  cv::morphologyEx(free, wide, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {narrow, narrow}), {-1, -1}, 1,
                   cv::BORDER_CONSTANT, 0);
  cv::Mat thin = free & ~wide;
  const CellRuns passages = connectedRuns(thin, 0, false);
  const std::vector<Sides> sides = sidesOf(passages, free, kinds.get());
  for (const CellRun& run : passages.runs)
    if (sides[static_cast<std::size_t>(run.piece)].odds() > 0.0) clear(run, free);
}

std::vector<char> findOutside(const cv::Mat& labels, int count, const cv::Mat& occupied,
                              double resolution) {
  cv::Mat free;
  cv::compare(labels, 0, free, cv::CMP_NE);
  const cv::Mat kinds = sidesOf(free, occupied, resolution);
  const auto size = static_cast<std::size_t>(count) + 1;
  std::vector<double> areas(size, 0.0), unseen(size, 0.0), walls(size, 0.0);
  std::vector<std::vector<cv::Point>> limits(size);
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(labels.cols), 0);
  for (int y = 1; y + 1 < labels.rows; ++y) {
    const int* row = labels.ptr<int>(y);
    const int *below = labels.ptr<int>(y - 1), *above = labels.ptr<int>(y + 1);
    const std::uint8_t* kind = kinds.ptr<std::uint8_t>(y);
    for (int x = 1; x + 1 < labels.cols; ++x) {
      const bool end = (row[x] != row[x - 1]) | (row[x] != row[x + 1]);
      const bool beside = (row[x] == 0) & ((below[x] | above[x]) != 0);
      marks[static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(end | beside);
    }
    int first = 0;
    eachMarked(marks, [&](int x) {
      if (row[x] != 0) {
        const auto own = static_cast<std::size_t>(row[x]);
        limits[own].emplace_back(x, y);
        if (row[x - 1] != row[x]) first = x;
        if (row[x + 1] != row[x]) areas[own] += (x - first + 1) * resolution * resolution;
        return;
      }
      if (kind[x] == kThinSide) return;
      for (const int other : {row[x - 1], row[x + 1], below[x], above[x]})
        if (other != 0)
          (kind[x] == kWallSide ? walls : unseen)[static_cast<std::size_t>(other)] += 1.0;
    });
  }
  std::vector<char> outside(size, 0);
  const auto largest =
      static_cast<std::size_t>(std::max_element(areas.begin(), areas.end()) - areas.begin());
  for (std::size_t i = 1; i < size; ++i) {
    if (i == largest || areas[i] <= 0.0) continue;
    const cv::Size2f box = cv::minAreaRect(limits[i]).size;
    const double narrow = (std::min(box.width, box.height) + 1.0) * resolution;
    const double filled =
        areas[i] / (narrow * (std::max(box.width, box.height) + 1.0) * resolution);
    const double shape = narrow < kNarrowPlace ? kNarrowFilled : filled;
    const double share = unseen[i] / (unseen[i] + walls[i] + 1e-6);
    const double odds = kPerShare * (share - kEvenShare) + kPerFilled * (kEvenFilled - shape) -
                        std::log(areas[i] / kEvenArea);
    outside[i] = odds > 0.0 ? 1 : 0;
  }
  return outside;
}

}  // namespace hyselam_topo
