#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/rng.hpp"
#include "hyselam_gr2to/thesis/thesis.hpp"

namespace hyselam_topo {
namespace {

const cv::Scalar kRed(40, 40, 220), kBlue(220, 80, 30), kCyan(220, 200, 0), kBlack(0, 0, 0),
    kYellow(0, 215, 255), kGreen(60, 180, 60);

// Small maps are drawn larger, so that lines and circles can be told apart.
class Canvas {
 public:
  explicit Canvas(const hyselam::OccupancyGrid& grid)
      : scale_(std::max(1, 1200 / std::max(grid.geometry.width, grid.geometry.height))) {
    cv::Mat small(grid.geometry.height, grid.geometry.width, CV_8UC3);
    for (int y = 0; y < small.rows; ++y) {
      for (int x = 0; x < small.cols; ++x) {
        const int v = grid.at({x, y});
        const auto grey = static_cast<std::uint8_t>(v < 0 ? 205 : 254 - 254 * v / 100);
        small.at<cv::Vec3b>(y, x) = {grey, grey, grey};
      }
    }
    cv::resize(small, image_, {}, scale_, scale_, cv::INTER_NEAREST);
  }
  cv::Point at(cv::Point2d cell) const {
    return {static_cast<int>(std::lround((cell.x + 0.5) * scale_)),
            static_cast<int>(std::lround((cell.y + 0.5) * scale_))};
  }
  cv::Point at(hyselam::Cell c) const { return at(cv::Point2d(c.x, c.y)); }
  void circle(cv::Point2d c, double radius, const cv::Scalar& color, int thickness = 2) {
    cv::circle(image_, at(c), std::max(2, static_cast<int>(std::lround(radius * scale_))), color,
               thickness, cv::LINE_AA);
  }
  void line(cv::Point a, cv::Point b, const cv::Scalar& color, int thickness = 2) {
    cv::line(image_, a, b, color, thickness, cv::LINE_AA);
  }
  // Mixes a color into the cells of a mask.
  void tint(const cv::Mat& mask, const cv::Scalar& color, double share) {
    cv::Mat large, tinted;
    cv::resize(mask, large, image_.size(), 0, 0, cv::INTER_NEAREST);
    cv::addWeighted(image_, 1.0 - share, cv::Mat(image_.size(), CV_8UC3, color), share, 0.0,
                    tinted);
    tinted.copyTo(image_, large);
  }
  cv::Mat finish() const {
    cv::Mat out;
    cv::flip(image_, out, 0);
    return out;
  }
  cv::Mat& image() { return image_; }
  int scale() const { return scale_; }

 private:
  int scale_;
  cv::Mat image_;
};

cv::Scalar colorOf(std::size_t place) {
  const std::uint64_t h = hyselam::splitmix64(place * 7919);
  cv::Mat hsv(1, 1, CV_8UC3,
              cv::Scalar(static_cast<double>(h % 180), 90.0 + static_cast<double>(h >> 8 & 63),
                         200.0 + static_cast<double>(h >> 16 & 55)));
  cv::cvtColor(hsv, hsv, cv::COLOR_HSV2BGR);
  const cv::Vec3b c = hsv.at<cv::Vec3b>(0, 0);
  return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
}

void drawDoors(const ThesisResult& r, Canvas& canvas) {
  for (const ConfirmedDoor& d : r.doors) {
    canvas.line(canvas.at(d.critical.basis_a), canvas.at(d.critical.basis_b), kBlue, 3);
  }
}

}  // namespace

cv::Mat drawThesis(const ThesisResult& r, ThesisStage stage) {
  Canvas canvas(r.filtered);
  switch (stage) {
    case ThesisStage::kDistance: {
      cv::Mat squared, grey, large;
      r.squared_distance.convertTo(squared, CV_32F);
      squared.setTo(0.0, r.squared_distance == DistanceMap::kFar);
      cv::sqrt(squared, squared);
      cv::normalize(squared, grey, 0, 255, cv::NORM_MINMAX, CV_8U);
      cv::resize(grey, large, canvas.image().size(), 0, 0, cv::INTER_NEAREST);
      cv::cvtColor(large, canvas.image(), cv::COLOR_GRAY2BGR);
      break;
    }
    case ThesisStage::kCandidates: {
      for (const cv::Point2d& c : r.candidates) canvas.circle(c, 4.0, kRed);
      drawDoors(r, canvas);
      break;
    }
    case ThesisStage::kVoronoi: {
      canvas.tint(r.voronoi, kRed, 1.0);
      break;
    }
    case ThesisStage::kCircles: {
      for (const auto& [i, j] : r.links) {
        canvas.line(canvas.at(r.circles[i].centre), canvas.at(r.circles[j].centre), kBlack);
      }
      for (const Circle& c : r.circles) {
        canvas.circle(cv::Point2d(c.centre.x, c.centre.y), c.radius, kRed);
      }
      for (const CriticalPoint& p : r.critical_points) {
        canvas.line(canvas.at(p.basis_a), canvas.at(p.basis_b), kGreen, 1);
        canvas.circle(cv::Point2d(p.at.x, p.at.y), 1.5, kYellow, cv::FILLED);
      }
      for (const ConfirmedDoor& d : r.doors) {
        canvas.circle(cv::Point2d(d.critical.at.x, d.critical.at.y), 3.0, kCyan);
      }
      break;
    }
    case ThesisStage::kPlaces: {
      for (std::size_t k = 0; k < r.circles.size(); ++k) {
        canvas.tint(r.segmentation.labels == static_cast<int>(k + 1), colorOf(k), 0.7);
      }
      for (const PlacePolygon& p : r.polygons) {
        for (std::size_t k = 0; k < 8; ++k) {
          canvas.line(canvas.at(p.vertices[k]), canvas.at(p.vertices[(k + 1) % 8]), kBlack,
                      p.wall[k] ? 2 : 1);
        }
      }
      drawDoors(r, canvas);
      break;
    }
  }
  return canvas.finish();
}

}  // namespace hyselam_topo
