#include "free_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "hyselam_common/coarsen.hpp"
#include "ray_fans.hpp"

namespace hyselam_topo {
namespace {

constexpr std::int8_t kOccupiedFrom = 50;  // unknown may be seen through, a likely obstacle not
constexpr double kDensityWindow = 0.35;    // [m]
constexpr double kLeak = 0.15;             // [m] passages up to this are gaps between rays
constexpr double kWalled = 0.2;            // [share] of the limits of free space, at least
constexpr double kLargestWorking = 20e6;   // [cells] above that, coarse grids are not resampled
constexpr double kSameResolution = 1.02;   // times the working one, taken for it

int odd(double cells) {
  return std::max(1, static_cast<int>(std::lround(cells)) | 1);
}

struct Masks {
  cv::Mat free;
  cv::Mat occupied;
};

/// Cut out to the free cells, with a margin so that filters see the walls around them.
Masks cutOut(const hyselam::OccupancyGrid& grid, int free_max, int margin, cv::Point& origin) {
  const int width = grid.geometry.width, height = grid.geometry.height;
  const cv::Mat cells(height, width, CV_8S, const_cast<std::int8_t*>(grid.cells.data()));
  cv::Mat known, low;
  cv::compare(cells, 0, known, cv::CMP_GE);
  cv::compare(cells, free_max, low, cv::CMP_LE);
  cv::bitwise_and(known, low, low);
  const cv::Rect box = cv::boundingRect(low);
  Masks masks;
  if (box.empty()) return masks;
  origin = {box.x - margin, box.y - margin};
  cv::copyMakeBorder(low(box), masks.free, margin, margin, margin, margin, cv::BORDER_CONSTANT, 0);
  // The outermost walls lie outside of the free cells' box.
  masks.occupied = cv::Mat(masks.free.size(), CV_8U, cv::Scalar(0));
  const cv::Rect seen = cv::Rect(origin, masks.free.size()) & cv::Rect({0, 0}, cells.size());
  cv::compare(cells(seen), kOccupiedFrom, masks.occupied(seen - origin), cv::CMP_GE);
  return masks;
}

/// Some maps show walls and what was not seen by one value. There, all that is not free is wall.
void tellWallsFromUnseen(const cv::Mat& free, cv::Mat& occupied) {
  cv::Mat rim, wall;
  cv::dilate(free, rim, {});
  rim -= free;
  cv::dilate(occupied, wall, {});
  wall &= rim;
  if (cv::countNonZero(wall) < kWalled * cv::countNonZero(rim)) occupied = ~free;
}

/// Each cell that of the mask at its middle: so toGrid() finds every cell's own again. (OpenCV's
/// nearest neighbour looks at the corner; that of the middle is newer than Noetic's version.)
cv::Mat resampled(const cv::Mat& mask, double factor) {
  const auto size = [factor](int cells) { return static_cast<int>(std::ceil(cells * factor)); };
  cv::Mat out(size(mask.rows), size(mask.cols), CV_8U);
  const auto source = [factor](int cell, int cells) {
    return std::min(cells - 1, static_cast<int>(std::floor((cell + 0.5) / factor)));
  };
  std::vector<int> columns(static_cast<std::size_t>(out.cols));
  for (int x = 0; x < out.cols; ++x) columns[static_cast<std::size_t>(x)] = source(x, mask.cols);
  for (int y = 0; y < out.rows; ++y) {
    const std::uint8_t* from = mask.ptr<std::uint8_t>(source(y, mask.rows));
    std::uint8_t* to = out.ptr<std::uint8_t>(y);
    for (int x = 0; x < out.cols; ++x) to[x] = from[columns[static_cast<std::size_t>(x)]];
  }
  return out;
}

void findPieces(FreeSpace& space) {
  const CellRuns cells = connectedRuns(space.free, 255, true);
  space.pieces.resize(static_cast<std::size_t>(cells.pieces));
  std::vector<std::size_t> counts(space.pieces.size(), 0);
  for (const CellRun& run : cells.runs) {
    const auto piece = static_cast<std::size_t>(run.piece);
    ++counts[piece];
    space.pieces[piece].cells += run.last - run.first + 1;
    space.pieces[piece].box |= cv::Rect(run.first, run.y, run.last - run.first + 1, 1);
  }
  std::size_t next = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    space.pieces[i].begin = space.pieces[i].end = next;
    next += counts[i];
  }
  space.solid.resize(next);
  for (const CellRun& run : cells.runs)
    space.solid[space.pieces[static_cast<std::size_t>(run.piece)].end++] = run;
}

/// Pieces of furniture up to `clutter` across, standing free, are seen through.
void seeThroughClutter(FreeSpace& space, double clutter) {
  const cv::Rect inner(1, 1, space.free.cols - 2, space.free.rows - 2);
  for (const SolidPiece& piece : space.pieces) {
    if ((piece.box & inner) != piece.box) continue;  // what is around a tiny map
    if (std::hypot(piece.box.width, piece.box.height) * space.resolution > clutter) continue;
    for (std::size_t i = piece.begin; i < piece.end; ++i) {
      const CellRun& run = space.solid[i];
      std::uint8_t* row = space.free.ptr<std::uint8_t>(run.y);
      std::fill(row + run.first, row + run.last + 1, std::uint8_t{255});
    }
  }
}

void clean(FreeSpace& space, const cv::Mat& occupied) {
  cv::Mat& free = space.free;
  const double resolution = space.resolution;
  // Lonely cells are noise. Now, or they would make the gap to the next wall look like a leak; one
  // more solid neighbour is allowed for pairs of them.
  cv::Mat around;
  cv::boxFilter(free, around, -1, {3, 3}, {-1, -1}, true, cv::BORDER_CONSTANT);
  constexpr int kMean = 255 * 13 / 18;
  cv::compare(around, kMean, around, cv::CMP_GT);
  cv::bitwise_or(free, around, free);

  // Where a map was seen by few rays, free and unknown cells mingle: the majority decides.
  cv::Mat density;
  const int window = odd(kDensityWindow / resolution);
  cv::boxFilter(free, density, -1, {window, window}, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::compare(density, 127, density, cv::CMP_GT);
  density.setTo(0, occupied);
  cv::bitwise_or(free, density, free);

  const int leak = std::max(1, static_cast<int>(std::lround(kLeak / resolution)));
  cv::morphologyEx(free, free, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_RECT, {leak, leak}), {-1, -1}, 1,
                   cv::BORDER_CONSTANT, 0);
  cv::rectangle(free, {0, 0}, {free.cols - 1, free.rows - 1}, 0);
}

}  // namespace

