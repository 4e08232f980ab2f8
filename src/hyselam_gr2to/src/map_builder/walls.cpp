#include "hyselam_gr2to/map_builder/walls.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "contour_walls.hpp"
#include "hyselam_common/require.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "wall_fit.hpp"

namespace hyselam_topo {

using cv::Point2d;
using hyselam::OccupancyGrid;
using hyselam::Point2;

namespace {

// What lies outside of a side: a wall, the unknown, or (kPlace + label) another place.
constexpr int kSolid = 0;
constexpr int kUnknown = 1;
constexpr int kPlace = 2;

// Limits without a wall need not be followed closely. [m]
constexpr double kOpenTolerance = 0.3;
// Fitted walls meet in a corner if that is not farther from where the cells turn. [cells]
constexpr double kCornerReach = 2.5;

struct Piece {
  int kind = kSolid;
  std::vector<Point2d> points;
  std::optional<CircleFit> arc;
  LineFit line;  // if it has 2 points or more
};

double cross(Point2d a, Point2d b) {
  return a.x * b.y - a.y * b.x;
}

class WallMaker {
 public:
  WallMaker(const OccupancyGrid& grid, const cv::Mat& labels, const WallParams& params)
      : grid_(grid), labels_(labels), params_(params), resolution_(grid.geometry.resolution) {}

  void add(const Contour& contour, PlaceWalls& out) const {
    if (isIsland(contour, resolution_, params_)) return;
    std::vector<Piece> pieces = cut(contour);
    if (pieces.empty()) return;
    const std::size_t n = pieces.size();
    std::vector<Point2d> corners(n);  // corner k: where piece k begins
    for (std::size_t k = 0; k < n; ++k) corners[k] = corner(pieces[(k + n - 1) % n], pieces[k]);
    for (std::size_t k = 0; k < n; ++k) {
      const Wall wall = n == 1 && !pieces[k].arc
                            ? straight(pieces[k], pieces[k].points.front(), pieces[k].points.back())
                            : make(pieces[k], corners[k], corners[(k + 1) % n]);
      if (wall.length >= params_.min_length) out.walls.push_back(wall);
    }
    if (contour.hole) return;
    // Of several parts of a place the largest gives the outline.
    std::vector<Point2> outline;
    for (std::size_t k = 0; k < n; ++k) {
      outline.push_back(toMap(corners[k]));
      if (!pieces[k].arc) continue;
      const std::size_t step = std::max<std::size_t>(1, pieces[k].points.size() / 8);
      for (std::size_t i = step; i + 1 < pieces[k].points.size(); i += step) {
        outline.push_back(toMap(pieces[k].points[i]));
      }
    }
    if (signedArea(outline) > signedArea(out.outline)) out.outline = std::move(outline);
  }

 private:
  Point2 toMap(Point2d p) const {
    return grid_.geometry.origin * Point2{p.x * resolution_, p.y * resolution_};
  }
  Point2 turned(Point2d v) const {
    const double c = std::cos(grid_.geometry.origin.theta),
                 s = std::sin(grid_.geometry.origin.theta);
    return {c * v.x - s * v.y, s * v.x + c * v.y};
  }
  bool occupied(cv::Point c) const { return grid_.valueOr({c.x, c.y}) >= params_.occupied_min; }

  int kindOf(const ContourSide& side) const {
    const cv::Point out = side.outside();
    if (occupied(out)) return kSolid;
    if (grid_.geometry.contains({out.x, out.y})) {
      const int label = labels_.at<std::uint16_t>(out);
      if (label != 0) return kPlace + label;
    }
    // A wall behind one cell that is neither free nor occupied: the soft edge of a wall.
    const cv::Point along = side.to() - side.from;
    return occupied(out + cv::Point(along.y, -along.x)) ? kSolid : kUnknown;
  }

