#include "ngram_slam/slam/present_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "hyselam_common/odds.hpp"
#include "ngram_slam/slam/keyframe_grid.hpp"

namespace ngram_slam {

using hyselam::OccupancyGrid;
using hyselam::OccupancyMapper;
using hyselam::Point2;
using hyselam::Pose2;

namespace {

constexpr int kMargin = 2;  // of unknown cells around a map

/// The log odds after the cell may have changed with that probability.
double afterChange(double log_odds, double change) {
  const double p = hyselam::probabilityOf(log_odds);
  const double later = p * (1.0 - change) + (1.0 - p) * change;
  return std::log(later / (1.0 - later));
}

std::uint16_t more(std::uint16_t count, std::uint64_t by) {
  return static_cast<std::uint16_t>(
      std::min<std::uint64_t>(std::numeric_limits<std::uint16_t>::max(), count + by));
}

}  // namespace

void PresentMapParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("change_probability", change_probability, Range::between(0.0, 0.5), "",
        "of a cell from one visit to the next, before anything is known of it");
  visit("change_memory", change_memory, Range::above(0.0), "visits", "that this counts as");
  visit("observation", observation, Range::above(0.0), "",
        "log odds by which an observation beyond occupied_ratio moves a cell");
  visit("max_visit", max_visit, Range::above(0.0), "", "log odds by which a visit moves it");
  visit("max_log_odds", max_log_odds, Range::above(0.0), "", "of a cell");
  visit("change_tolerance", tolerance, Range::between(0, 20), "cells",
        "changes nearer to where the same was before are errors of the poses");
  visit("change_min_cells", min_cells, Range::atLeast(1), "", "of a change that is told");
  visit("change_sure", sure, Range::atLeast(0.0), "",
        "log odds, before and now, of a cell that is said to have changed");
}

const char* toString(MapChange::Kind kind) {
  return kind == MapChange::Kind::kAppeared ? "appeared" : "gone";
}

std::string summaryOf(const std::vector<MapChange>& changes, bool known) {
  if (!known) return "not known: the session is not tied to the map";
  if (changes.empty()) return "nothing changed";
  std::size_t appeared = 0, again = 0;
  for (const MapChange& c : changes) {
    appeared += c.kind == MapChange::Kind::kAppeared ? 1 : 0;
    again += c.again ? 1 : 0;
  }
  const std::size_t gone = changes.size() - appeared;
  std::string text = std::to_string(appeared) + (appeared == 1 ? " thing" : " things") +
                     " appeared, " + std::to_string(gone) + (gone == 1 ? " is" : " are") + " gone";
  if (again > 0) text += ", " + std::to_string(again) + " of them not for the first time";
  return text;
}

PresentMap::PresentMap(const hyselam::OccupancyMapperParams& map, const PresentMapParams& params)
    : map_(map), params_(params), visit_(map) {
  hyselam::checkParameters(params_);
}

void PresentMap::Grid::cover(int min_x, int min_y, int max_x, int max_y, std::size_t max_cells) {
  if (width > 0 && min_x >= x0 && min_y >= y0 && max_x < x0 + width && max_y < y0 + height) return;
  const int to_x = width > 0 ? std::max(max_x, x0 + width - 1) : max_x;
  const int to_y = width > 0 ? std::max(max_y, y0 + height - 1) : max_y;
  const int from_x = width > 0 ? std::min(min_x, x0) : min_x;
  const int from_y = width > 0 ? std::min(min_y, y0) : min_y;
  const std::size_t cells_of_all =
      static_cast<std::size_t>(to_x - from_x + 1) * static_cast<std::size_t>(to_y - from_y + 1);
  if (cells_of_all > max_cells) throw std::length_error("the map would be too large");
  cells.cover(from_x, from_y, to_x, to_y);
  x0 = from_x;
  y0 = from_y;
  width = to_x - from_x + 1;
  height = to_y - from_y + 1;
}

bool PresentMap::isKnown(const Belief& b) const {
  return b.observations >= map_.min_observations;
}

