#include "fsd_localization/search/place_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fsd_localization {

using hyselam::Point2;
using hyselam::Pose2;

namespace {

// Along corridors a right place may be the 800th on the lattice: many are looked at a little, and
// the best of them closely.
constexpr std::size_t kMaxPlaces = 1000;
constexpr std::size_t kMaxRefined = 60;
constexpr std::size_t kQuickPoints = 100, kQuickViews = 4;
constexpr double kMinScore = 0.3;  // on the lattice; below nothing fits
constexpr double kMaxDrop = 0.25;  // on the lattice, from the best: no rival any more

constexpr std::size_t kRefinePoints = 300;
constexpr double kWideSigma = 0.2, kSharpSigma = 0.12;  // [m] of the refinement
constexpr double kInTheWay = 0.3;  // [m] an obstacle so much before a beam's end stands in the way

std::vector<float> scoreByDistance(double sigma) {
  std::vector<float> table(256);
  for (std::size_t d = 0; d < 255; ++d) {
    const double metres = 0.01 * static_cast<double>(d);
    table[d] = static_cast<float>(std::exp(-0.5 * metres * metres / (sigma * sigma)));
  }
  table[255] = 0.0F;
  return table;
}
const std::vector<float>& wideTable() {
  static const std::vector<float> table = scoreByDistance(kWideSigma);
  return table;
}
const std::vector<float>& sharpTable() {
  static const std::vector<float> table = scoreByDistance(kSharpSigma);
  return table;
}

std::vector<Point2> evenly(const std::vector<Point2>& points, std::size_t count) {
  const std::size_t n = std::min(count, points.size());
  std::vector<Point2> some;
  some.reserve(n);
  for (std::size_t i = 0; i < n; ++i) some.push_back(points[i * points.size() / n]);
  return some;
}

}  // namespace

bool isSamePlace(const Pose2& a, const Pose2& b) {
  return hyselam::distance(a, b) <= 1.0 &&
         std::abs(hyselam::normalizeAngle(a.theta - b.theta)) <= hyselam::radians(30.0);
}

PlaceSearch::PlaceSearch(const hyselam::OccupancyGrid& map, const OccupancyThresholds& thresholds)
    : geometry_(map.geometry), rays_(map, thresholds) {
  const DistanceField field = distanceField(map, thresholds);
  distance_.resize(field.to_occupied.size());
  for (std::size_t i = 0; i < distance_.size(); ++i) {
    distance_[i] =
        static_cast<std::uint8_t>(std::min(255.0F, std::round(field.to_occupied[i] * 100.0F)));
  }
  lattice_ = std::make_unique<const ScoreLattice>(map, distance_, thresholds);
  distance_.push_back(255);  // what lies off the map
}

std::size_t PlaceSearch::bytes() const {
  return distance_.size() + geometry_.cellCount() + lattice_->bytes();
}

std::vector<Place> PlaceSearch::latticeSearch(const Submap& submap, std::size_t max_places,
                                              const std::optional<Pose2>& believed,
                                              const std::function<bool()>& cancelled) const {
  const std::vector<Point2> points = evenly(submap.points, kPoints);
  ScoreLattice::Limits limits{kMinScore, kMaxDrop, max_places};
  if (believed) {
    if (const auto score = lattice_->bestNear(points, *believed)) {
      limits.min_score = std::max(kMinScore, *score - kMaxDropFromBelieved);
    }
  }
  std::vector<Place> places;
  for (const ScoreLattice::Pose& found : lattice_->search(points, limits, cancelled)) {
    Place p;
    p.base = found.base;
    p.coarse = found.score;
    places.push_back(p);
  }
  return places;
}

namespace {

/// Each place once, the best first.
std::vector<Place> distinct(std::vector<Place> all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Place& a, const Place& b) { return a.seen > b.seen; });
  std::vector<Place> places;
  for (const Place& p : all) {
    const bool known = std::any_of(places.begin(), places.end(),
                                   [&](const Place& q) { return isSamePlace(p.base, q.base); });
    if (!known) places.push_back(p);
  }
  return places;
}

/// Some points and views of a submap, enough to tell what cannot be.
Submap thinned(const Submap& submap) {
  Submap few;
  few.points = evenly(submap.points, kQuickPoints);
  const std::size_t views = std::min(kQuickViews, submap.views.size());
  for (std::size_t v = 0; v < views; ++v) {
    const Submap::View& view = submap.views[v * submap.views.size() / views];
    few.views.push_back({view.laser, evenly(view.ends, 30)});
  }
  return few;
}

}  // namespace

std::vector<Place> PlaceSearch::search(const Submap& submap, const std::optional<Pose2>& believed,
                                       const std::function<bool()>& cancelled) const {
  const Submap few = thinned(submap);
  std::vector<Place> quick;
  for (const Place& coarse : latticeSearch(submap, kMaxPlaces, believed, cancelled)) {
    if (cancelled && cancelled()) return {};
    Place p = climb(few, coarse.base, false);
    p.coarse = coarse.coarse;
    quick.push_back(p);
  }
  quick = distinct(std::move(quick));
  if (quick.size() > kMaxRefined) quick.resize(kMaxRefined);
  std::vector<Place> refined;
  for (const Place& q : quick) {
    if (cancelled && cancelled()) return {};
    Place p = refine(submap, q.base);
    p.coarse = q.coarse;
    refined.push_back(p);
  }
  return distinct(std::move(refined));
}