  std::vector<Piece> cut(const Contour& contour) const {
    const std::size_t n = contour.sides.size();
    std::vector<int> kinds(n);
    for (std::size_t i = 0; i < n; ++i) kinds[i] = kindOf(contour.sides[i]);
    // Begin where the kind changes, so that no run goes round the end.
    std::size_t start = n;
    for (std::size_t i = 0; i < n && start == n; ++i) {
      if (kinds[i] != kinds[(i + n - 1) % n]) start = i;
    }
    const bool closed = start == n;
    if (closed) start = 0;
    std::vector<Piece> runs;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = (start + k) % n;
      if (runs.empty() || runs.back().kind != kinds[i]) runs.push_back({kinds[i], {}, {}, {}});
      runs.back().points.push_back(contour.sides[i].middle());
    }
    closeGaps(runs);
    std::vector<Piece> pieces;
    for (Piece& run : runs) {
      const double tolerance = run.kind == kSolid ? std::max(params_.tolerance / resolution_, 0.9)
                                                  : std::max(kOpenTolerance / resolution_, 2.0);
      for (const ChainPiece& c : cutChain(run.points, closed || runs.size() == 1, tolerance,
                                          params_.max_radius / resolution_)) {
        Piece piece;
        piece.kind = run.kind;
        piece.points.assign(run.points.begin() + static_cast<std::ptrdiff_t>(c.first),
                            run.points.begin() + static_cast<std::ptrdiff_t>(c.last));
        if (run.kind == kSolid) piece.arc = c.arc;
        if (piece.points.size() >= 2)
          piece.line = fitLine(piece.points.data(), piece.points.size());
        pieces.push_back(std::move(piece));
      }
    }
    return pieces;
  }

  // Short unknown runs between walls are wall.
  void closeGaps(std::vector<Piece>& runs) const {
    for (std::size_t i = 1; i + 1 < runs.size();) {
      Piece &before = runs[i - 1], &gap = runs[i], &after = runs[i + 1];
      const double l = static_cast<double>(gap.points.size()) * resolution_;
      if (gap.kind != kUnknown || before.kind != kSolid || after.kind != kSolid ||
          l > params_.max_gap) {
        ++i;
        continue;
      }
      before.points.insert(before.points.end(), gap.points.begin(), gap.points.end());
      before.points.insert(before.points.end(), after.points.begin(), after.points.end());
      runs.erase(runs.begin() + static_cast<std::ptrdiff_t>(i),
                 runs.begin() + static_cast<std::ptrdiff_t>(i) + 2);
    }
  }

  static Point2d corner(const Piece& before, const Piece& after) {
    const Point2d turn = 0.5 * (before.points.back() + after.points.front());
    const auto line = [](const Piece& p) {
      return p.kind == kSolid && p.points.size() >= 2 && !p.arc;
    };
    const auto foot = [&](const LineFit& l) {
      return l.mean + (turn - l.mean).dot(l.along) * l.along;
    };
    // A wall ends where its line does, whatever way an open limit goes on from there.
    if (!line(before) && !line(after)) return turn;
    if (!line(after)) return foot(before.line);
    if (!line(before)) return foot(after.line);
    const double sine = cross(before.line.along, after.line.along);
    if (std::abs(sine) > 0.35) {
      const double s = cross(after.line.mean - before.line.mean, after.line.along) / sine;
      const Point2d meet = before.line.mean + s * before.line.along;
      if (std::hypot(meet.x - turn.x, meet.y - turn.y) <= kCornerReach) return meet;
    }
    return 0.5 * (foot(before.line) + foot(after.line));
  }

  Wall make(const Piece& piece, Point2d from, Point2d to) const {
    return piece.arc ? curved(piece, from, to) : straight(piece, from, to);
  }

  Wall straight(const Piece& piece, Point2d from, Point2d to) const {
    Wall wall = straightWall(toMap(from), toMap(to));
    if (piece.kind != kSolid) {
      wall.kind = WallKind::kVirtual;
    } else if (piece.points.size() >= 3) {
      addCovariance(piece.line.rms, piece.points.size(), wall);
    }
    return wall;
  }