/// One visit of a cell: it may have changed since, and then was observed.
void PresentMap::fold(const OccupancyMapper& visit, bool now, Grid* grid) const {
  int min_x = std::numeric_limits<int>::max(), min_y = min_x, max_x = -min_x, max_y = -min_x;
  visit.forEachObserved([&](int x, int y, std::uint32_t, std::uint32_t) {
    min_x = std::min(min_x, x);
    min_y = std::min(min_y, y);
    max_x = std::max(max_x, x);
    max_y = std::max(max_y, y);
  });
  if (min_x > max_x) return;
  grid->cover(min_x, min_y, max_x, max_y, map_.max_cells);
  visit.forEachObserved([&](int x, int y, std::uint32_t hits, std::uint32_t misses) {
    Belief& b = grid->of(x, y);
    const double total = static_cast<double>(hits) + misses;
    const double evidence =
        std::clamp(params_.observation * (static_cast<double>(hits) - map_.occupied_ratio * total),
                   -params_.max_visit, params_.max_visit);
    double log_odds = static_cast<double>(b.log_odds);
    if (b.visits > 0) {
      const double change = (b.changes + params_.change_memory * params_.change_probability) /
                            (b.visits + params_.change_memory);
      log_odds = afterChange(log_odds, std::min(0.5, change));
    }
    const bool was_occupied = b.log_odds > 0.0F, was_known = isKnown(b);
    log_odds = std::clamp(log_odds + evidence, -params_.max_log_odds, params_.max_log_odds);
    b.log_odds = static_cast<float>(log_odds);
    b.visits = more(b.visits, 1);
    b.observations = more(b.observations, static_cast<std::uint64_t>(hits) + misses);
    if (was_known && was_occupied != (b.log_odds > 0.0F)) b.changes = more(b.changes, 1);
    b.now = b.now || now;
  });
}

void PresentMap::closeRun() {
  if (open_) fold(visit_, in_session_, &past_);
  visit_.clear();
  open_ = false;
}

/// The cells that were settled before a run take the place of what the kept keyframes say.
void PresentMap::settleBefore(std::uint32_t run, const Source& source) {
  const double resolution = map_.resolution, half = 0.5 * source.settled.cell;
  for (const SettledCell& c : source.settled.cells) {
    if (c.run < settled_before_ || c.run >= run) continue;
    const SlamKeyframe& k = source.keyframes[static_cast<std::size_t>(c.keyframe)];
    if (k.run >= shown_.size() || !shown_[k.run]) continue;
    const Point2 center = k.pose * c.center;
    const auto first = [&](double v) {
      return static_cast<int>(std::ceil((v - half) / resolution - 0.5 - 1e-9));
    };
    const auto last = [&](double v) {
      return static_cast<int>(std::ceil((v + half) / resolution - 0.5 - 1e-9)) - 1;
    };
    const int min_x = first(center.x), max_x = last(center.x);
    const int min_y = first(center.y), max_y = last(center.y);
    if (min_x > max_x || min_y > max_y) continue;
    // What no kept keyframe saw at all is not worth a larger map.
    for (int y = std::max(min_y, past_.y0); y <= std::min(max_y, past_.y0 + past_.height - 1);
         ++y) {
      for (int x = std::max(min_x, past_.x0); x <= std::min(max_x, past_.x0 + past_.width - 1);
           ++x) {
        Belief& b = past_.of(x, y);
        b.log_odds = c.log_odds;
        b.visits = c.visits;
        b.changes = c.changes;
        b.observations = more(b.observations, static_cast<std::uint64_t>(map_.min_observations));
      }
    }
  }
  settled_before_ = std::max(settled_before_, run);
}

/// What has to be done before the first keyframe of another run is inserted.
void PresentMap::beginRun(std::uint32_t run, const Source& source) {
  closeRun();
  settleBefore(run, source);
  if (!in_session_ && run >= source.session) {
    before_ = past_;
    in_session_ = true;
  }
  run_ = run;
  open_ = true;
}

