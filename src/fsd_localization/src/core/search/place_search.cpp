#include "fsd_localization/search/place_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fsd_localization {

using hyselam::Point2;
using hyselam::Pose2;

namespace {

constexpr int kLevels = 7;  // the largest square has 64 lattice cells a side
constexpr int kMargin = 1 << (kLevels - 1);
constexpr int kTileLevel = 3;  // 8 lattice cells
constexpr int kTileHeadings = 12;
// Along corridors a right place may be the 800th on the lattice: many are looked at a little, and
// the best of them closely.
constexpr std::size_t kMaxPlaces = 1000;
constexpr std::size_t kMaxRefined = 60;
constexpr std::size_t kQuickPoints = 100, kQuickViews = 4;
constexpr double kMinScore = 0.3;             // on the lattice; below nothing fits
constexpr double kMaxDrop = 0.25;             // on the lattice, from the best: no rival any more
constexpr double kMaxDropFromBelieved = 0.1;  // the same, from what is believed
constexpr std::size_t kMaxNodes = 6000000;    // a bound on time; not reached on buildings

constexpr std::size_t kAtOnce = 20;      // points, before the rest is given up
constexpr std::size_t kAskEvery = 4096;  // squares, whether the search is still wanted

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

/// One search of the lattice: squares of positions of one heading, the best bound first.
class LatticeSearch {
 public:
  LatticeSearch(const PlaceSearch& search, const Submap& submap) : search_(search) {
    const std::vector<Point2> points = evenly(submap.points, PlaceSearch::kPoints);
    count_ = points.size();
    for (int h = 0; h < PlaceSearch::kHeadings; ++h) {
      const double a = 2.0 * hyselam::kPi * h / PlaceSearch::kHeadings;
      const double c = std::cos(a), s = std::sin(a);
      for (const Point2& p : points) {
        offsets_.push_back({cellOffset(c * p.x - s * p.y), cellOffset(s * p.x + c * p.y)});
      }
    }
    open_.resize(255 * count_ + 1);
  }

  std::vector<Place> run(std::size_t max_places, const std::optional<Pose2>& believed,
                         const std::function<bool()>& cancelled) {
    std::vector<Place> places;
    if (count_ == 0) return places;
    lowest_ = static_cast<int>(std::ceil(kMinScore * 255.0 * static_cast<double>(count_)));
    if (believed) lowest_ = std::max(lowest_, bestNear(*believed) - scoreOf(kMaxDropFromBelieved));
    pushRoots();
    std::size_t visited = 0;
    std::vector<bool> taken(static_cast<std::size_t>(tilesAcross() * tilesUp()) *
                            (PlaceSearch::kHeadings / kTileHeadings));
    for (int bound = static_cast<int>(open_.size()) - 1; bound >= lowest_; --bound) {
      auto& bucket = open_[static_cast<std::size_t>(bound)];
      while (!bucket.empty()) {
        const Node node = bucket.back();
        bucket.pop_back();
        if (++visited % kAskEvery == 0 && cancelled && cancelled()) return places;
        // A square no larger than a tile lies in one.
        if (node.level <= kTileLevel && taken[tileOf(node)]) continue;
        if (node.level > 0) {
          if (nodes_ < kMaxNodes) pushQuarters(node);
          continue;
        }
        taken[tileOf(node)] = true;
        places.push_back(placeOf(node, bound));
        if (places.size() == max_places) return places;
        lowest_ = std::max(lowest_, scoreOf(places.front().coarse - kMaxDrop));
      }
    }
    return places;
  }

 private:
  struct Offset {
    int x, y;
  };
  struct Node {
    std::int16_t x, y;  // the square's lower left corner [lattice cells]
    std::int16_t heading;
    std::int16_t level;
  };

