#include "ngram_slam/slam/known_maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include "fsd_localization/search/place_judge.hpp"
#include "fsd_localization/search/place_search.hpp"
#include "fsd_localization/search/submap.hpp"
#include "hyselam_common/odds.hpp"
#include "ngram_slam/slam/present_map.hpp"

namespace ngram_slam {

using fsd_localization::PlaceSearch;
using hyselam::Pose2;

struct KnownMaps::Map {
  std::uint32_t name;
  Pose2 origin;  // of the grid
  std::unique_ptr<const PlaceSearch> search;
};

KnownMaps::KnownMaps(const SlamState& state, int end, const RunConnections& connections,
                     std::optional<std::uint32_t> but, const ConsolidationParams& drawn)
    : drawn_from_(state.keyframes.begin(), state.keyframes.begin() + end),
      settled_(state.settled),
      params_(drawn) {
  if (but) but_ = connections.mapOf(*but);
  const std::uint32_t runs = drawn_from_.empty() ? 0 : drawn_from_.back().run + 1;
  for (std::uint32_t run = 0; run < runs; ++run) map_of_run_.push_back(connections.mapOf(run));
  for (const SlamKeyframe& k : drawn_from_) keyframes_.push_back({k.pose, map_of_run_[k.run]});
}

KnownMaps::~KnownMaps() = default;

/// Each map as it would be shown; all of them or none: one that is missed is missed as a rival.
void KnownMaps::draw() {
  if (drawn_) return;
  drawn_ = true;
  const std::vector<SlamKeyframe> keyframes = std::exchange(drawn_from_, {});
  const SettledMap settled = std::exchange(settled_, {});
  const auto no_session = static_cast<std::uint32_t>(map_of_run_.size());
  std::vector<Map> maps;
  for (const std::uint32_t name : std::set<std::uint32_t>(map_of_run_.begin(), map_of_run_.end())) {
    if (name == but_) continue;
    std::vector<bool> shown;
    for (const std::uint32_t map : map_of_run_) shown.push_back(map == name);
    PresentMap present(params_.map, params_.present);
    try {
      present.update({keyframes, settled, shown, no_session, 0});
    } catch (const std::length_error&) {
      return;  // too large to be drawn
    }
    const hyselam::OccupancyGrid grid = present.grid();
    // One of a few scans may show nothing.
    const bool shows = std::any_of(grid.cells.begin(), grid.cells.end(), [](std::int8_t c) {
      return c == hyselam::OccupancyGrid::kOccupied;
    });
    if (!shows) continue;
    maps.push_back({name, grid.geometry.origin, std::make_unique<const PlaceSearch>(grid)});
  }
  maps_ = std::move(maps);
}

std::optional<KnownPlace> KnownMaps::find(const std::vector<SubmapScan>& scans) {
  draw();
  return find(std::nullopt, scans);
}

std::optional<KnownPlace> KnownMaps::findBut(std::uint32_t but,
                                             const std::vector<SubmapScan>& scans) const {
  return find(but < map_of_run_.size() ? map_of_run_[but] : but, scans);
}

std::optional<KnownPlace> KnownMaps::find(std::optional<std::uint32_t> but,
                                          const std::vector<SubmapScan>& scans) const {
  fsd_localization::SubmapBuilder builder;
  for (const SubmapScan& s : scans) builder.add(*s.scan, s.pose);
  const fsd_localization::Submap submap = builder.build();
  const Map* map = nullptr;
  Pose2 base;
  double best = 0.0, rival = 0.0;
  for (const Map& m : maps_) {
    if (m.name == but) continue;
    for (const fsd_localization::Place& p : m.search->search(submap)) {
      if (p.seen <= best) {
        rival = std::max(rival, p.seen);
        continue;
      }
      rival = best;
      best = p.seen;
      map = &m;
      base = m.origin * p.base;
    }
  }
  if (map == nullptr) return std::nullopt;
  KnownPlace place;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    if (keyframes_[k].map != map->name) continue;
    const double away = distance(keyframes_[k].pose, base);
    if (away >= nearest) continue;
    nearest = away;
    place.keyframe = static_cast<int>(k);
  }
  place.base_in_keyframe = between(keyframes_[static_cast<std::size_t>(place.keyframe)].pose, base);
  // The odds were fitted where one place was the right one. However well scans fit, of two places
  // at which they fit equally none is likelier: no more than the margin tells.
  const fsd_localization::PlaceOdds odds;
  const double beside = hyselam::probabilityOf(odds.margin * (best - rival));
  place.probability = std::min(
      beside,
      fsd_localization::probabilityOfPlace(
          best, rival, fsd_localization::lengthWithTurns(submap.length, submap.turned), odds));
  return place;
}

}  // namespace ngram_slam
