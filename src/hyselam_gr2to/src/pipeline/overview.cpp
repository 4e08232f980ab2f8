#include "hyselam_gr2to/overview.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/place_paths.hpp"

namespace hyselam_topo {
namespace {

using hyselam::Point2;

const cv::Scalar kPaper(255, 255, 255), kUnknown(232, 232, 232), kInk(40, 40, 40);
const cv::Scalar kSolid(30, 30, 30), kLimit(150, 120, 90), kGlass(220, 150, 40);
const cv::Scalar kDoor(40, 140, 20), kOpenBorder(20, 120, 235), kGraph(170, 60, 40);
// Pastel colours that differ for the colour-blind too; corridors have one of their own.
const std::vector<cv::Vec3b> kColours = {
    {190, 220, 250}, {250, 215, 175}, {185, 240, 195}, {235, 190, 235}, {165, 240, 250},
    {240, 235, 170}, {190, 190, 250}, {215, 250, 215}, {250, 200, 215}, {170, 215, 225}};
const cv::Vec3b kCorridor(222, 210, 196);
constexpr int kShift = 4;
constexpr int kMargin = 24;  // [pixel]

class Canvas {
 public:
  Canvas(const hyselam::GridGeometry& geometry, cv::Rect box, double scale, int legend)
      : to_grid_(geometry.origin.inverse()),
        resolution_(geometry.resolution),
        box_(box),
        scale_(scale),
        height_(static_cast<int>(std::lround(box.height * scale))),
        image(height_ + 2 * kMargin + legend,
              static_cast<int>(std::lround(box.width * scale)) + 2 * kMargin, CV_8UC3, kPaper) {}

  cv::Point2d pixel(Point2 map_point) const {
    const Point2 p = to_grid_ * map_point;
    return {kMargin + (p.x / resolution_ - box_.x) * scale_ - 0.5,
            kMargin + height_ - (p.y / resolution_ - box_.y) * scale_ - 0.5};
  }
  void line(cv::Point2d a, cv::Point2d b, const cv::Scalar& colour, int width) {
    cv::line(image, fixed(a), fixed(b), colour, width, cv::LINE_AA, kShift);
  }
  void dashed(cv::Point2d a, cv::Point2d b, const cv::Scalar& colour, int width, double dash) {
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const int dashes = std::max(1, static_cast<int>(length / (2.0 * dash)));
    for (int i = 0; i < dashes; ++i) {
      const double from = static_cast<double>(i) / dashes, to = (i + 0.55) / dashes;
      line(a + (b - a) * from, a + (b - a) * to, colour, width);
    }
  }
  void disc(cv::Point2d p, double radius, const cv::Scalar& colour) {
    cv::circle(image, fixed(p), static_cast<int>(radius * (1 << kShift)), colour, cv::FILLED,
               cv::LINE_AA, kShift);
  }
  void text(const std::string& words, cv::Point at, double size, const cv::Scalar& colour,
            bool outlined = false) {
    const int width = std::max(1, static_cast<int>(std::lround(size * 1.6)));
    if (outlined)
      cv::putText(image, words, at, cv::FONT_HERSHEY_SIMPLEX, size, kPaper, width + 4, cv::LINE_AA);
    cv::putText(image, words, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, width, cv::LINE_AA);
  }
  static cv::Size sizeOf(const std::string& words, double size) {
    return cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, size,
                           std::max(1, static_cast<int>(std::lround(size * 1.6))), nullptr);
  }

 private:
  static cv::Point fixed(cv::Point2d p) {
    return {static_cast<int>(std::lround(p.x * (1 << kShift))),
            static_cast<int>(std::lround(p.y * (1 << kShift)))};
  }
  hyselam::Pose2 to_grid_;
  double resolution_;
  cv::Rect box_;
  double scale_;
  int height_;