  static int cellOffset(double metres) {
    return static_cast<int>(std::floor(metres / PlaceSearch::kCell + 0.5));
  }
  int scoreOf(double coarse) const {
    return static_cast<int>(coarse * 255.0 * static_cast<double>(count_));
  }
  int sumOf(int level, int heading, int x, int y, int least) const {
    const PlaceSearch::Level& l = search_.levels_[static_cast<std::size_t>(level)];
    const Offset* offset = &offsets_[static_cast<std::size_t>(heading) * count_];
    const int x0 = x + kMargin, y0 = y + kMargin;
    const auto columns = static_cast<unsigned>(search_.stride_);
    const auto rows = static_cast<unsigned>(search_.height_ + kMargin);
    int sum = 0;
    for (std::size_t i = 0; i < count_;) {
      // Most squares are hopeless long before the last point.
      const std::size_t end = std::min(count_, i + kAtOnce);
      for (; i < end; ++i) {
        const auto px = static_cast<unsigned>(x0 + offset[i].x);
        const auto py = static_cast<unsigned>(y0 + offset[i].y);
        if (px < columns && py < rows) {
          sum += l.score[static_cast<std::size_t>(py) * columns + px];
        }
      }
      if (sum + 255 * static_cast<int>(count_ - i) < least) return -1;
    }
    return sum;
  }
  /// The best score of the lattice poses around a pose; -1 off the lattice.
  int bestNear(const Pose2& pose) const {
    const int cx = static_cast<int>(std::floor(pose.x / PlaceSearch::kCell));
    const int cy = static_cast<int>(std::floor(pose.y / PlaceSearch::kCell));
    const int turn =
        static_cast<int>(std::lround(pose.theta / (2.0 * hyselam::kPi) * PlaceSearch::kHeadings));
    int best = -1;
    for (int h = turn - 1; h <= turn + 1; ++h) {
      const int heading =
          (h % PlaceSearch::kHeadings + PlaceSearch::kHeadings) % PlaceSearch::kHeadings;
      for (int y = cy - 1; y <= cy + 1; ++y) {
        for (int x = cx - 1; x <= cx + 1; ++x) {
          if (x < 0 || y < 0 || x >= search_.width_ || y >= search_.height_) continue;
          best = std::max(best, sumOf(0, heading, x, y, best));
        }
      }
    }
    return best;
  }
  int tilesAcross() const { return (search_.width_ >> kTileLevel) + 1; }
  int tilesUp() const { return (search_.height_ >> kTileLevel) + 1; }
  std::size_t tileOf(const Node& n) const {
    return static_cast<std::size_t>(
        ((n.heading / kTileHeadings) * tilesUp() + (n.y >> kTileLevel)) * tilesAcross() +
        (n.x >> kTileLevel));
  }
  Place placeOf(const Node& n, int sum) const {
    Place p;
    p.base = {(n.x + 0.5) * PlaceSearch::kCell, (n.y + 0.5) * PlaceSearch::kCell,
              hyselam::normalizeAngle(2.0 * hyselam::kPi * n.heading / PlaceSearch::kHeadings)};
    p.coarse = sum / (255.0 * static_cast<double>(count_));
    return p;
  }

  void push(const Node& n) {
    const PlaceSearch::Level& level = search_.levels_[static_cast<std::size_t>(n.level)];
    const int stride = search_.stride_;
    if (level.free[static_cast<std::size_t>((n.y + kMargin) * stride + n.x + kMargin)] == 0) return;
    ++nodes_;
    const int sum = sumOf(n.level, n.heading, n.x, n.y, lowest_);
    if (sum < 0) return;
    open_[static_cast<std::size_t>(sum)].push_back(n);
  }
  void pushRoots() {
    constexpr int kSide = 1 << (kLevels - 1);
    for (std::int16_t h = 0; h < PlaceSearch::kHeadings; ++h) {
      for (int y = 0; y < search_.height_; y += kSide) {
        for (int x = 0; x < search_.width_; x += kSide) {
          push({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), h, kLevels - 1});
        }
      }
    }
  }
  void pushQuarters(const Node& n) {
    const int half = 1 << (n.level - 1);
    for (int q = 0; q < 4; ++q) {
      const int x = n.x + (q & 1) * half, y = n.y + (q >> 1) * half;
      if (x >= search_.width_ || y >= search_.height_) continue;
      push({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), n.heading,
            static_cast<std::int16_t>(n.level - 1)});
    }
  }

  const PlaceSearch& search_;
  std::size_t count_ = 0;
  std::vector<Offset> offsets_;          // of the points, by heading [lattice cells]
  std::vector<std::vector<Node>> open_;  // by bound
  int lowest_ = 0;
  std::size_t nodes_ = 0;
};

PlaceSearch::PlaceSearch(const hyselam::OccupancyGrid& map, const OccupancyThresholds& thresholds)
    : geometry_(map.geometry), rays_(map, thresholds) {
  const DistanceField field = distanceField(map, thresholds);
  distance_.resize(field.to_occupied.size());
  for (std::size_t i = 0; i < distance_.size(); ++i) {
    distance_[i] =
        static_cast<std::uint8_t>(std::min(255.0F, std::round(field.to_occupied[i] * 100.0F)));
  }
  buildPyramid(map, thresholds);
}