void PresentMap::update(const Source& source) {
  if (source.revision != revision_ || source.keyframes.size() < inserted_ ||
      source.shown != shown_ || source.session != session_ ||
      source.settled.cells.size() != settled_cells_) {
    visit_.clear();
    past_ = before_ = Grid{};
    inserted_ = 0;
    run_ = 0;
    settled_before_ = 0;
    open_ = in_session_ = false;
    revision_ = source.revision;
    shown_ = source.shown;
    session_ = source.session;
    settled_cells_ = source.settled.cells.size();
  }
  while (inserted_ < source.keyframes.size()) {
    const SlamKeyframe& k = source.keyframes[inserted_++];
    if (k.run >= shown_.size() || !shown_[k.run]) continue;
    if (!open_ || k.run != run_) beginRun(k.run, source);
    visit_.insert(k.pose, *k.scan);
  }
  // What was settled of the last run too, before any scan of a session.
  const auto is_left = [&](const SettledCell& c) { return c.run >= settled_before_; };
  if (std::any_of(source.settled.cells.begin(), source.settled.cells.end(), is_left)) {
    closeRun();
    settleBefore(std::numeric_limits<std::uint32_t>::max(), source);
  }
}

OccupancyGrid PresentMap::emptyGrid(const Grid& g) const {
  int min_x = g.width, min_y = g.height, max_x = -1, max_y = -1;
  g.cells.forEach([&](int x, int y, const Belief& b) {
    if (b.observations == 0) return;
    min_x = std::min(min_x, x - g.x0);
    min_y = std::min(min_y, y - g.y0);
    max_x = std::max(max_x, x - g.x0);
    max_y = std::max(max_y, y - g.y0);
  });
  hyselam::GridGeometry geometry;
  geometry.resolution = map_.resolution;
  if (max_x < 0) {
    geometry.width = geometry.height = 1;
    return OccupancyGrid(geometry);
  }
  geometry.width = max_x - min_x + 1 + 2 * kMargin;
  geometry.height = max_y - min_y + 1 + 2 * kMargin;
  geometry.origin = {(g.x0 + min_x - kMargin) * map_.resolution,
                     (g.y0 + min_y - kMargin) * map_.resolution, 0.0};
  return OccupancyGrid(geometry);
}

namespace {

/// Column and row of the first cell of a map in the lattice of its frame.
int latticeOf(double origin, double resolution) {
  return static_cast<int>(std::lround(origin / resolution));
}

}  // namespace

/// A map of the known cells, each as `value` has it.
template <typename Value>
OccupancyGrid PresentMap::gridOf(const Grid& g, const Value& value) const {
  OccupancyGrid grid = emptyGrid(g);
  const int x0 = latticeOf(grid.geometry.origin.x, map_.resolution);
  const int y0 = latticeOf(grid.geometry.origin.y, map_.resolution);
  g.cells.forEach([&](int x, int y, const Belief& b) {
    if (isKnown(b)) grid.at({x - x0, y - y0}) = value(b);
  });
  return grid;
}

OccupancyGrid PresentMap::gridOf(const Grid& g) const {
  return gridOf(g, [](const Belief& b) {
    return b.log_odds > 0.0F ? OccupancyGrid::kOccupied : OccupancyGrid::kFree;
  });
}

OccupancyGrid PresentMap::probabilitiesOf(const Grid& g) const {
  return gridOf(g, [](const Belief& b) {
    const double p = hyselam::probabilityOf(static_cast<double>(b.log_odds));
    return static_cast<std::int8_t>(std::lround(100.0 * p));
  });
}

OccupancyGrid PresentMap::grid() const {
  return withPresent([&](const Grid& g) { return gridOf(g); });
}

OccupancyGrid PresentMap::probabilities() const {
  return withPresent([&](const Grid& g) { return probabilitiesOf(g); });
}

PresentMap::Drawn PresentMap::draw() const {
  return withPresent([&](const Grid& now) {
    return Drawn{gridOf(now), probabilitiesOf(now), changesOf(now)};
  });
}

namespace {

/// What changed between two grids of one lattice.
template <typename Grid>
class Comparison {
 public:
  Comparison(const hyselam::OccupancyMapperParams& map, const PresentMapParams& params,
             const Grid& before, const Grid& now)
      : map_(map),
        params_(params),
        before_(before),
        now_(now),
        kind_(static_cast<std::size_t>(now.width) * static_cast<std::size_t>(now.height), kSame) {
    now.cells.forEach([&](int x, int y, const Belief& b) {
      if (b.now) kind_[indexOf(x - now.x0, y - now.y0)] = kindOf(x - now.x0, y - now.y0);
    });
  }