 public:
  cv::Mat image;
};

/// Neighbours, and places near each other, get different colours.
std::map<Id, cv::Vec3b> color(const AugmentedTopologicalMap& map) {
  std::map<Id, std::size_t> chosen;
  std::map<Id, cv::Vec3b> colours;
  for (const Place& place : map.places) {
    if (place.kind == PlaceKind::kCorridor) {
      colours[place.id] = kCorridor;
      continue;
    }
    std::vector<double> nearest(kColours.size(), std::numeric_limits<double>::infinity());
    for (const auto& [other_id, index] : chosen) {
      const Place* other = map.findPlace(other_id);
      double far = std::numeric_limits<double>::infinity();
      if (place.centre && other->centre)
        far = std::hypot(place.centre->x - other->centre->x, place.centre->y - other->centre->y);
      if (map.findEdge(place.id, other_id) != nullptr) far = 0.0;
      nearest[index] = std::min(nearest[index], far);
    }
    // The least used of what is not near; the first that is free if any is.
    const std::size_t index = static_cast<std::size_t>(
        std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    chosen[place.id] = index;
    colours[place.id] = kColours[index];
  }
  return colours;
}

cv::Rect knownPart(const hyselam::OccupancyGrid& grid, const cv::Mat& labels) {
  cv::Mat mask;
  cv::compare(labels, 0, mask, cv::CMP_NE);
  cv::Rect box = cv::boundingRect(mask);
  if (box.empty()) return {0, 0, grid.geometry.width, grid.geometry.height};
  const int margin = std::max(4, static_cast<int>(std::lround(0.8 / grid.geometry.resolution)));
  box -= cv::Point(margin, margin);
  box += cv::Size(2 * margin, 2 * margin);
  return box & cv::Rect(0, 0, grid.geometry.width, grid.geometry.height);
}

cv::Mat floorOf(const hyselam::OccupancyGrid& grid, const Gr2ToResult& result, const cv::Rect& box,
                double scale) {
  const std::map<Id, cv::Vec3b> colours = color(result.map);
  cv::Mat cells(box.height, box.width, CV_8UC3);
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x) {
      const hyselam::Cell cell{box.x + x, box.y + y};
      const std::int8_t value = grid.at(cell);
      const int label = result.labels.at<std::uint16_t>(cell.y, cell.x);
      cv::Vec3b& out = cells.at<cv::Vec3b>(box.height - 1 - y, x);
      const auto found = colours.find(static_cast<Id>(label));
      if (value > 50)
        out = {90, 90, 90};
      else if (found != colours.end())
        out = value >= 0 ? found->second : cv::Vec3b(found->second * 0.88);
      else
        out = value < 0 ? cv::Vec3b(232, 232, 232) : cv::Vec3b(248, 248, 248);
    }
  cv::Mat out;
  cv::resize(cells, out, {}, scale, scale, scale < 1.0 ? cv::INTER_AREA : cv::INTER_NEAREST);
  return out;
}

std::string plural(std::size_t n, const std::string& word) {
  return std::to_string(n) + " " + word + (n == 1 ? "" : "s");
}

void drawWalls(const AugmentedTopologicalMap& map, Canvas& canvas, int thick) {
  for (const Place& place : map.places)
    for (const Wall& wall : place.walls) {
      const std::vector<Point2> points = polyline(wall, 0.02);
      for (std::size_t i = 1; i < points.size(); ++i) {
        const cv::Point2d a = canvas.pixel(points[i - 1]), b = canvas.pixel(points[i]);
        if (wall.kind == WallKind::kVirtual)
          canvas.line(a, b, kLimit, 1);
        else
          canvas.line(a, b, wall.kind == WallKind::kGlass ? kGlass : kSolid, thick);
      }
    }
}

void drawDoors(const AugmentedTopologicalMap& map, Canvas& canvas, int thick) {
  for (const Edge& edge : map.edges)
    for (const Door& door : edge.doors) {
      const Segment posts = ends(door);
      const cv::Point2d a = canvas.pixel(posts.first), b = canvas.pixel(posts.second);
      if (door.real) {
        canvas.line(a, b, kPaper, 2 * thick + 3);
        canvas.line(a, b, kDoor, 2 * thick);
      } else {
        canvas.dashed(a, b, kOpenBorder, thick + 1, 3.0 * thick);
      }
    }
}

/// From the middle of each place through its cells to its doors.
void drawGraph(const AugmentedTopologicalMap& map, Canvas& canvas, int thin) {
  std::map<Id, std::vector<Point2>> doors;
  for (const Edge& edge : map.edges)
    for (const Door& door : edge.doors)
      for (const Id id : {edge.a, edge.b}) doors[id].push_back({door.position.x, door.position.y});
  if (!map.grid) return;
  const std::map<Id, CellBox> boxes = placeBoxes(*map.grid);
  for (const Place& place : map.places) {
    const auto box = boxes.find(place.id);
    if (!place.centre || box == boxes.end()) continue;
    const Point2 centre{place.centre->x, place.centre->y};
    const std::vector<Point2>& goals = doors[place.id];
    const auto ways = waysWithin(*map.grid, place.id, box->second, goals, centre);
    for (std::size_t k = 0; k < ways.size(); ++k) {
      Point2 from = goals[k];
      for (const Point2& to : ways[k]) {
        canvas.line(canvas.pixel(from), canvas.pixel(to), kGraph, thin);
        from = to;
      }
    }
  }
}

void drawNames(const AugmentedTopologicalMap& map, Canvas& canvas, double size) {
  for (const Place& place : map.places) {
    if (!place.centre) continue;
    const cv::Point2d at = canvas.pixel({place.centre->x, place.centre->y});
    const std::string number = std::to_string(place.id);
    const cv::Size box = Canvas::sizeOf(number, size);
    const double radius = 0.75 * std::max(box.width, box.height) + 3.0;
    canvas.disc(at, radius + 1.5, kGraph);
    canvas.disc(at, radius, kPaper);
    canvas.text(number,
                {static_cast<int>(at.x) - box.width / 2, static_cast<int>(at.y) + box.height / 2},
                size, kInk);
    if (place.words.empty()) continue;
    const std::string& word = place.words.front().text;
    const cv::Size wide = Canvas::sizeOf(word, size);
    canvas.text(word,
                {static_cast<int>(at.x) - wide.width / 2,
                 static_cast<int>(at.y + radius) + wide.height + 6},
                size, kInk, true);
  }
}

void drawLegend(const Gr2ToResult& result, Canvas& canvas, double pixels_per_metre, int legend,
                double size, int thick) {
  std::size_t corridors = 0, doors = 0, open = 0;
  for (const Place& place : result.map.places) corridors += place.kind == PlaceKind::kCorridor;
  for (const Edge& edge : result.map.edges)
    for (const Door& door : edge.doors) ++(door.real ? doors : open);

  const int line = legend / 3;
  const int top = canvas.image.rows - legend;
  // A round length of about a fifth of the picture.
  const double wanted = canvas.image.cols / 5.0 / pixels_per_metre;
  double metres = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {5.0, 2.0})
    if (metres * step <= wanted) {
      metres *= step;
      break;
    }
  char length[32];
  std::snprintf(length, sizeof length, "%g m", metres);
  int x = kMargin;
  const int middle = top + line / 2;
  const double bar = metres * pixels_per_metre;
  canvas.line({static_cast<double>(x), static_cast<double>(middle)},
              {x + bar, static_cast<double>(middle)}, kInk, thick + 1);
  for (const double end : {static_cast<double>(x), x + bar})
    canvas.line({end, middle - 0.2 * line}, {end, middle + 0.2 * line}, kInk, thick);
  canvas.text(length, {static_cast<int>(x + bar) + 10, middle + line / 6}, size, kInk);
  const std::string counts = plural(result.map.places.size() - corridors, "room") + ", " +
                             plural(corridors, "corridor") + ", " + plural(doors, "door") + ", " +
                             plural(open, "open border");
  canvas.text(counts, {kMargin, middle + line + line / 6}, size, kInk);

