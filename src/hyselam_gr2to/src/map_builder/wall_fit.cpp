#include "wall_fit.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_topo {
namespace {

using cv::Point2d;

double cross(Point2d a, Point2d b) {
  return a.x * b.y - a.y * b.x;
}

double length(Point2d p) {
  return std::hypot(p.x, p.y);
}

// The point farthest from the chord of first .. last (both included).
std::pair<std::size_t, double> farthest(const std::vector<Point2d>& p, std::size_t first,
                                        std::size_t last) {
  const Point2d chord = p[last] - p[first];
  const double l = length(chord);
  std::size_t best = first;
  double worst = 0.0;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Point2d v = p[i] - p[first];
    const double s = l > 0.0 ? std::clamp(v.dot(chord) / (l * l), 0.0, 1.0) : 0.0;
    const double d = length(v - s * chord);
    if (d > worst) {
      worst = d;
      best = i;
    }
  }
  return {best, worst};
}

void split(const std::vector<Point2d>& p, std::size_t first, std::size_t last, double tolerance,
           std::vector<std::size_t>& cuts) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{first, last}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const auto [at, worst] = farthest(p, a, b);
    if (worst > tolerance) {
      open.push_back({at, b});
      open.push_back({a, at});
    } else {
      cuts.push_back(b);
    }
  }
}

// Two neighbouring straight pieces that are one within the tolerance become one: splitting may have
// cut where the noise was.
void joinStraight(const std::vector<Point2d>& p, double tolerance,
                  std::vector<ChainPiece>& pieces) {
  for (std::size_t i = 0; i + 1 < pieces.size();) {
    const ChainPiece joined{pieces[i].first, pieces[i + 1].last, {}};
    const LineFit line = fitLine(&p[joined.first], joined.last - joined.first);
    double worst = 0.0;
    for (std::size_t k = joined.first; k < joined.last; ++k) {
      worst = std::max(worst, std::abs(cross(line.along, p[k] - line.mean)));
    }
    if (worst <= tolerance) {
      pieces[i] = joined;
      pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      if (i > 0) --i;
    } else {
      ++i;
    }
  }
}

// An arc bends the same way at every joint, and no joint is a corner.
bool bendsEvenly(const std::vector<Point2d>& p, const std::vector<ChainPiece>& pieces,
                 std::size_t first, std::size_t last) {
  double sign = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const Point2d u = fitLine(&p[pieces[i].first], pieces[i].last - pieces[i].first).along,
                  v = fitLine(&p[pieces[i + 1].first], pieces[i + 1].last - pieces[i + 1].first)
                          .along;
    const double turn = std::atan2(cross(u, v), u.dot(v));
    if (std::abs(turn) > 1.0 || sign * turn < 0.0) return false;
    sign = turn;
  }
  return true;
}

}  // namespace

LineFit fitLine(const Point2d* first, std::size_t count) {
  LineFit fit;
  for (std::size_t i = 0; i < count; ++i) fit.mean += first[i];
  fit.mean *= 1.0 / static_cast<double>(count);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Point2d v = first[i] - fit.mean;
    xx += v.x * v.x;
    xy += v.x * v.y;
    yy += v.y * v.y;
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  fit.along = {std::cos(angle), std::sin(angle)};
  if (fit.along.dot(first[count - 1] - first[0]) < 0.0) fit.along = -fit.along;
  const double across = xx * fit.along.y * fit.along.y - 2.0 * xy * fit.along.x * fit.along.y +
                        yy * fit.along.x * fit.along.x;
  fit.rms = std::sqrt(std::max(0.0, across / static_cast<double>(count)));
  return fit;
}

// Kasa's fit: the circle x^2 + y^2 + D x + E y + F = 0 by linear least squares around the mean.
std::optional<CircleFit> fitCircle(const Point2d* first, std::size_t count) {
  if (count < 5) return std::nullopt;
  Point2d mean{0.0, 0.0};
  for (std::size_t i = 0; i < count; ++i) mean += first[i];
  mean *= 1.0 / static_cast<double>(count);
  double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, z = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Point2d v = first[i] - mean;
    const double s = v.dot(v);
    xx += v.x * v.x;
    xy += v.x * v.y;
    yy += v.y * v.y;
    xz += v.x * s;
    yz += v.y * s;
    z += s;
  }
  const double det = xx * yy - xy * xy;
  if (!(det > 1e-9 * z * z)) return std::nullopt;
  const Point2d c{0.5 * (xz * yy - yz * xy) / det, 0.5 * (yz * xx - xz * xy) / det};
  CircleFit fit;
  fit.centre = mean + c;
  fit.radius = std::sqrt(c.dot(c) + z / static_cast<double>(count));
  for (std::size_t i = 0; i < count; ++i) {
    fit.worst = std::max(fit.worst, std::abs(length(first[i] - fit.centre) - fit.radius));
  }
  return fit;
}

std::vector<ChainPiece> cutChain(std::vector<Point2d>& points, bool closed, double tolerance,
                                 double max_radius) {
  std::vector<Point2d>& p = points;
  if (p.empty()) return {};
  if (closed && p.size() > 4) {
    // The point farthest from the middle is a corner of the chain, or as good a start as any.
    Point2d mean{0.0, 0.0};
    for (const Point2d& q : p) mean += q;
    mean *= 1.0 / static_cast<double>(p.size());
    const auto corner = std::max_element(p.begin(), p.end(), [&](Point2d a, Point2d b) {
      return length(a - mean) < length(b - mean);
    });
    std::rotate(p.begin(), corner, p.end());
  }
  std::vector<std::size_t> cuts;
  const std::size_t end = p.size() - 1;
  if (closed && p.size() > 4) {
    std::size_t opposite = 0;
    for (std::size_t i = 1; i < p.size(); ++i) {
      if (length(p[i] - p[0]) > length(p[opposite] - p[0])) opposite = i;
    }
    split(p, 0, opposite, tolerance, cuts);
    if (opposite < end) split(p, opposite, end, tolerance, cuts);
  } else {
    split(p, 0, end, tolerance, cuts);
  }
  std::vector<ChainPiece> pieces;
  std::size_t first = 0;
  for (const std::size_t cut : cuts) {
    if (cut < first && cut != end) continue;
    const std::size_t last = cut == end ? end + 1 : cut;
    if (last <= first) continue;
    pieces.push_back({first, last, {}});
    first = last;
  }
  joinStraight(p, tolerance, pieces);
  // Around something thin the way there and the way back are two walls.
  if (closed && pieces.size() == 1 && p.size() >= 4) {
    const auto far = std::max_element(p.begin(), p.end(), [&](Point2d a, Point2d b) {
      return length(a - p[0]) < length(b - p[0]);
    });
    const auto cut = static_cast<std::size_t>(far - p.begin());
    if (cut > 0) pieces = {{0, cut, {}}, {cut, p.size(), {}}};
  }

  std::vector<ChainPiece> out;
  for (std::size_t i = 0; i < pieces.size();) {
    ChainPiece best = pieces[i];
    std::size_t next = i + 1;
    for (std::size_t j = i + 2; j < pieces.size() && bendsEvenly(p, pieces, i, j); ++j) {
      const auto circle = fitCircle(&p[pieces[i].first], pieces[j].last - pieces[i].first);
      if (!circle || circle->worst > tolerance || circle->radius > max_radius) break;
      best = {pieces[i].first, pieces[j].last, circle};
      next = j + 1;
    }
    out.push_back(best);
    i = next;
  }
  return out;
}

}  // namespace hyselam_topo
