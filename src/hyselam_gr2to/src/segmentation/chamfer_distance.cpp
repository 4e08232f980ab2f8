#include "chamfer_distance.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace hyselam_topo {
namespace {

// Steps in 16 bits behind the point, as OpenCV rounds them (Borgefors 1986).
constexpr int kShift = 16;
constexpr int fixed(float length) {
  return static_cast<int>(length * (1 << kShift) + 0.5f);
}
constexpr int kStraight = fixed(1.0f), kSlanting = fixed(1.4f), kKnight = fixed(2.1969f);
constexpr int kFar = std::numeric_limits<int>::max() >> 2;
constexpr int kRim = 2;  // cells that are read around the mask

struct FreeCells {
  int begin, end;
};

/// The runs of cells of a row that are not 0, whatever they are: found in blocks, twice for each
/// row, where connectedRuns() asks every cell for its value.
void runsOf(const std::uint8_t* row, int width, std::vector<FreeCells>& runs) {
  runs.clear();
  for (int x = 0; x < width;) {
    while (x < width && row[x] == 0) ++x;
    if (x == width) return;
    const auto* zero = static_cast<const std::uint8_t*>(
        std::memchr(row + x, 0, static_cast<std::size_t>(width - x)));
    const int end = zero == nullptr ? width : static_cast<int>(zero - row);
    runs.push_back({x, end});
    x = end;
  }
}

/// The least that the two rows on one side give a run of cells, the nearer one first.
void comeFrom(const int* near, const int* far, FreeCells run, int* cells) {
  for (int x = run.begin; x < run.end; ++x) {
    const int knight =
        std::min(std::min(near[x - 2], near[x + 2]), std::min(far[x - 1], far[x + 1]));
    const int slanting = std::min(near[x - 1], near[x + 1]);
    const int least =
        std::min(std::min(knight + kKnight, slanting + kSlanting), near[x] + kStraight);
    cells[x] = std::min(cells[x], least);
  }
}

}  // namespace

cv::Mat chamferDistance(const cv::Mat& mask) {
  CV_Assert(mask.type() == CV_8U);
  const int width = mask.cols, height = mask.rows;
  cv::Mat distance(mask.size(), CV_32F, cv::Scalar(0));
  cv::Mat cells(height + 2 * kRim, width + 2 * kRim, CV_32S, cv::Scalar(0));
  cells.rowRange(0, kRim).setTo(kFar);
  cells.rowRange(height + kRim, height + 2 * kRim).setTo(kFar);
  cells.colRange(0, kRim).setTo(kFar);
  cells.colRange(width + kRim, width + 2 * kRim).setTo(kFar);
  const auto row = [&cells](int y) { return cells.ptr<int>(y + kRim) + kRim; };
  std::vector<FreeCells> runs;
  for (int y = 0; y < height; ++y) {
    runsOf(mask.ptr<std::uint8_t>(y), width, runs);
    int* own = row(y);
    for (const FreeCells run : runs) {
      std::fill(own + run.begin, own + run.end, kFar);
      comeFrom(row(y - 1), row(y - 2), run, own);
      for (int x = run.begin; x < run.end; ++x) own[x] = std::min(own[x], own[x - 1] + kStraight);
    }
  }
  constexpr float kScale = 1.0f / (1 << kShift);
  for (int y = height - 1; y >= 0; --y) {
    runsOf(mask.ptr<std::uint8_t>(y), width, runs);
    int* own = row(y);
    float* out = distance.ptr<float>(y);
    for (const FreeCells run : runs) {
      comeFrom(row(y + 1), row(y + 2), run, own);
      for (int x = run.end - 1; x >= run.begin; --x)
        own[x] = std::min(own[x], own[x + 1] + kStraight);
      for (int x = run.begin; x < run.end; ++x) out[x] = static_cast<float>(own[x]) * kScale;
    }
  }
  return distance;
}

}  // namespace hyselam_topo