  const int key_y = middle + 2 * line;
  const auto key = [&](const char* words, const auto& draw) {
    const int wide = Canvas::sizeOf(words, size).width + static_cast<int>(60 * size) + 52;
    if (x + wide > canvas.image.cols) return;  // a small picture shows the first ones
    const double sample = 40.0 * size + 10.0;
    draw(cv::Point2d(x, key_y), cv::Point2d(x + sample, key_y));
    canvas.text(words, {x + static_cast<int>(sample) + 14, key_y + line / 6}, size, kInk);
    x += wide;
  };
  key("corridor", [&](cv::Point2d a, cv::Point2d b) {
    const cv::Point2d cap(0.25 * line, 0.0);  // thick lines end round
    canvas.line(a + cap, b - cap, cv::Scalar(kCorridor[0], kCorridor[1], kCorridor[2]), line / 2);
  });
  key("wall", [&](cv::Point2d a, cv::Point2d b) { canvas.line(a, b, kSolid, thick); });
  key("door", [&](cv::Point2d a, cv::Point2d b) { canvas.line(a, b, kDoor, 2 * thick); });
  key("open border", [&](cv::Point2d a, cv::Point2d b) {
    canvas.dashed(a, b, kOpenBorder, thick + 1, 3.0 * thick);
  });
  key("graph", [&](cv::Point2d a, cv::Point2d b) {
    canvas.line(a, b, kGraph, std::max(1, thick / 2));
    canvas.disc(a, 0.14 * line + 2, kGraph);
    canvas.disc(b, 0.14 * line + 2, kGraph);
  });
}

}  // namespace

void OverviewOptions::describe(hyselam::ParameterVisitor& visit) {
  visit("side", side, hyselam::Range::between(200, 10000), "pixel", "longer side, about");
  visit("graph", graph, "the graph of places through their doors");
  visit("walls", walls, "walls");
}

void OverviewOptions::validate() const {
  hyselam::checkParameters(*this);
}

cv::Mat drawOverview(const hyselam::OccupancyGrid& grid, const Gr2ToResult& result,
                     const OverviewOptions& options) {
  options.validate();
  const cv::Rect box = knownPart(grid, result.labels);
  const double scale = static_cast<double>(options.side) / std::max(box.width, box.height);
  const double text = std::max(0.35, options.side / 2600.0);
  const int thick = std::max(1, static_cast<int>(std::lround(options.side / 650.0)));
  const int legend = static_cast<int>(120 * text) + 12;
  Canvas canvas(grid.geometry, box, scale, legend);
  const cv::Mat floor = floorOf(grid, result, box, scale);
  const cv::Rect to(kMargin, kMargin, std::min(floor.cols, canvas.image.cols - kMargin),
                    std::min(floor.rows, canvas.image.rows - kMargin));
  floor(cv::Rect(0, 0, to.width, to.height)).copyTo(canvas.image(to));
  if (options.walls) drawWalls(result.map, canvas, thick);
  if (options.graph) drawGraph(result.map, canvas, std::max(1, thick / 2));
  drawDoors(result.map, canvas, thick);
  drawNames(result.map, canvas, text * 0.9);
  drawLegend(result, canvas, scale / grid.geometry.resolution, legend, text, thick);
  return canvas.image;
}

}  // namespace hyselam_topo