  std::vector<MapChange> groups() {
    std::vector<MapChange> all;
    for (int y = 0; y < now_.height; ++y) {
      for (int x = 0; x < now_.width; ++x) {
        if (kind_[indexOf(x, y)] == kSame) continue;
        MapChange change = takeGroup(x, y);
        if (change.cells.size() >= static_cast<std::size_t>(params_.min_cells)) {
          all.push_back(std::move(change));
        }
      }
    }
    std::stable_sort(all.begin(), all.end(), [](const MapChange& a, const MapChange& b) {
      return a.cells.size() > b.cells.size();
    });
    return all;
  }

 private:
  using Belief = PresentMap::Belief;
  enum : std::uint8_t { kSame = 0, kCame = 1, kWent = 2 };

  std::size_t indexOf(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(now_.width) +
           static_cast<std::size_t>(x);
  }
  /// Of a cell of `now_`; null where the grid does not reach.
  const Belief* beliefIn(const Grid& g, int x, int y) const {
    const int gx = x + now_.x0 - g.x0, gy = y + now_.y0 - g.y0;
    return gx < 0 || gy < 0 || gx >= g.width || gy >= g.height ? nullptr : &g.at(gx, gy);
  }
  bool isOccupiedNear(const Grid& g, int x, int y) const {
    const int reach = params_.tolerance;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const Belief* b = beliefIn(g, x + dx, y + dy);
        if (b != nullptr && isKnown(*b) && b->log_odds > 0.0F) return true;
      }
    }
    return false;
  }
  bool isKnown(const Belief& b) const { return b.observations >= map_.min_observations; }
  bool isSure(const Belief* b) const {
    return b != nullptr && isKnown(*b) &&
           std::abs(static_cast<double>(b->log_odds)) >= params_.sure;
  }
  std::uint8_t kindOf(int x, int y) const {
    const Belief& b = now_.at(x, y);
    const Belief* old = beliefIn(before_, x, y);
    if (!b.now || !isSure(&b) || !isSure(old)) return kSame;
    const bool occupied = b.log_odds > 0.0F, was = old->log_odds > 0.0F;
    if (occupied && !was && !isOccupiedNear(before_, x, y)) return kCame;
    if (!occupied && was && !isOccupiedNear(now_, x, y)) return kWent;
    return kSame;
  }

  /// The cells that changed like this one and hang together with it; sides of one thing are seen
  /// with gaps between them.
  MapChange takeGroup(int x, int y) {
    constexpr int kReach = 2;
    const std::uint8_t what = kind_[indexOf(x, y)];
    std::vector<std::pair<int, int>> cells = {{x, y}};
    kind_[indexOf(x, y)] = kSame;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto [cx, cy] = cells[i];
      for (int ny = std::max(0, cy - kReach); ny <= std::min(now_.height - 1, cy + kReach); ++ny) {
        for (int nx = std::max(0, cx - kReach); nx <= std::min(now_.width - 1, cx + kReach); ++nx) {
          if (kind_[indexOf(nx, ny)] != what) continue;
          kind_[indexOf(nx, ny)] = kSame;
          cells.emplace_back(nx, ny);
        }
      }
    }
    return describe(cells, what == kCame);
  }

  MapChange describe(const std::vector<std::pair<int, int>>& cells, bool came) const {
    MapChange change;
    change.kind = came ? MapChange::Kind::kAppeared : MapChange::Kind::kGone;
    int min_x = cells[0].first, max_x = min_x, min_y = cells[0].second, max_y = min_y;
    std::size_t again = 0;
    const double side = map_.resolution;
    for (const auto& [x, y] : cells) {
      min_x = std::min(min_x, x);
      max_x = std::max(max_x, x);
      min_y = std::min(min_y, y);
      max_y = std::max(max_y, y);
      const Belief& b = now_.at(x, y);
      const double occupied = hyselam::probabilityOf(static_cast<double>(b.log_odds));
      const double was =
          hyselam::probabilityOf(static_cast<double>(beliefIn(before_, x, y)->log_odds));
      change.probability += came ? occupied * (1.0 - was) : (1.0 - occupied) * was;
      again += b.changes > 1 ? 1 : 0;
      const Point2 center{(x + now_.x0 + 0.5) * side, (y + now_.y0 + 0.5) * side};
      change.center.x += center.x;
      change.center.y += center.y;
      change.cells.push_back(center);
    }
    const auto n = static_cast<double>(cells.size());
    change.center.x /= n;
    change.center.y /= n;
    change.probability /= n;
    change.again = 2 * again > cells.size();
    change.size = side * (1 + std::max(max_x - min_x, max_y - min_y));
    return change;
  }

  const hyselam::OccupancyMapperParams& map_;
  const PresentMapParams& params_;
  const Grid &before_, &now_;
  std::vector<std::uint8_t> kind_;
};

}  // namespace

