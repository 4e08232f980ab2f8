#include "ngram_slam/slam/map_merging.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "map_merger.hpp"
#include "ngram_slam/slam/consolidation.hpp"
#include "ngram_slam/slam/state_parts.hpp"

namespace ngram_slam {

namespace {

using hyselam::Range;

/// Which sessions are merged, and why the others are not.
struct Sorted {
  std::vector<std::size_t> taken;  // as given
  std::vector<LeftOutSession> left_out;
};

/// The larger ones first: they hold what a smaller one may hold too.
Sorted sorted(const std::vector<MapSession>& sessions, double max_shared) {
  Sorted out;
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    if (const char* reason = sessions[s].state.error()) {
      out.left_out.push_back({sessions[s].name, std::string("is not consistent: ") + reason});
    } else if (sessions[s].state.keyframes.empty()) {
      out.left_out.push_back({sessions[s].name, "holds no keyframes"});
    } else {
      order.push_back(s);
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return sessions[a].state.keyframes.size() > sessions[b].state.keyframes.size();
  });
  std::map<std::uint64_t, std::size_t> session_of_scan;
  for (const std::size_t s : order) {
    const std::vector<std::uint64_t> scans = scanNumbers(sessions[s].state);
    std::map<std::size_t, std::size_t> shared;  // by session
    for (const std::uint64_t scan : scans) {
      const auto known = session_of_scan.find(scan);
      if (known != session_of_scan.end()) ++shared[known->second];
    }
    const auto most =
        std::max_element(shared.begin(), shared.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most != shared.end() &&
        static_cast<double>(most->second) > max_shared * static_cast<double>(scans.size())) {
      if (most->second == scans.size()) {
        out.left_out.push_back({sessions[s].name, "holds nothing that " +
                                                      sessions[most->first].name +
                                                      " does not hold: the same recording"});
        continue;
      }
      out.left_out.push_back({sessions[s].name, "holds the same recording as " +
                                                    sessions[most->first].name + " (" +
                                                    std::to_string(most->second) + " of " +
                                                    std::to_string(scans.size()) + " keyframes)"});
      continue;
    }
    for (const std::uint64_t scan : scans) session_of_scan.emplace(scan, s);
    out.taken.push_back(s);
  }
  std::sort(out.taken.begin(), out.taken.end());
  return out;
}

/// How far around the laser of a session sees [deg].
double viewOf(const SlamState& state) {
  const hyselam::LaserScan& scan = *state.keyframes.front().scan;
  return hyselam::degrees(std::abs(scan.angle_increment) * static_cast<double>(scan.ranges.size()));
}

/// Sessions whose laser sees much less or more than that of the largest one.
std::vector<LeftOutSession> otherLasers(const std::vector<MapSession>& sessions,
                                        const std::vector<std::size_t>& taken) {
  constexpr double kOther = 1.3;
  std::vector<LeftOutSession> out;
  if (taken.empty()) return out;
  const std::size_t largest = *std::max_element(taken.begin(), taken.end(), [&](auto a, auto b) {
    return sessions[a].state.keyframes.size() < sessions[b].state.keyframes.size();
  });
  const double usual = viewOf(sessions[largest].state);
  for (const std::size_t s : taken) {
    const double view = viewOf(sessions[s].state);
    if (view * kOther >= usual && view <= usual * kOther) continue;
    out.push_back({sessions[s].name, "its laser sees " + std::to_string(std::lround(view)) +
                                         " degrees, that of " + sessions[largest].name + " " +
                                         std::to_string(std::lround(usual)) +
                                         ": few places may be recognized"});
  }
  return out;
}

/// The parts of the sessions in one of the merged maps.
std::vector<MergedPart> partsOf(const MapMerger& merger, std::uint32_t map,
                                const std::vector<std::size_t>& taken) {
  std::vector<MergedPart> parts;
  std::uint32_t run_in_map = 0, first_of_session = 0;
  for (std::uint32_t run = 0; run < merger.runs(); ++run) {
    if (run > 0 && merger.sessionOf(run) != merger.sessionOf(run - 1)) first_of_session = run;
    if (merger.mapOf(run) != map) continue;
    const std::size_t session = taken[merger.sessionOf(run)];
    if (parts.empty() || parts.back().session != session)
      parts.push_back({session, {}, {}, {}, {}});
    parts.back().runs.push_back(run_in_map++);
    parts.back().session_runs.push_back(run - first_of_session);
  }
  for (const MapMerger::TakenScan& scan : merger.scans()) {
    if (scan.map != map) continue;
    const auto part = std::find_if(parts.begin(), parts.end(), [&](const MergedPart& p) {
      return p.session == taken[scan.session];
    });
    if (part == parts.end()) continue;
    part->trajectory.push_back(scan.pose);
    part->scans.push_back(scan.number);
  }
  return parts;
}

std::vector<MergedMap> mapsOf(const MapMerger& merger, const MapMergingParams& params,
                              const std::vector<std::size_t>& taken) {
  ConsolidationParams consolidation = params.slam.consolidation;
  consolidation.max_scans = 0;
  std::vector<MergedMap> maps;
  for (std::uint32_t map = 0; map < merger.runs(); ++map) {
    if (merger.mapOf(map) != map) continue;
    std::vector<bool> runs;
    for (std::uint32_t run = 0; run < merger.runs(); ++run) {
      runs.push_back(merger.mapOf(run) == map);
    }
    maps.push_back({consolidated(partOfState(merger.state(), runs), consolidation),
                    partsOf(merger, map, taken)});
  }
  std::stable_sort(maps.begin(), maps.end(), [](const MergedMap& a, const MergedMap& b) {
    return a.state.keyframes.size() > b.state.keyframes.size();
  });
  return maps;
}

}  // namespace

