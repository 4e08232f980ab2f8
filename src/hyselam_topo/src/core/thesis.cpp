#include "hyselam_topo/thesis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/require.hpp"
#include "hyselam_topo/door_candidates.hpp"
#include "hyselam_topo/doors.hpp"

namespace hyselam_topo {

using cv::Point2d;
using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;

namespace {

constexpr std::size_t kMaxPlaces = 65535;  // 16 bit labels

void check(const ThesisParams& p) {
  hyselam::require("door_min", p.door_min, p.door_min > 0.0, "> 0 m");
  hyselam::require("door_max", p.door_max, p.door_max > p.door_min, "> door_min");
  hyselam::require("critical_radius", p.critical_radius, p.critical_radius > 0.0, "> 0 m");
  hyselam::require("wall_share", p.wall_share, p.wall_share >= 0.0 && p.wall_share <= 1.0,
                   "0 .. 1");
  hyselam::require("occupied_min", p.occupied_min, p.occupied_min > p.free_max, "> free_max");
}

void check(const OccupancyGrid& grid) {
  if (grid.geometry.width <= 0 || grid.geometry.height <= 0 ||
      grid.cells.size() != grid.geometry.cellCount()) {
    throw hyselam::InputError("grid map", "", "its cells do not fit its size");
  }
  if (std::max(grid.geometry.width, grid.geometry.height) > DistanceMap::kMaxSide) {
    throw hyselam::InputError("grid map", "", "a side has more than 32767 cells");
  }
  if (!(grid.geometry.resolution > 0.0)) {
    throw hyselam::InputError("grid map", "", "its resolution is not positive");
  }
}

cv::Point toPoint(Cell c) {
  return {c.x, c.y};
}

// Labels of the free cells: see segmentation below.
class Labeller {
 public:
  Labeller(const cv::Mat& open, std::size_t places)
      : open_(open), labels_(open.size(), CV_16UC1, cv::Scalar(0)), places_(places) {}