FreeSpace findFreeSpace(const hyselam::OccupancyGrid& grid, const SegmentationParams& params,
                        bool without_ray_fans) {
  FreeSpace space;
  space.resolution = grid.geometry.resolution;
  space.joined =
      hyselam::coarseningFactor(grid.geometry.resolution, params.working_resolution * 1.25);
  const hyselam::OccupancyGrid* source = &grid;
  hyselam::OccupancyGrid joined;
  if (space.joined > 1) {
    joined = hyselam::coarsen(grid, space.joined);
    source = &joined;
    space.resolution *= space.joined;
  }
  Masks masks = cutOut(*source, params.free_max, 8, space.origin);
  if (masks.free.empty()) return space;
  // To the resolution that lengths in cells and the border model were made for. Finer grids are
  // left as they are, since thin walls would be lost.
  const double split = space.resolution / params.working_resolution;
  if (split > kSameResolution &&
      static_cast<double>(masks.free.total()) * split * split <= kLargestWorking) {
    space.resampled = split;
    space.resolution = params.working_resolution;
    for (cv::Mat* mask : {&masks.free, &masks.occupied}) *mask = resampled(*mask, split);
  }
  space.free = masks.free;
  clean(space, masks.occupied);
  tellWallsFromUnseen(space.free, masks.occupied);
  space.occupied = masks.occupied;
  if (without_ray_fans) {
    space.closed = space.free.clone();
    closeRayFans(space.free, space.occupied, space.resolution);
    space.closed -= space.free;
  }
  findPieces(space);
  seeThroughClutter(space, params.max_clutter_size);
  return space;
}

cv::Mat toGrid(const cv::Mat& labels, const FreeSpace& space, const hyselam::OccupancyGrid& grid,
               int free_max, int reach) {
  const int width = grid.geometry.width, height = grid.geometry.height;
  cv::Mat out(height, width, CV_16U, cv::Scalar(0));
  const auto working = [&space](int cell, int origin) {
    return static_cast<int>(std::floor(((cell + 0.5) / space.joined - origin) * space.resampled));
  };
  const auto rowOf = [&](int y) { return working(y, space.origin.y); };
  std::vector<int> columns(static_cast<std::size_t>(width));
  for (int x = 0; x < width; ++x) columns[static_cast<std::size_t>(x)] = working(x, space.origin.x);
  for (int y = 0; y < height; ++y) {
    const int row = rowOf(y);
    if (row < 0 || row >= labels.rows) continue;
    const int* from = labels.ptr<int>(row);
    std::uint16_t* to = out.ptr<std::uint16_t>(y);
    if (space.resampled == 1.0 && space.joined == 1) {  // most maps, worth a loop of its own
      const int begin = std::max(0, space.origin.x);
      const int end = std::min(width, labels.cols + space.origin.x);
      for (int x = begin; x < end; ++x)
        to[x] = static_cast<std::uint16_t>(from[x - space.origin.x]);
      continue;
    }
    for (int x = 0; x < width; ++x) {
      const int column = columns[static_cast<std::size_t>(x)];
      if (column >= 0 && column < labels.cols) to[x] = static_cast<std::uint16_t>(from[column]);
    }
  }
  const auto isFree = [&](int x, int y) {
    const std::int8_t cell = grid.at({x, y});
    if (cell < 0 || cell > free_max) return false;
    const int row = rowOf(y);
    const int column = columns[static_cast<std::size_t>(x)];
    const bool inside =
        row >= 0 && row < space.closed.rows && column >= 0 && column < space.closed.cols;
    return !inside || space.closed.at<std::uint8_t>(row, column) == 0;
  };
  std::vector<cv::Point> front, next;
  const std::array<cv::Point, 4> around{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  const auto grow = [&](cv::Point p) {
    for (const cv::Point d : around) {
      const cv::Point q = p + d;
      if (q.x < 0 || q.y < 0 || q.x >= width || q.y >= height) continue;
      if (out.at<std::uint16_t>(q) != 0 || !isFree(q.x, q.y)) continue;
      out.at<std::uint16_t>(q) = out.at<std::uint16_t>(p);
      next.push_back(q);
    }
  };
  for (int y = 0; y < height; ++y) {
    const std::uint16_t* row = out.ptr<std::uint16_t>(y);
    for (int x = 0; x < width; ++x) {
      if (row[x] == 0) continue;
      const bool edge = (x > 0 && row[x - 1] == 0) || (x + 1 < width && row[x + 1] == 0) ||
                        (y > 0 && out.at<std::uint16_t>(y - 1, x) == 0) ||
                        (y + 1 < height && out.at<std::uint16_t>(y + 1, x) == 0);
      if (edge) front.emplace_back(x, y);
    }
  }
  for (int step = 0; step < reach && !front.empty(); ++step) {
    next.clear();
    for (const cv::Point p : front) grow(p);
    front.swap(next);
  }
  return out;
}

}  // namespace hyselam_topo