void MapMergingParams::describe(hyselam::ParameterVisitor& visit) {
  const Range ratio = Range::between(0.0, 1.0);
  visit("threads", threads, Range::between(1, 1024), "", "that verify loops");
  visit("first_interval", first_interval, Range::above(0.0), "m",
        "of path between places of one map that are asked for in the others at first");
  visit("first_candidates", first_candidates, Range::between(1, 20), "", "for each of them");
  visit("second_interval", second_interval, Range::above(0.0), "m",
        "the same where a map is not tied then, or its graph knows little");
  visit("second_candidates", second_candidates, Range::between(1, 20), "", "for each of them");
  visit("ask_around", ask_around, Range::atLeast(0.0), "m",
        "of path around a verified loop between untied maps on which each place is asked for");
  visit("max_rival", max_rival, ratio, "", "support of another tie, against that of the best");
  visit("min_near_ratio", min_near_ratio, ratio, "",
        "part of the near loops farther along both paths that must fit");
  visit("min_near_tried", min_near_tried, Range::between(1, 1e6), "",
        "near loops that must have been tried there");
  visit("place_interval", place_interval, Range::atLeast(0.0), "m",
        "of path between stretches that are laid on the other maps as they are drawn; 0: none is");
  visit("min_place_near_ratio", min_place_near_ratio, ratio, "",
        "part of the near loops that say something of a tie by places that must fit");
  visit("max_shared_keyframes", max_shared_keyframes, ratio, "",
        "part of the keyframes of a session that another one may hold too");
}

void MapMergingParams::validate() const {
  hyselam::checkParameters(*this);
  slam.validate();
}

MergedMaps mergeMaps(std::vector<MapSession> sessions, const MapMergingParams& params,
                     const MergingProgress& progress) {
  params.validate();
  MergedMaps merged;
  Sorted which = sorted(sessions, params.max_shared_keyframes);
  merged.left_out = std::move(which.left_out);
  merged.doubtful = otherLasers(sessions, which.taken);
  std::vector<SlamState> states;
  for (const std::size_t s : which.taken) states.push_back(std::move(sessions[s].state));
  if (states.empty()) return merged;
  MapMerger merger(states, params, progress);
  states.clear();
  merger.run();
  merged.maps = mapsOf(merger, params, which.taken);
  merged.counters = merger.counters();
  for (MapMeeting m : merger.meetings()) {
    m.a = which.taken[m.a];
    m.b = which.taken[m.b];
    merged.meetings.push_back(m);
  }
  return merged;
}

}  // namespace ngram_slam