  // The part of each polygon that hangs together with its circle's centre; of polygons that overlap
  // the one whose circle is nearer.
  void seed(const std::vector<Circle>& circles, const std::vector<PlacePolygon>& polygons) {
    cv::Mat owner(open_.size(), CV_32SC1, cv::Scalar(-1));
    cv::Mat nearest(open_.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::max()));
    cv::Mat mask(open_.size(), CV_8UC1, cv::Scalar(0));
    for (std::size_t i = 0; i < places_; ++i) {
      std::vector<cv::Point> outline;
      for (const Point2d& v : polygons[i].vertices) {
        outline.emplace_back(static_cast<int>(std::lround(v.x)),
                             static_cast<int>(std::lround(v.y)));
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
    for (std::size_t i = 0; i < places_; ++i) {
      const Cell c = circles[i].centre;
      labels_.at<std::uint16_t>(c.y, c.x) = static_cast<std::uint16_t>(i + 1);
      front_.push_back(c);
    }
    spread([&](Cell from, Cell to) {
      return owner.at<int>(to.y, to.x) == labels_.at<std::uint16_t>(from.y, from.x) - 1;
    });
  }

  // All open cells that can be reached go to the place from which the way is shortest; then the
  // doors themselves.
  void fill(const cv::Mat& doors) {
    restart();
    spread([](Cell, Cell) { return true; });
    restart();
    open_ = open_ | doors;
    spread([](Cell, Cell) { return true; });
  }

  const cv::Mat& labels() const { return labels_; }

 private:
  void restart() {
    front_.clear();
    for (int y = 0; y < labels_.rows; ++y) {
      for (int x = 0; x < labels_.cols; ++x) {
        if (labels_.at<std::uint16_t>(y, x) != 0) front_.push_back({x, y});
      }
    }
  }
  template <typename Allowed>
  void spread(Allowed allowed) {
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

  cv::Mat open_;
  cv::Mat labels_;
  std::size_t places_;
  std::vector<Cell> front_;
};

// The labels that a door separates: the first ones that are met on either side of its middle.
std::pair<int, int> sidesOf(const ConfirmedDoor& door, const cv::Mat& labels) {
  const Point2d a = toPoint(door.critical.basis_a), b = toPoint(door.critical.basis_b);
  const double l = std::max(1e-9, std::hypot(b.x - a.x, b.y - a.y));
  const Point2d across{-(b.y - a.y) / l, (b.x - a.x) / l}, middle = 0.5 * (a + b);
  const auto first = [&](double sign) {
    for (double s = 1.5; s < 12.0; s += 0.5) {
      const Point2d p = middle + sign * s * across;
      const int x = static_cast<int>(std::lround(p.x)), y = static_cast<int>(std::lround(p.y));
      if (x < 0 || y < 0 || x >= labels.cols || y >= labels.rows) return 0;
      if (labels.at<std::uint16_t>(y, x) != 0) return int{labels.at<std::uint16_t>(y, x)};
    }
    return 0;
  };
  const int p = first(1.0), q = first(-1.0);
  return {std::min(p, q), std::max(p, q)};
}

std::vector<DoorLine> doorLines(const OccupancyGrid& grid, const ThesisResult& result,
                                const ThesisParams& params) {
  DoorParams found;
  found.free_max = params.free_max;
  std::vector<DoorLine> out = refineDoors(grid, result.segmentation.labels, found);
  for (DoorLine& d : out) d.real = false;
  for (const ConfirmedDoor& door : result.doors) {
    const auto [p, q] = sidesOf(door, result.segmentation.labels);
    if (p == 0 || q == 0 || p == q) continue;
    DoorLine line;
    line.a = grid.geometry.centre(door.critical.basis_a);
    line.b = grid.geometry.centre(door.critical.basis_b);
    // Between the faces of the two walls, which are half a cell nearer.
    const double across = std::hypot(line.b.x - line.a.x, line.b.y - line.a.y),
                 r = grid.geometry.resolution;
    if (across <= r) continue;
    const Point2 half{0.5 * r * (line.b.x - line.a.x) / across,
                      0.5 * r * (line.b.y - line.a.y) / across};
    line.a = {line.a.x + half.x, line.a.y + half.y};
    line.b = {line.b.x - half.x, line.b.y - half.y};
    line.width = across - r;
    line.place_a = p;
    line.place_b = q;
    const Point2 middle{0.5 * (line.a.x + line.b.x), 0.5 * (line.a.y + line.b.y)};
    // It stands for the border that was found at the same place.
    auto border = out.end();
    double nearest = params.door_max;
    for (auto it = out.begin(); it != out.end(); ++it) {
      const double d =
          std::hypot(0.5 * (it->a.x + it->b.x) - middle.x, 0.5 * (it->a.y + it->b.y) - middle.y);
      if (it->place_a != p || it->place_b != q || it->real || d >= nearest) continue;
      nearest = d;
      border = it;
    }
    if (border == out.end()) {
      out.push_back(line);
    } else {
      *border = line;
    }
  }
  std::sort(out.begin(), out.end(), [](const DoorLine& p, const DoorLine& q) {
    if (p.place_a != q.place_a) return p.place_a < q.place_a;
    if (p.place_b != q.place_b) return p.place_b < q.place_b;
    return p.a.x != q.a.x ? p.a.x < q.a.x : p.a.y < q.a.y;
  });
  return out;
}

}  // namespace

OccupancyGrid filterIsolatedCells(const OccupancyGrid& grid, int free_max, int occupied_min) {
  OccupancyGrid out = grid;
  const auto isFree = [&](int v) { return v >= 0 && v <= free_max; };
  for (int y = 0; y < grid.geometry.height; ++y) {
    for (int x = 0; x < grid.geometry.width; ++x) {
      const int own = grid.at({x, y});
      const bool occupied = own >= occupied_min;
      if (!occupied && !isFree(own)) continue;
      int same = 0, open = 0, known = 0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          if (dx == 0 && dy == 0) continue;
          const int v = grid.valueOr({x + dx, y + dy});
          same += (occupied ? v >= occupied_min : isFree(v)) ? 1 : 0;
          open += isFree(v) ? 1 : 0;
          known += v >= 0 ? 1 : 0;
        }
      }
      if (same > 0) continue;
      out.at({x, y}) =
          occupied && known > 0 && open == known ? OccupancyGrid::kFree : OccupancyGrid::kUnknown;
    }
  }
  return out;
}

cv::Mat obstaclesOf(const OccupancyGrid& grid, int free_max, int occupied_min,
                    bool unknown_blocks) {
  cv::Mat out(grid.geometry.height, grid.geometry.width, CV_8UC1);
  std::transform(grid.cells.begin(), grid.cells.end(), out.ptr<std::uint8_t>(0),
                 [&](std::int8_t v) -> std::uint8_t {
                   const bool obstacle = unknown_blocks ? v < 0 || v > free_max : v >= occupied_min;
                   return obstacle ? 255 : 0;
                 });
  return out;
}

std::vector<ConfirmedDoor> validateDoors(const std::vector<Point2d>& candidates,
                                         const std::vector<CriticalPoint>& critical,
                                         double min_radius, double max_radius) {
  std::vector<std::size_t> choice(critical.size(), candidates.size());
  std::vector<double> distance(critical.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    std::size_t best = critical.size();
    double nearest = max_radius;
    for (std::size_t k = 0; k < critical.size(); ++k) {
      if (critical[k].clearance <= min_radius || critical[k].clearance >= max_radius) continue;
      const double dx = critical[k].at.x - candidates[i].x, dy = critical[k].at.y - candidates[i].y;
      const double d = std::sqrt(dx * dx + dy * dy);
      if (d > nearest) continue;
      nearest = d;
      best = k;
    }
    if (best == critical.size() || nearest >= distance[best]) continue;
    distance[best] = nearest;
    choice[best] = i;
  }
  std::vector<ConfirmedDoor> out;
  for (std::size_t k = 0; k < critical.size(); ++k) {
    if (choice[k] < candidates.size()) out.push_back({candidates[choice[k]], critical[k]});
  }
  return out;
}

std::vector<PlacePolygon> drawPolygons(const std::vector<Circle>& circles, const cv::Mat& obstacles,
                                       double wall_share) {
  constexpr int kRays = 17;  // in a beam
  constexpr double kBeam = 2.0 * hyselam::kPi / 8.0;
  const auto inside = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < obstacles.cols && y < obstacles.rows;
  };
  std::vector<PlacePolygon> out(circles.size());
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const Circle& c = circles[i];
    const Point2d centre = toPoint(c.centre);
    std::array<double, 8> limits;
    limits.fill(std::numeric_limits<double>::infinity());
    std::array<double, 8> closest = limits;
    for (std::size_t j = 0; j < circles.size(); ++j) {
      if (j == i) continue;
      const Point2d to = Point2d(toPoint(circles[j].centre)) - centre;
      const double d = std::hypot(to.x, to.y);
      const auto beam =
          static_cast<std::size_t>((std::lround(std::atan2(to.y, to.x) / kBeam) + 8) % 8);
      if (d >= closest[beam]) continue;
      closest[beam] = d;
      limits[beam] = c.radius / (c.radius + circles[j].radius) * d;  // Eq. 4.4
    }
    for (std::size_t k = 0; k < 8; ++k) {
      const double axis = static_cast<double>(k) * kBeam;
      double farthest = -1.0;
      for (int ray = 0; ray < kRays; ++ray) {
        const double angle = axis + kBeam * (static_cast<double>(ray) / (kRays - 1) - 0.5);
        const Point2d u{std::cos(angle), std::sin(angle)};
        for (double s = 1.0; s <= limits[k]; s += 0.5) {
          const int x = static_cast<int>(std::lround(centre.x + s * u.x)),
                    y = static_cast<int>(std::lround(centre.y + s * u.y));
          if (!inside(x, y)) break;
          if (obstacles.at<std::uint8_t>(y, x) == 0) continue;
          if (s > farthest) {
            farthest = s;
            out[i].vertices[k] = Point2d(x, y);
          }
          break;
        }
      }
      if (farthest >= 0.0) continue;
      const double s = std::isfinite(limits[k]) ? limits[k] : c.radius;
      out[i].vertices[k] = centre + s * Point2d(std::cos(axis), std::sin(axis));
    }
    for (std::size_t k = 0; k < 8; ++k) {
      const Point2d a = out[i].vertices[k], b = out[i].vertices[(k + 1) % 8];
      const int n = std::max(1, static_cast<int>(std::ceil(std::hypot(b.x - a.x, b.y - a.y))));
      int occupied = 0;
      for (int t = 0; t <= n; ++t) {
        const Point2d p = a + (static_cast<double>(t) / n) * (b - a);
        const int x = static_cast<int>(std::lround(p.x)), y = static_cast<int>(std::lround(p.y));
        // A wall that is not along the cells swerves by one beside its chord.
        bool touches = false;
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            touches = touches ||
                      (inside(x + dx, y + dy) && obstacles.at<std::uint8_t>(y + dy, x + dx) != 0);
          }
        }
        occupied += touches ? 1 : 0;
      }
      out[i].wall[k] = occupied >= wall_share * (n + 1);
    }
  }
  return out;
}