void PlaceSearch::buildPyramid(const hyselam::OccupancyGrid& map,
                               const OccupancyThresholds& thresholds) {
  const double side = geometry_.resolution / kCell;  // of a cell of the map [lattice cells]
  width_ = static_cast<int>(std::ceil(geometry_.width * side - 1e-9));
  height_ = static_cast<int>(std::ceil(geometry_.height * side - 1e-9));
  stride_ = width_ + kMargin;
  const std::size_t size =
      static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height_ + kMargin);
  levels_.resize(kLevels);
  Level& finest = levels_[0];
  finest.score.assign(size, 0);
  finest.free.assign(size, 0);
  const std::vector<float> table = scoreByDistance(kSigma);
  for (int ly = 0; ly < height_; ++ly) {
    // The cells of the map whose middles lie in the lattice's cell; where those are larger, one.
    const auto range = [&](int l, int limit) {
      int from = static_cast<int>(std::ceil(l / side - 0.5));
      int to = static_cast<int>(std::ceil((l + 1) / side - 0.5));
      if (from >= to) from = static_cast<int>((l + 0.5) / side), to = from + 1;
      return std::pair<int, int>{std::max(0, from), std::min(limit, to)};
    };
    const auto [y0, y1] = range(ly, geometry_.height);
    for (int lx = 0; lx < width_; ++lx) {
      const auto [x0, x1] = range(lx, geometry_.width);
      std::uint8_t nearest = 255, free = 0;
      for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
          const std::int8_t value = map.at({x, y});
          nearest = std::min(nearest, distance_[geometry_.index({x, y})]);
          free |= static_cast<std::uint8_t>(value >= 0 && value < thresholds.free_below);
        }
      }
      const auto i = static_cast<std::size_t>((ly + kMargin) * stride_ + lx + kMargin);
      finest.score[i] = static_cast<std::uint8_t>(std::lround(255.0F * table[nearest]));
      finest.free[i] = free;
    }
  }
  for (int l = 1; l < kLevels; ++l) {
    const Level& below = levels_[static_cast<std::size_t>(l - 1)];
    Level& level = levels_[static_cast<std::size_t>(l)];
    level = below;
    const int half = 1 << (l - 1), rows = height_ + kMargin;
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < stride_; ++x) {
        const auto i = static_cast<std::size_t>(y * stride_ + x);
        for (const auto& [dx, dy] :
             {std::pair{half, 0}, std::pair{0, half}, std::pair{half, half}}) {
          if (x + dx >= stride_ || y + dy >= rows) continue;
          const std::size_t k = i + static_cast<std::size_t>(dy * stride_ + dx);
          level.score[i] = std::max(level.score[i], below.score[k]);
          level.free[i] = std::max(level.free[i], below.free[k]);
        }
      }
    }
  }
}

std::size_t PlaceSearch::bytes() const {
  std::size_t sum = distance_.size() + geometry_.cellCount();
  for (const Level& l : levels_) sum += l.score.size() + l.free.size();
  return sum;
}

std::vector<Place> PlaceSearch::latticeSearch(const Submap& submap, std::size_t max_places,
                                              const std::optional<Pose2>& believed,
                                              const std::function<bool()>& cancelled) const {
  return LatticeSearch(*this, submap).run(max_places, believed, cancelled);
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

double PlaceSearch::distanceAt(double x, double y) const {
  const double cx = x / geometry_.resolution, cy = y / geometry_.resolution;
  if (!(cx >= 0.0 && cy >= 0.0 && cx < geometry_.width && cy < geometry_.height)) return 255;
  return distance_[geometry_.index({static_cast<int>(cx), static_cast<int>(cy)})];
}

double PlaceSearch::endScore(const std::vector<Point2>& points, const Pose2& base,
                             const std::vector<float>& by_distance) const {
  const double c = std::cos(base.theta), s = std::sin(base.theta);
  double sum = 0.0;
  for (const Point2& p : points) {
    sum += by_distance[static_cast<std::size_t>(
        distanceAt(base.x + c * p.x - s * p.y, base.y + s * p.x + c * p.y))];
  }
  return points.empty() ? 0.0 : sum / static_cast<double>(points.size());
}

double PlaceSearch::seenScore(const Submap& submap, const Pose2& base, bool sharply) const {
  const std::vector<float>& table = sharply ? sharpTable() : wideTable();
  double sum = 0.0;
  std::size_t count = 0;
  for (const Submap::View& view : submap.views) {
    const Point2 laser = base * view.laser;
    count += view.ends.size();
    for (const Point2& in_submap : view.ends) {
      const Point2 end = base * in_submap;
      const float hit = table[static_cast<std::size_t>(distanceAt(end.x, end.y))];
      if (hit < 0.01F) continue;
      const double range = std::hypot(end.x - laser.x, end.y - laser.y);
      const double open =
          rays_.range(laser.x, laser.y, std::atan2(end.y - laser.y, end.x - laser.x), range);
      if (open >= range - kInTheWay && (open > 0.0 || range <= kInTheWay)) sum += hit;
    }
  }
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

Place PlaceSearch::refine(const Submap& submap, const Pose2& guess) const {
  return climb(submap, guess, true);
}

Place PlaceSearch::climb(const Submap& submap, const Pose2& guess, bool sharply) const {
  const std::vector<Point2> points = evenly(submap.points, kRefinePoints);
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
    place.ends = endScore(points, place.base, r.table);
    for (int climb = 0; climb < 8; ++climb) {
      Pose2 best = place.base;
      double best_score = place.ends;
      const std::array<Pose2, 6> moves = {Pose2{r.step, 0, 0}, Pose2{-r.step, 0, 0},
                                          Pose2{0, r.step, 0}, Pose2{0, -r.step, 0},
                                          Pose2{0, 0, r.turn}, Pose2{0, 0, -r.turn}};
      for (const Pose2& m : moves) {
        const Pose2 moved{place.base.x + m.x, place.base.y + m.y,
                          hyselam::normalizeAngle(place.base.theta + m.theta)};
        const double score = endScore(points, moved, r.table);
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
