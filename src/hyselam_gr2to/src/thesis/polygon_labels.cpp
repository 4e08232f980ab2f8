#include "polygon_labels.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace hyselam_topo {

using hyselam::Cell;

// The part of each polygon that hangs together with its circle's centre.
PolygonLabels::PolygonLabels(const cv::Mat& open, const std::vector<Circle>& circles,
                             const std::vector<PlacePolygon>& polygons)
    : open_(open), labels_(open.size(), CV_16UC1, cv::Scalar(0)) {
  const cv::Mat owner = ownersOf(circles, polygons);
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const Cell c = circles[i].centre;
    labels_.at<std::uint16_t>(c.y, c.x) = static_cast<std::uint16_t>(i + 1);
    front_.push_back(c);
  }
  spread([&](Cell from, Cell to) {
    return owner.at<int>(to.y, to.x) == labels_.at<std::uint16_t>(from.y, from.x) - 1;
  });
}

void PolygonLabels::fill(const cv::Mat& doors) {
  restart();
  spread([](Cell, Cell) { return true; });
  restart();
  open_ = open_ | doors;
  spread([](Cell, Cell) { return true; });
}

// The polygon of each open cell, -1: none; of polygons that overlap the one whose circle is nearer.
cv::Mat PolygonLabels::ownersOf(const std::vector<Circle>& circles,
                                const std::vector<PlacePolygon>& polygons) const {
  cv::Mat owner(open_.size(), CV_32SC1, cv::Scalar(-1));
  cv::Mat nearest(open_.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::max()));
  cv::Mat mask(open_.size(), CV_8UC1, cv::Scalar(0));
  for (std::size_t i = 0; i < circles.size(); ++i) {
    std::vector<cv::Point> outline;
    for (const cv::Point2d& v : polygons[i].vertices) {
      outline.emplace_back(static_cast<int>(std::lround(v.x)), static_cast<int>(std::lround(v.y)));
    }
    const cv::Rect box = cv::boundingRect(outline) & cv::Rect(0, 0, open_.cols, open_.rows);
    if (box.empty()) continue;
    mask(box).setTo(0);
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{outline}, 255);
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) {
        if (mask.at<std::uint8_t>(y, x) == 0 || open_.at<std::uint8_t>(y, x) == 0) continue;
        const double dx = x - circles[i].centre.x, dy = y - circles[i].centre.y;
        const auto d = static_cast<float>(std::sqrt(dx * dx + dy * dy) - circles[i].radius);
        if (d >= nearest.at<float>(y, x)) continue;
        nearest.at<float>(y, x) = d;
        owner.at<int>(y, x) = static_cast<int>(i);
      }
    }
  }
  return owner;
}

void PolygonLabels::restart() {
  front_.clear();
  for (int y = 0; y < labels_.rows; ++y) {
    for (int x = 0; x < labels_.cols; ++x) {
      if (labels_.at<std::uint16_t>(y, x) != 0) front_.push_back({x, y});
    }
  }
}

template <typename Allowed>
void PolygonLabels::spread(Allowed allowed) {
  for (std::size_t i = 0; i < front_.size(); ++i) {
    const Cell c = front_[i];
    for (const Cell& n :
         {Cell{c.x + 1, c.y}, Cell{c.x - 1, c.y}, Cell{c.x, c.y + 1}, Cell{c.x, c.y - 1}}) {
      if (n.x < 0 || n.y < 0 || n.x >= open_.cols || n.y >= open_.rows) continue;
      if (open_.at<std::uint8_t>(n.y, n.x) == 0 || labels_.at<std::uint16_t>(n.y, n.x) != 0) {
        continue;
      }
      if (!allowed(c, n)) continue;
      labels_.at<std::uint16_t>(n.y, n.x) = labels_.at<std::uint16_t>(c.y, c.x);
      front_.push_back(n);
    }
  }
  front_.clear();
}

}  // namespace hyselam_topo