  Wall curved(const Piece& piece, Point2d from, Point2d to) const {
    const CircleFit& circle = *piece.arc;
    const auto angleAt = [&](Point2d p) {
      return std::atan2(p.y - circle.centre.y, p.x - circle.centre.x);
    };
    // The way around, from point to point, so that more than half a turn is not lost.
    double swept = 0.0, last = angleAt(from);
    const auto go = [&](Point2d p) {
      swept += hyselam::normalizeAngle(angleAt(p) - last);
      last = angleAt(p);
    };
    for (const Point2d& p : piece.points) go(p);
    go(to);
    const double half = std::min(0.5 * std::abs(swept), hyselam::kPi);
    if (half < 1e-3) return straight(piece, from, to);
    const double middle = angleAt(from) + 0.5 * swept;
    const Point2d out{std::cos(middle), std::sin(middle)};
    // Walked counter-clockwise around its centre, the arc has the centre on the left, in the place.
    const double sign = swept > 0.0 ? 1.0 : -1.0;
    Wall wall;
    wall.length = 2.0 * half * circle.radius * resolution_;
    wall.curvature = sign / (circle.radius * resolution_);
    const Point2 normal = turned(-sign * out);
    wall.normal = {normal.x, normal.y, 0.0};
    const Point2 mass = toMap(circle.centre + (circle.radius * std::sin(half) / half) * out);
    wall.position = {mass.x, mass.y, 0.0};
    addCovariance(circle.worst / std::sqrt(3.0), piece.points.size(), wall);
    return wall;
  }

  // Of a line through `count` points with that deviation [cells]; ends are known to a cell.
  void addCovariance(double rms, std::size_t count, Wall& wall) const {
    const double n = static_cast<double>(count);
    const double point = (rms * rms + 1.0 / 12.0) * resolution_ * resolution_;
    const double end = resolution_ * resolution_ / 12.0;
    const double across = point / n, along = 0.5 * end;
    const double nx = wall.normal.x, ny = wall.normal.y;
    wall.position_covariance = Covariance3{across * nx * nx + along * ny * ny,
                                           (across - along) * nx * ny,
                                           0.0,
                                           (across - along) * nx * ny,
                                           across * ny * ny + along * nx * nx,
                                           0.0,
                                           0.0,
                                           0.0,
                                           0.0};
    const double l = std::max(wall.length, resolution_);
    const double angle = 12.0 * point / (n * l * l);
    wall.normal_covariance = Covariance3{angle * ny * ny,
                                         -angle * nx * ny,
                                         0.0,
                                         -angle * nx * ny,
                                         angle * nx * nx,
                                         0.0,
                                         0.0,
                                         0.0,
                                         0.0};
    wall.size_covariance = Covariance2{2.0 * end, 0.0, 0.0, 0.0};
  }

  const OccupancyGrid& grid_;
  const cv::Mat& labels_;
  const WallParams& params_;
  double resolution_;
};

}  // namespace

void WallParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("tolerance", tolerance, Range::above(0.0), "m", "of a wall from the cells' faces, at most");
  visit("min_length", min_length, Range::atLeast(0.0), "m",
        "shorter pieces join their neighbors or are left out");
  visit("min_island", min_island, Range::atLeast(0.0), "m",
        "around an obstacle within a place; smaller ones are no walls");
  visit("max_gap", max_gap, Range::atLeast(0.0), "m", "unknown gaps up to this are wall");
  visit("max_radius", max_radius, Range::above(0.0), "m", "arcs with a larger one are straight");
  visit("free_max", free_max, Range::between(0, 99), "", "cells of 0 .. this value are free");
  visit("occupied_min", occupied_min, Range::between(1, 100), "",
        "cells of this value and more are walls");
}

void WallParams::validate() const {
  hyselam::checkParameters(*this);
  hyselam::require("occupied_min", occupied_min, occupied_min > free_max, "> free_max");
}

bool isIsland(const Contour& contour, double resolution, const WallParams& params) {
  return contour.hole && static_cast<double>(contour.sides.size()) * resolution < params.min_island;
}

std::vector<PlaceWalls> wallsAlong(const std::vector<Contour>& contours, const OccupancyGrid& grid,
                                   const cv::Mat& labels, const WallParams& params) {
  params.validate();
  const WallMaker maker(grid, labels, params);
  std::vector<PlaceWalls> out;
  for (const Contour& contour : contours) {
    if (out.size() < contour.label) out.resize(contour.label);
    maker.add(contour, out[contour.label - 1u]);
  }
  return out;
}

std::vector<PlaceWalls> extractWalls(const OccupancyGrid& grid, const cv::Mat& labels,
                                     const WallParams& params) {
  if (labels.type() != CV_16UC1 || labels.cols != grid.geometry.width ||
      labels.rows != grid.geometry.height) {
    throw hyselam::InputError("labels", "", "they do not fit the grid");
  }
  return wallsAlong(traceContours(labels), grid, labels, params);
}

}  // namespace hyselam_topo