std::uint8_t PlaceSearch::distanceAt(double x, double y) const {
  return distance_[indexAt(x / geometry_.resolution, y / geometry_.resolution)];
}

double PlaceSearch::seenScore(const Submap& submap, const Pose2& base, bool sharply) const {
  const std::vector<float>& table = sharply ? sharpTable() : wideTable();
  const double c = std::cos(base.theta), s = std::sin(base.theta);
  const auto inGrid = [&](const Point2& p) {
    return Point2{base.x + c * p.x - s * p.y, base.y + s * p.x + c * p.y};
  };
  double sum = 0.0;
  std::size_t count = 0;
  for (const Submap::View& view : submap.views) {
    const Point2 laser = inGrid(view.laser);
    count += view.ends.size();
    for (const Point2& in_submap : view.ends) {
      const Point2 end = inGrid(in_submap);
      const float hit = table[distanceAt(end.x, end.y)];
      if (hit < 0.01F) continue;
      if (isOpen(laser, end)) sum += hit;
    }
  }
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

bool PlaceSearch::isOpen(const Point2& laser, const Point2& end) const {
  const double dx = end.x - laser.x, dy = end.y - laser.y, range = std::hypot(dx, dy);
  const double open =
      range > 0.0 ? rays_.rangeAlong(laser.x, laser.y, dx / range, dy / range, range) : 0.0;
  return open >= range - kInTheWay && (open > 0.0 || range <= kInTheWay);
}

double PlaceSearch::blockedShare(const Submap& submap, const Pose2& base) const {
  std::size_t blocked = 0, count = 0;
  for (const Submap::View& view : submap.views) {
    count += view.ends.size();
    for (const Point2& end : view.ends) blocked += !isOpen(base * view.laser, base * end);
  }
  return count == 0 ? 0.0 : static_cast<double>(blocked) / static_cast<double>(count);
}

Place PlaceSearch::refine(const Submap& submap, const Pose2& guess) const {
  return climb(submap, guess, true);
}

/// How well points lie on obstacles, for poses of one heading.
class PlaceSearch::EndScores {
 public:
  EndScores(const PlaceSearch& search, const std::vector<Point2>& points)
      : search_(search), points_(points), x_(points.size()), y_(points.size()) {
    for (auto& part : parts_) part.resize(points.size());
  }

  /// The mean score of the points, seen from `base`.
  double at(const Pose2& base, const std::vector<float>& by_distance) {
    turnTo(base.theta);
    const double resolution = search_.geometry_.resolution;
    const std::size_t n = points_.size();
    for (std::size_t i = 0; i < n; ++i) x_[i] = (base.x + parts_[0][i] - parts_[1][i]) / resolution;
    for (std::size_t i = 0; i < n; ++i) y_[i] = (base.y + parts_[2][i] + parts_[3][i]) / resolution;
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      sum += by_distance[search_.distance_[search_.indexAt(x_[i], y_[i])]];
    }
    return n == 0 ? 0.0 : sum / static_cast<double>(n);
  }

 private:
  void turnTo(double theta) {
    if (theta == theta_) return;
    theta_ = theta;
    const double c = std::cos(theta), s = std::sin(theta);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Point2& p = points_[i];
      parts_[0][i] = c * p.x;
      parts_[1][i] = s * p.y;
      parts_[2][i] = s * p.x;
      parts_[3][i] = c * p.y;
    }
  }

  const PlaceSearch& search_;
  const std::vector<Point2>& points_;
  double theta_ = std::numeric_limits<double>::quiet_NaN();
  std::array<std::vector<double>, 4> parts_;  // of the points' positions, turned
  std::vector<double> x_, y_;                 // [cells]
};

Place PlaceSearch::climb(const Submap& submap, const Pose2& guess, bool sharply) const {
  const std::vector<Point2> points = evenly(submap.points, kRefinePoints);
  EndScores scores(*this, points);
  Place place;
  place.base = guess;
  // Hill climbing, each time with smaller steps.
  struct Round {
    const std::vector<float>& table;
    double step, turn;
  };
  for (const Round& r : {Round{wideTable(), 0.1, hyselam::radians(1.5)},
                         Round{wideTable(), 0.05, hyselam::radians(0.75)},
                         Round{sharpTable(), 0.05, hyselam::radians(0.75)},
                         Round{sharpTable(), 0.02, hyselam::radians(0.3)}}) {
    if (!sharply && &r.table == &sharpTable()) break;
    place.ends = scores.at(place.base, r.table);
    for (int climb = 0; climb < 8; ++climb) {
      Pose2 best = place.base;
      double best_score = place.ends;
      const std::array<Pose2, 6> moves = {Pose2{r.step, 0, 0}, Pose2{-r.step, 0, 0},
                                          Pose2{0, r.step, 0}, Pose2{0, -r.step, 0},
                                          Pose2{0, 0, r.turn}, Pose2{0, 0, -r.turn}};
      for (const Pose2& m : moves) {
        const Pose2 moved{place.base.x + m.x, place.base.y + m.y,
                          hyselam::normalizeAngle(place.base.theta + m.theta)};
        const double score = scores.at(moved, r.table);
        if (score > best_score) {
          best = moved;
          best_score = score;
        }
      }
      if (best_score <= place.ends) break;
      place.base = best;
      place.ends = best_score;
    }
  }
  place.seen = seenScore(submap, place.base, sharply);
  return place;
}

}  // namespace fsd_localization