std::vector<MapChange> PresentMap::changesOf(const Grid& now) const {
  if (before_.width == 0) return {};
  return Comparison<Grid>(map_, params_, before_, now).groups();
}

std::vector<MapChange> PresentMap::changes() const {
  return withPresent([&](const Grid& now) { return changesOf(now); });
}

namespace {

int nearestKept(const std::vector<SlamKeyframe>& keyframes, const KeyframeGrid& grid,
                const std::vector<bool>& usable, const Point2& p) {
  int best = -1;
  double nearest = std::numeric_limits<double>::infinity();
  for (double radius = 1.0; best < 0 && radius < 200.0; radius *= 2.0) {
    grid.forEachNear({p.x, p.y, 0.0}, radius, [&](int k, double d) {
      if (!usable[static_cast<std::size_t>(k)] || d > nearest || (d == nearest && k > best)) return;
      nearest = d;
      best = k;
    });
  }
  for (std::size_t k = 0; best < 0 && k < keyframes.size(); ++k) {
    if (usable[k]) best = static_cast<int>(k);
  }
  return best;
}

OccupancyGrid mapOf(const PresentMap::Source& source, const hyselam::OccupancyMapperParams& map,
                    const PresentMapParams& params) {
  PresentMap present(map, params);
  present.update(source);
  return present.grid();
}

}  // namespace

SettledMap settledMap(const std::vector<SlamKeyframe>& keyframes, const std::vector<bool>& kept,
                      const std::vector<std::uint32_t>& map_of_run, const SettledMap& before,
                      const hyselam::OccupancyMapperParams& map, const PresentMapParams& params) {
  SettledMap settled;
  const double cell = settled.cell = map.resolution;
  if (keyframes.empty()) return settled;
  const std::uint32_t last_run = keyframes.back().run;
  std::vector<SlamKeyframe> staying;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    if (kept[k]) staying.push_back(keyframes[k]);
  }
  const KeyframeGrid grid(keyframes, 1.0);
  const SettledMap none;
  for (const std::uint32_t one : std::set<std::uint32_t>(map_of_run.begin(), map_of_run.end())) {
    std::vector<bool> shown;
    for (const std::uint32_t m : map_of_run) shown.push_back(m == one);
    const OccupancyGrid told = mapOf({staying, none, shown, last_run + 1, 0}, map, params);
    PresentMap all(map, params);
    all.update({keyframes, before, shown, last_run + 1, 0});
    std::vector<bool> usable(keyframes.size(), false);
    for (std::size_t k = 0; k < keyframes.size(); ++k) {
      usable[k] = kept[k] && shown[keyframes[k].run];
    }
    const int x0 = latticeOf(told.geometry.origin.x, cell);
    const int y0 = latticeOf(told.geometry.origin.y, cell);
    all.forEachKnown([&](int x, int y, const PresentMap::Belief& b) {
      if (!all.isKnown(b)) return;
      const std::int8_t is = b.log_odds > 0.0F ? OccupancyGrid::kOccupied : OccupancyGrid::kFree;
      if (told.valueOr({x - x0, y - y0}) == is && b.changes == 0) return;
      const Point2 center{(x + 0.5) * cell, (y + 0.5) * cell};
      const int k = nearestKept(keyframes, grid, usable, center);
      if (k < 0) return;
      const Pose2& pose = keyframes[static_cast<std::size_t>(k)].pose;
      settled.cells.push_back(
          {k, pose.inverse() * center, b.log_odds, b.visits, b.changes, last_run});
    });
  }
  return settled;
}

}  // namespace ngram_slam