ThesisResult runThesis(const OccupancyGrid& grid, const ThesisParams& params) {
  check(params);
  check(grid);
  const double cells = 1.0 / grid.geometry.resolution;
  const double door_min = 0.5 * params.door_min * cells, door_max = 0.5 * params.door_max * cells;
  ThesisResult r;
  r.filtered = filterIsolatedCells(grid, params.free_max, params.occupied_min);
  r.obstacles =
      obstaclesOf(r.filtered, params.free_max, params.occupied_min, params.unknown_blocks);

  const DistanceMap distances(r.obstacles);
  r.squared_distance = distances.squaredView().clone();
  if (cv::countNonZero(r.obstacles) > 0) {
    r.candidates = centralLocations(doorCells(distances, door_min, door_max), door_min);
  }
  r.voronoi = VoronoiDiagram(distances, params.voronoi).lines();
  if (!params.unknown_blocks) {
    // Places are on free floor only.
    r.voronoi.setTo(0, obstaclesOf(r.filtered, params.free_max, params.occupied_min, true));
  }
  r.critical_points = findCriticalPoints(distances, r.voronoi, params.critical_radius * cells);
  r.doors = validateDoors(r.candidates, r.critical_points, door_min, door_max);
  r.circles = dropCoveredCircles(packCircles(distances, r.voronoi), distances);

  cv::Mat closed(r.obstacles.size(), CV_8UC1, cv::Scalar(0));
  for (const ConfirmedDoor& d : r.doors) {
    cv::line(closed, toPoint(d.critical.basis_a), toPoint(d.critical.basis_b), 255, 1, cv::LINE_4);
  }
  // A circle in a doorway is no place, nor one that is narrower than the narrowest door.
  r.circles.erase(std::remove_if(r.circles.begin(), r.circles.end(),
                                 [&](const Circle& c) {
                                   return c.radius <= door_min ||
                                          closed.at<std::uint8_t>(c.centre.y, c.centre.x) != 0;
                                 }),
                  r.circles.end());
  if (r.circles.size() > kMaxPlaces) {
    throw hyselam::InputError("grid map", "", "gives more than 65535 places");
  }
  r.links = connectCircles(r.circles, r.voronoi);
  r.polygons = drawPolygons(r.circles, r.obstacles | closed, params.wall_share);

  const cv::Mat floor = obstaclesOf(r.filtered, params.free_max, params.occupied_min, true) == 0;
  Labeller labeller(floor & (closed == 0), r.circles.size());
  labeller.seed(r.circles, r.polygons);
  if (params.fill) labeller.fill(floor & closed);
  r.segmentation.labels = labeller.labels();
  r.segmentation.places = static_cast<int>(r.circles.size());
  r.segmentation.doors = doorLines(r.filtered, r, params);
  return r;
}

Segmentation segmentThesis(const OccupancyGrid& grid, const ThesisParams& params) {
  return runThesis(grid, params).segmentation;
}

}  // namespace hyselam_topo
