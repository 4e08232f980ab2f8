#include "contours.hpp"

#include <array>

namespace hyselam_topo {
namespace {

// Per direction: the step along the side, and the cells on its left and right from its first
// corner.
struct Direction {
  int dx, dy, left_x, left_y, right_x, right_y;
};
constexpr std::array<Direction, 4> kDirections{
    {{1, 0, 0, 0, 0, -1}, {0, 1, -1, 0, 0, 0}, {-1, 0, -1, -1, -1, 0}, {0, -1, 0, -1, -1, -1}}};

const Direction& of(int direction) {
  return kDirections[static_cast<std::size_t>(direction)];
}

}  // namespace

cv::Point ContourSide::to() const {
  return {from.x + of(direction).dx, from.y + of(direction).dy};
}

cv::Point ContourSide::outside() const {
  return {from.x + of(direction).right_x, from.y + of(direction).right_y};
}

cv::Point2d ContourSide::middle() const {
  return {from.x + 0.5 * of(direction).dx, from.y + 0.5 * of(direction).dy};
}

std::vector<Contour> traceContours(const cv::Mat& labels) {
  return traceContours(labels, cv::Rect(0, 0, labels.cols, labels.rows), {});
}

std::vector<Contour> traceContours(const cv::Mat& labels, const cv::Rect& box,
                                   const std::vector<char>& wanted) {
  const auto at = [&](int x, int y) -> std::uint16_t {
    return x < 0 || y < 0 || x >= labels.cols || y >= labels.rows ? std::uint16_t{0}
                                                                  : labels.at<std::uint16_t>(y, x);
  };
  const auto left = [&](cv::Point p, int d) { return at(p.x + of(d).left_x, p.y + of(d).left_y); };
  const auto right = [&](cv::Point p, int d) {
    return at(p.x + of(d).right_x, p.y + of(d).right_y);
  };
  // By corner and direction, from the box's own corner on.
  cv::Mat walked(box.height + 1, box.width + 1, CV_8UC1, cv::Scalar(0));
  const auto mark = [&](cv::Point p) -> std::uint8_t& {
    return walked.at<std::uint8_t>(p - box.tl());
  };
  std::vector<Contour> out;
  // Every contour, around a region or a hole, has a side along +x: a cell above another label.
  const std::vector<std::uint16_t> none(static_cast<std::size_t>(labels.cols), 0);
  for (int y = box.y; y < box.y + box.height; ++y) {
    const auto* row = labels.ptr<std::uint16_t>(y);
    const auto* below = y > 0 ? labels.ptr<std::uint16_t>(y - 1) : none.data();
    for (int x = box.x; x < box.x + box.width; ++x) {
      const std::uint16_t label = row[x];
      if (label == 0 || below[x] == label) continue;
      if (!wanted.empty() && wanted[label] == 0) continue;
      if ((mark({x, y}) & 1) != 0) continue;
      Contour contour;
      contour.label = label;
      cv::Point p{x, y};
      int d = 0;
      long twice_area = 0;
      while ((mark(p) & (1 << d)) == 0) {
        mark(p) = static_cast<std::uint8_t>(mark(p) | 1 << d);
        contour.sides.push_back({p, d});
        const cv::Point q = contour.sides.back().to();
        twice_area += static_cast<long>(p.x) * q.y - static_cast<long>(q.x) * p.y;
        p = q;
        // Left first: cells that touch at a corner only are apart.
        for (const int turn : {1, 0, 3}) {
          const int next = (d + turn) % 4;
          if (left(p, next) != label || right(p, next) == label) continue;
          d = next;
          break;
        }
      }
      contour.hole = twice_area < 0;
      out.push_back(std::move(contour));
    }
  }
  return out;
}

}  // namespace hyselam_topo
