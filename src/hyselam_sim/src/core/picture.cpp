#include "hyselam_sim/picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"

namespace hyselam_sim {
namespace {

const cv::Scalar kOutside(225, 225, 225), kFloor(255, 255, 255), kWall(40, 40, 40);
const cv::Scalar kFurniture(150, 190, 215), kDoor(60, 130, 30), kShutDoor(40, 40, 200);
const cv::Scalar kWay(200, 80, 220), kStart(0, 190, 240), kEnd(220, 90, 20), kName(120, 60, 0);
constexpr double kNameWidth = 3.2;  // [m]
constexpr int kShift = 4;           // fixed-point digits of OpenCV's drawing functions

class Canvas {
 public:
  Canvas(const FloorPlan& plan, const PictureOptions& options) : plan_(plan) {
    const double side = std::max(plan.size.x, plan.size.y);
    scale_ = std::min(options.pixels_per_meter, options.max_side / side);
    image =
        cv::Mat(std::max(1, static_cast<int>(std::ceil(plan.size.y * scale_))),
                std::max(1, static_cast<int>(std::ceil(plan.size.x * scale_))), CV_8UC3, kOutside);
  }

  cv::Point2d pixel(Point2 p) const {
    return {(p.x - plan_.origin.x) * scale_, image.rows - (p.y - plan_.origin.y) * scale_};
  }
  /// Middle of a pixel.
  Point2 meters(int row, int column) const {
    return {plan_.origin.x + (column + 0.5) / scale_,
            plan_.origin.y + (image.rows - row - 0.5) / scale_};
  }
  cv::Point fixed(Point2 p) const {
    const cv::Point2d q = pixel(p);
    return {static_cast<int>(std::lround((q.x - 0.5) * (1 << kShift))),
            static_cast<int>(std::lround((q.y - 0.5) * (1 << kShift)))};
  }
  void fill(const Polygon& outline, const cv::Scalar& color) {
    std::vector<cv::Point> points;
    for (const Point2& p : outline) points.push_back(fixed(p));
    cv::fillPoly(image, std::vector<std::vector<cv::Point>>{points}, color, cv::LINE_AA, kShift);
  }
  void line(Point2 a, Point2 b, const cv::Scalar& color, int width) {
    cv::line(image, fixed(a), fixed(b), color, width, cv::LINE_AA, kShift);
  }
  void disc(Point2 p, double radius_px, const cv::Scalar& color) {
    cv::circle(image, fixed(p), static_cast<int>(radius_px * (1 << kShift)), color, cv::FILLED,
               cv::LINE_AA, kShift);
  }
  void name(Point2 p, const std::string& text) {
    // At most as wide as a small room.
    double size = std::clamp(scale_ / 45.0, 0.3, 1.0);
    const int wide = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, nullptr).width;
    size = std::max(0.3, size * std::min(1.0, kNameWidth * scale_ / wide));
    const cv::Size box = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, nullptr);
    const cv::Point at(static_cast<int>(pixel(p).x) - box.width / 2,
                       static_cast<int>(pixel(p).y) - box.height / 2);
    cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kFloor, 4, cv::LINE_AA);
    cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kName, 1, cv::LINE_AA);
  }
  double scale() const { return scale_; }

  cv::Mat image;

 private:
  const FloorPlan& plan_;
  double scale_ = 1.0;
};

void drawFloor(const FloorPlan& plan, Canvas& canvas) {
  RasterOptions options;
  options.resolution = std::max(0.05, 1.0 / canvas.scale());
  options.with_furniture = false;
  const hyselam::OccupancyGrid grid = rasterize(plan, options);
  for (int row = 0; row < canvas.image.rows; ++row) {
    for (int column = 0; column < canvas.image.cols; ++column) {
      const hyselam::Cell c = grid.geometry.cellAt(canvas.meters(row, column));
      if (grid.valueOr(c) != hyselam::OccupancyGrid::kUnknown) {
        canvas.image.at<cv::Vec3b>(row, column) = cv::Vec3b(255, 255, 255);
      }
    }
  }
}

void drawWay(const std::vector<hyselam::StampedPose2>& way, Canvas& canvas) {
  const auto point = [&](std::size_t i) { return Point2{way[i].pose.x, way[i].pose.y}; };
  double since_arrow = 2.0;
  Point2 last = point(0);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Point2 p = point(i);
    const double step = length(p - last);
    if (step > 0.5) {
      const int dashes = static_cast<int>(step / 0.4);
      for (int k = 0; k < dashes; k += 2) {
        canvas.line(last + (double(k) / dashes) * (p - last),
                    last + (double(k + 1) / dashes) * (p - last), cv::Scalar(170, 170, 170), 1);
      }
    } else if (step < 0.03) {
      continue;  // less than a pixel
    } else {
      canvas.line(last, p, kWay, 2);
      since_arrow += step;
      if (since_arrow > 4.0) {
        since_arrow = 0.0;
        const Point2 u = (1.0 / step) * (p - last), n{-u.y, u.x};
        canvas.fill({p + 0.3 * u, p - 0.2 * u + 0.18 * n, p - 0.2 * u - 0.18 * n}, kWall);
      }
    }
    last = p;
  }
  // The start as a star, the end as a disc, as in figure 3.4 of Maffei (2017).
  Polygon star;
  for (int k = 0; k < 10; ++k) {
    const double radius = k % 2 == 0 ? 0.6 : 0.25, angle = hyselam::kPi * (0.5 + k / 5.0);
    star.push_back(point(0) + radius * Point2{std::cos(angle), std::sin(angle)});
  }
  canvas.fill(star, kStart);
  canvas.disc(point(way.size() - 1), 0.35 * canvas.scale(), kEnd);
}

}  // namespace

void PictureOptions::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("pixels_per_meter", pixels_per_meter, Range::above(0.0), "1/m",
        "reduced for plans that would exceed max_side");
  visit("max_side", max_side, Range::any(), "pixel", "of a picture");
  visit("time", time, Range::any(), "s", "at which the doors are drawn");
}

void PictureOptions::validate() const {
  hyselam::checkParameters(*this);
}

cv::Mat drawPicture(const FloorPlan& plan, const std::vector<hyselam::StampedPose2>& way,
                    const PictureOptions& options) {
  options.validate();
  Canvas canvas(plan, options);
  drawFloor(plan, canvas);
  for (const Solid& body : solids(plan, options.time)) {
    switch (body.kind) {
      case Solid::Kind::kWall:
        canvas.fill(body.outline, kWall);
        break;
      case Solid::Kind::kFurniture:
        canvas.fill(body.outline, kFurniture);
        break;
      case Solid::Kind::kDoor:
        canvas.fill(body.outline, plan.doors[body.index].isOpen(options.time) ? kDoor : kShutDoor);
        break;
    }
  }
  if (!way.empty()) drawWay(way, canvas);
  for (const PlanPlace& place : plan.places) {
    canvas.disc(place.at, 0.1 * canvas.scale(), kName);
    canvas.name(place.at, place.name);
  }
  return canvas.image;
}

void savePicture(const std::string& path, const cv::Mat& picture) {
  hyselam::replaceFileAtomically(path, [&](const std::string& temporary) {
    bool written = false;
    try {
      written = cv::imwrite(temporary, picture);
    } catch (const cv::Exception&) {
      throw hyselam::InputError(path, "", "no picture format has this extension");
    }
    if (!written) throw hyselam::InputError(path, "", "the picture cannot be written");
  });
}

}  // namespace hyselam_sim
