#include "furniture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace hyselam_topo {
namespace {

constexpr double kLargest = 3.0;            // [m] across
constexpr double kThin = 0.3, kLong = 0.8;  // [m] of pieces of wall

bool isPieceOfWall(const SolidPiece& piece, const FreeSpace& space) {
  std::vector<cv::Point> ends;
  for (std::size_t i = piece.begin; i < piece.end; ++i) {
    const CellRun& run = space.solid[i];
    ends.emplace_back(run.first, run.y);
    ends.emplace_back(run.last, run.y);
  }
  const cv::Size2f size = cv::minAreaRect(ends).size;
  const double thin = (std::min(size.width, size.height) + 1.0) * space.resolution;
  const double length = (std::max(size.width, size.height) + 1.0) * space.resolution;
  return thin <= kThin && length >= kLong;
}

}  // namespace

cv::Mat findFurniture(const FreeSpace& space) {
  cv::Mat furniture(space.free.size(), CV_8U, cv::Scalar(0));
  const cv::Rect inner(1, 1, furniture.cols - 2, furniture.rows - 2);
  for (const SolidPiece& piece : space.pieces) {
    if ((piece.box & inner) != piece.box) continue;
    if (std::hypot(piece.box.width, piece.box.height) * space.resolution > kLargest) continue;
    if (isPieceOfWall(piece, space)) continue;
    for (std::size_t i = piece.begin; i < piece.end; ++i) {
      const CellRun& run = space.solid[i];
      std::uint8_t* row = furniture.ptr<std::uint8_t>(run.y);
      std::fill(row + run.first, row + run.last + 1, std::uint8_t{255});
    }
  }
  return furniture;
}

}  // namespace hyselam_topo
