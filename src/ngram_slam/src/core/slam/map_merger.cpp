#include "map_merger.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "ngram_slam/slam/far_loops.hpp"
#include "ngram_slam/slam/loop_tasks.hpp"
#include "ngram_slam/slam/run_graph.hpp"
#include "ngram_slam/slam/state_parts.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;

namespace {

constexpr std::size_t kTasksAtOnce = 64;  // whose scans are held
constexpr int kMostNearRounds = 60;

}  // namespace

MapMerger::MapMerger(const std::vector<SlamState>& sessions, const MapMergingParams& params,
                     MergingProgress progress)
    : params_(params), progress_(std::move(progress)), state_(joinedStates(sessions)) {
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    session_of_scan_.resize(session_of_scan_.size() + sessions[s].scans.size(), s);
    const std::uint32_t runs = runsOf(joinedStates({sessions[s]}));
    session_of_run_.resize(session_of_run_.size() + runs, s);
  }
  given_ = connections_ = RunConnections(state_.keyframes, state_.loops);
  is_near_asked_.assign(state_.keyframes.size(), false);
  rebuildPathLengths();
}

void MapMerger::run() {
  if (progress_) progress_("signing places", 0, 1);
  questions_.emplace(state_, params_.slam.signatures);
  askAll("asking for places", params_.first_interval, params_.first_candidates);
  settle();
  askAll("asking for more places", params_.second_interval, params_.second_candidates);
  settle();
  askAroundVerified();
  settle();
  tieByPlaces();
  for (std::uint32_t map = 0; map < runs(); ++map) {
    if (mapOf(map) == map && isMerged(map)) optimize(map);
  }
  for (const SlamLoop& l : pending_) {
    if (connections_.connected(keyframe(l.older).run, keyframe(l.newer).run)) {
      state_.pending_loops.push_back(l);
    }
  }
}

std::size_t MapMerger::maps() const {
  std::size_t count = 0;
  for (std::uint32_t run = 0; run < runs(); ++run) count += mapOf(run) == run ? 1 : 0;
  return count;
}

/// Whether a map is of several that were given.
bool MapMerger::isMerged(std::uint32_t map) const {
  for (std::uint32_t run = 0; run < runs(); ++run) {
    if (mapOf(run) == map && !given_.connected(run, map)) return true;
  }
  return false;
}

// ---- far loops

void MapMerger::askAll(const std::string& step, double interval, int candidates) {
  verifyFar(step, questions_->ask(
                      interval, candidates, [](int) { return true; },
                      [this](int older, int newer) { return isOpen(older, newer); },
                      &counters_.questions));
}

/// Loops between maps that are not tied, too few to be believed, may have company: the same two
/// maps are asked at each place around them.
void MapMerger::askAroundVerified() {
  std::vector<SlamLoop> found;
  for (const SlamLoop& l : pending_) {
    if (mapOfKeyframe(l.older) != mapOfKeyframe(l.newer)) found.push_back(l);
  }
  int maps_around = -1;  // keyframe
  std::set<std::uint32_t> maps;
  const auto isNear = [&](int k) {
    if (k == maps_around) return !maps.empty();
    maps_around = k;
    maps.clear();
    for (const SlamLoop& l : found) {
      if (keyframe(k).run == keyframe(l.newer).run &&
          std::abs(keyframe(k).path_length - keyframe(l.newer).path_length) <= params_.ask_around) {
        maps.insert(mapOfKeyframe(l.older));
      }
    }
    return !maps.empty();
  };
  verifyFar("asking around",
            questions_->ask(
                params_.slam.signatures.sensor.spacing, params_.second_candidates, isNear,
                [&](int older, int newer) {
                  return isNear(newer) && maps.count(mapOfKeyframe(older)) > 0;
                },
                &counters_.questions));
}

/// Between maps that were given: of two that are tied, where the graph knows little.
bool MapMerger::isOpen(int older, int newer) {
  if (!areStrangers(older, newer)) return false;
  if (mapOfKeyframe(older) != mapOfKeyframe(newer)) return true;
  if (lengths_of_ != newer) {
    lengths_of_ = newer;
    lengths_ = path_lengths_.from(newer);
  }
  return params_.slam.loop.positionUncertainty(lengths_[static_cast<std::size_t>(older)]) >
         params_.slam.loop.near_max_uncertainty;
}

/// Calls `work` with each number below `n`, on several threads.
void MapMerger::forEach(std::size_t n, const std::function<void(std::size_t)>& work) const {
  std::atomic<std::size_t> next{0};
  const auto some = [&] {
    for (std::size_t i = next++; i < n; i = next++) work(i);
  };
  // The future of a thread has its exception.
  const auto threads = std::min<std::size_t>(static_cast<std::size_t>(params_.threads), n);
  std::vector<std::future<void>> helpers;
  for (std::size_t i = 1; i < threads; ++i) {
    helpers.push_back(std::async(std::launch::async, some));
  }
  some();
  for (std::future<void>& f : helpers) f.get();
}

std::vector<LoopVerification> MapMerger::verified(const std::vector<LoopTask>& tasks) const {
  std::vector<LoopVerification> answers(tasks.size());
  forEach(tasks.size(), [&](std::size_t i) { answers[i] = verifyLoop(tasks[i], params_.slam); });
  return answers;
}

void MapMerger::verifyFar(const std::string& step,
                          const std::vector<SignatureCandidate>& candidates) {
  for (std::size_t i = 0; i < candidates.size(); i += kTasksAtOnce) {
    if (progress_) progress_(step, i, candidates.size());
    std::vector<LoopTask> tasks;
    for (std::size_t k = i; k < std::min(i + kTasksAtOnce, candidates.size()); ++k) {
      tasks.push_back(farLoopTask(state_.keyframes, candidates[k].keyframe_older,
                                  candidates[k].keyframe_newer, params_.slam.loop));
    }
    counters_.tried += static_cast<int>(tasks.size());
    for (const LoopVerification& v : verified(tasks)) {
      if (!v.verified) continue;
      ++counters_.verified;
      pending_.push_back(v.loop);
    }
  }
  lengths_of_ = -1;  // the graph may change
}

// ---- ties

void MapMerger::settle() {
  while (const auto tie = bestTieOfAll()) {
    const Untied before = untied();
    const std::uint32_t run = keyframe(tie->loops.front().newer).run;
    join(*tie);
    closeNear(run);
    const TieEvidence evidence = evidenceFor(*tie, before.map_of_run);
    if (evidence == TieEvidence::kBorneOut) {
      undecided_.clear();
    } else {
      withdraw(before, *tie, evidence == TieEvidence::kAgainst);
    }
  }
  // What the maps know of each other now may make more of it believable.
  while (believeWithinMaps()) {
    for (std::uint32_t map = 0; map < runs(); ++map) {
      if (mapOf(map) == map) closeNear(map);
    }
  }
}

/// The one with most support, of any two maps.
std::optional<MapTie> MapMerger::bestTieOfAll() const {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<SlamLoop>> by_maps;
  for (const SlamLoop& l : pending_) {
    const std::uint32_t a = mapOfKeyframe(l.older), b = mapOfKeyframe(l.newer);
    if (a != b) by_maps[{std::min(a, b), std::max(a, b)}].push_back(l);
  }
  std::optional<MapTie> best;
  for (const auto& [maps, loops] : by_maps) {
    auto tie = bestTie(loops, state_.keyframes, connections_, params_.slam.loop, params_.max_rival);
    if (!tie) continue;
    const auto tried = undecided_.find(maps);
    if (tried != undecided_.end() && tie->support <= tried->second) continue;
    if (!best || tie->support > best->support) best = std::move(tie);
  }
  return best;
}

void MapMerger::addLoop(const SlamLoop& loop) {
  state_.loops.push_back(loop);
  path_lengths_.addEdge(loop.older, loop.newer, params_.slam.loop.loop_path_length);
}

/// Moves the later map to where the tie says that it lies.
void MapMerger::join(const MapTie& tie) {
  ++counters_.ties;
  const SlamLoop& first = tie.loops.front();
  const std::uint32_t a = mapOfKeyframe(first.older), b = mapOfKeyframe(first.newer);
  Pose2 correction =
      keyframe(first.older).pose * first.measured * keyframe(first.newer).pose.inverse();
  if (b < a) correction = correction.inverse();
  for (SlamKeyframe& k : state_.keyframes) {
    if (mapOf(k.run) == std::max(a, b)) k.pose = correction * k.pose;
  }
  connections_.connect(a, b);
  for (const SlamLoop& l : tie.loops) {
    addLoop(l);
    const auto same = std::find_if(pending_.begin(), pending_.end(),
                                   [&](const SlamLoop& p) { return isSamePair(p, l); });
    if (same != pending_.end()) pending_.erase(same);
  }
  near_tries_.clear();
  near_asked_since_.clear();
  // There are new maps to compare them with.
  for (std::size_t k = 0; k < is_near_asked_.size(); ++k) {
    if (mapOf(state_.keyframes[k].run) == std::min(a, b)) is_near_asked_[k] = false;
  }
  optimize(std::min(a, b));
}

/// What the near loops along the common path say of a tie. Those beside its first loop do not
/// count: the segments by which that one was verified, and found among all others, say the same.
MapMerger::TieEvidence MapMerger::evidenceFor(const MapTie& tie,
                                              const std::vector<std::uint32_t>& maps_before) const {
  std::size_t before = 0;
  for (std::uint32_t run = 0; run < runs(); ++run) before += maps_before[run] == run ? 1 : 0;
  if (maps() >= before) return TieEvidence::kAgainst;  // the graph itself gave up its loops
  const auto isBeside = [&](int k, int of_loop) {
    const SlamKeyframe &here = keyframe(k), &there = keyframe(of_loop);
    return here.run == there.run && std::abs(here.path_length - there.path_length) <=
                                        params_.slam.loop.far_new_segment_half_length;
  };
  const SlamLoop& first = tie.loops.front();
  int tried = 0, fit = 0;
  for (const NearTry& t : near_tries_) {
    if (isBeside(t.newer, first.newer) || isBeside(t.older, first.older)) continue;
    ++tried;
    fit += t.fits ? 1 : 0;
  }
  if (tried < params_.min_near_tried) return TieEvidence::kTooLittle;
  return fit >= params_.min_near_ratio * tried ? TieEvidence::kBorneOut : TieEvidence::kAgainst;
}

MapMerger::Untied MapMerger::untied() const {
  Untied all;
  for (std::uint32_t run = 0; run < runs(); ++run) all.map_of_run.push_back(mapOf(run));
  for (const SlamKeyframe& k : state_.keyframes) all.poses.push_back(k.pose);
  all.loops = state_.loops;
  return all;
}

/// The maps are as they were before the tie. If it is wrong, none is made of its loops again; else
/// its loops wait for more.
void MapMerger::withdraw(const Untied& before, const MapTie& tie, bool is_wrong) {
  ++counters_.ties_withdrawn;
  for (std::size_t i = 0; i < before.poses.size(); ++i) state_.keyframes[i].pose = before.poses[i];
  state_.loops = before.loops;
  std::vector<SlamLoop>& back = is_wrong ? withdrawn_ : pending_;
  back.insert(back.end(), tie.loops.begin(), tie.loops.end());
  for (const auto& asked : near_asked_since_) {
    near_asked_.erase(asked);
    is_near_asked_[static_cast<std::size_t>(asked.first)] = false;
  }
  connections_ = RunConnections(state_.keyframes, state_.loops);
  rebuildPathLengths();
  if (!is_wrong) {
    const SlamLoop& first = tie.loops.front();
    const std::uint32_t a = mapOfKeyframe(first.older), b = mapOfKeyframe(first.newer);
    undecided_[{std::min(a, b), std::max(a, b)}] = tie.support;
  }
}

/// Whether the graph knows the pose of one end well enough to say that a loop is wrong.
bool MapMerger::excludes(const SlamLoop& loop) const {
  const LoopParams& p = params_.slam.loop;
  const double length =
      path_lengths_.from(loop.newer, {loop.older})[static_cast<std::size_t>(loop.older)];
  const Pose2 known = between(keyframe(loop.older).pose, keyframe(loop.newer).pose);
  return std::isfinite(length) &&
         distance(known, loop.measured) > p.positionUncertainty(length) + p.visibility_margin;
}

/// Far loops within maps, as SlamEngine believes them. Whether there are new ones.
bool MapMerger::believeWithinMaps() {
  std::vector<SlamLoop> used, waiting, others, believed;
  for (const SlamLoop& l : state_.loops) {
    if (l.far && isUsed(l)) used.push_back(l);
  }
  for (const SlamLoop& l : pending_) {
    if (mapOfKeyframe(l.older) != mapOfKeyframe(l.newer) || excludes(l)) {
      others.push_back(l);
      continue;
    }
    for (const SlamLoop& b :
         believeFarLoops(l, used, state_.keyframes, connections_, params_.slam.loop, &waiting,
                         std::numeric_limits<std::size_t>::max())) {
      believed.push_back(b);
      used.push_back(b);
    }
  }
  pending_ = std::move(others);
  pending_.insert(pending_.end(), waiting.begin(), waiting.end());
  std::set<std::uint32_t> changed;
  for (const SlamLoop& l : believed) {
    addLoop(l);
    changed.insert(mapOfKeyframe(l.older));
  }
  for (const std::uint32_t map : changed) optimize(map);
  return !believed.empty();
}

// ---- near loops

/// Of keyframes whose pose beside the path of another given map is known well, that were not
/// compared with that map yet.
std::vector<LoopTask> MapMerger::nearTasks() {
  struct Near {
    int older;
    double uncertainty, distance;
  };
  const LoopParams& p = params_.slam.loop;
  double reach = 0.0;  // of paths through the graph after which poses are known well
  while (p.positionUncertainty(reach) <= p.near_max_uncertainty) reach += 0.1;
  std::vector<LoopTask> tasks;
  const auto n = static_cast<int>(state_.keyframes.size());
  for (int k = 0; k < n; k += p.near_search_interval) {
    if (is_near_asked_[static_cast<std::size_t>(k)]) continue;
    std::vector<Near> found;
    double last_path_length = 0.0;
    std::uint32_t last_run = 0;
    for (const auto& [older, length] : path_lengths_.within(k, reach)) {
      const double uncertainty = p.positionUncertainty(length);
      if (older >= k || !areStrangers(older, k) || uncertainty > p.near_max_uncertainty ||
          near_asked_.count({k, given_.mapOf(keyframe(older).run)}) > 0) {
        continue;
      }
      const Near near{older, uncertainty, distance(keyframe(older).pose, keyframe(k).pose)};
      if (near.distance >= uncertainty + p.visibility_margin) continue;
      // One of each segment of the older path: its nearest keyframe.
      const bool same_segment =
          !found.empty() && last_run == keyframe(older).run &&
          keyframe(older).path_length - last_path_length <= p.candidate_spacing;
      if (!same_segment) {
        found.push_back(near);
      } else if (near.distance < found.back().distance) {
        found.back() = near;
      }
      last_path_length = keyframe(older).path_length;
      last_run = keyframe(older).run;
    }
    if (found.empty()) continue;
    is_near_asked_[static_cast<std::size_t>(k)] = true;
    for (const Near& near : found) {
      const std::pair<int, std::uint32_t> asked{k, given_.mapOf(keyframe(near.older).run)};
      if (near_asked_.insert(asked).second) near_asked_since_.push_back(asked);
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Near& a, const Near& b) { return a.distance < b.distance; });
    for (int i = 0; i < std::min(p.near_max_candidates, static_cast<int>(found.size())); ++i) {
      const Near& near = found[static_cast<std::size_t>(i)];
      tasks.push_back(nearLoopTask(state_.keyframes, near.older, k, near.uncertainty, p));
    }
  }
  return tasks;
}

/// Along the path that the map of a run has in common with itself, as far as each step makes the
/// next one known.
void MapMerger::closeNear(std::uint32_t run) {
  const LoopParams& p = params_.slam.loop;
  for (int round = 0; round < kMostNearRounds; ++round) {
    if (progress_)
      progress_("comparing common paths", static_cast<std::size_t>(round), kMostNearRounds);
    const std::vector<LoopTask> tasks = nearTasks();
    bool added = false;
    for (const LoopVerification& v : verified(tasks)) {
      ++counters_.near_tried;
      const bool fits =
          v.verified && distance(between(keyframe(v.loop.older).pose, keyframe(v.loop.newer).pose),
                                 v.loop.measured) <= p.near_max_uncertainty + p.visibility_margin;
      near_tries_.push_back({v.loop.older, v.loop.newer, fits});
      if (!fits) continue;
      ++counters_.near_verified;
      addLoop(v.loop);
      added = true;
    }
    if (!added) return;
    optimize(mapOf(run));
  }
}

// ---- the graph

/// One of the maps.
void MapMerger::optimize(std::uint32_t map) {
  hyselam_pose_graph::PoseGraph graph;
  std::vector<int> pose_of(state_.keyframes.size(), -1), keyframe_of;
  const auto add = [&](int k, const Pose2& pose) {
    graph.ids.push_back(static_cast<std::int64_t>(graph.poses.size()));
    graph.poses.push_back(pose);
    keyframe_of.push_back(k);
  };
  std::optional<std::uint32_t> run;
  for (std::size_t k = 0; k < state_.keyframes.size(); ++k) {
    const SlamKeyframe& here = state_.keyframes[k];
    if (mapOf(here.run) != map) continue;
    // A pose without edges: a loop from the end of one run to the begin of the next one is not
    // odometry.
    if (run && *run != here.run) add(-1, {});
    run = here.run;
    pose_of[k] = static_cast<int>(graph.poses.size());
    add(static_cast<int>(k), here.pose);
  }
  const auto addEdge = [&](hyselam_pose_graph::PoseEdge e) {
    e.from = pose_of[static_cast<std::size_t>(e.from)];
    e.to = pose_of[static_cast<std::size_t>(e.to)];
    if (e.from < 0 || e.to < 0) return false;
    graph.edges.push_back(e);
    return true;
  };
  for (const auto& e : state_.odometry) addEdge(e);
  const std::size_t odometry_edges = graph.edges.size();
  std::vector<std::size_t> loops;
  for (std::size_t l = 0; l < state_.loops.size(); ++l) {
    const SlamLoop& loop = state_.loops[l];
    if (addEdge({loop.older, loop.newer, loop.measured, loop.information})) loops.push_back(l);
  }
  const auto optimized = optimizedGraph(std::move(graph), params_.slam);
  for (std::size_t i = 0; i < optimized.poses.size(); ++i) {
    if (keyframe_of[i] >= 0) {
      state_.keyframes[static_cast<std::size_t>(keyframe_of[i])].pose = optimized.poses[i];
    }
  }
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (odometry_edges + i < optimized.weights.size()) {
      state_.loops[loops[i]].weight = optimized.weights[odometry_edges + i];
    }
  }
  ++state_.counters.optimizations;
  connections_ = RunConnections(state_.keyframes, state_.loops);
  rebuildPathLengths();
}

void MapMerger::rebuildPathLengths() {
  path_lengths_.clear();
  for (const auto& e : state_.odometry) {
    path_lengths_.addEdge(e.from, e.to, std::hypot(e.measured.x, e.measured.y));
  }
  for (const SlamLoop& l : state_.loops) {
    if (isUsed(l)) {
      path_lengths_.addEdge(l.older, l.newer, params_.slam.loop.loop_path_length);
    }
  }
}

// ---- what came of it

std::vector<MapMeeting> MapMerger::meetings() const {
  std::map<std::pair<std::size_t, std::size_t>, MapMeeting> all;
  const auto meetingOf = [&](const SlamLoop& l) -> MapMeeting* {
    const std::size_t a = sessionOfKeyframe(l.older), b = sessionOfKeyframe(l.newer);
    if (a == b) return nullptr;
    MapMeeting& m = all[{std::min(a, b), std::max(a, b)}];
    m.a = std::min(a, b);
    m.b = std::max(a, b);
    return &m;
  };
  for (const SlamLoop& l : state_.loops) {
    MapMeeting* m = meetingOf(l);
    if (m == nullptr) continue;
    if (!isUsed(l)) {
      ++m->doubted;
      continue;
    }
    ++(l.far ? m->far_loops : m->near_loops);
    if (l.far) m->fit += l.fit;
  }
  for (const auto* loops : {&pending_, &withdrawn_}) {
    for (const SlamLoop& l : *loops) {
      if (MapMeeting* m = meetingOf(l)) ++m->doubted;
    }
  }
  std::vector<MapMeeting> out;
  for (auto& [sessions, m] : all) {
    if (m.far_loops > 0) m.fit /= m.far_loops;
    out.push_back(m);
  }
  return out;
}

std::vector<MapMerger::TakenScan> MapMerger::scans() const {
  std::vector<TakenScan> out;
  std::size_t number = 0;
  for (std::size_t i = 0; i < state_.scans.size(); ++i) {
    const PlacedScan& s = state_.scans[i];
    number = i > 0 && session_of_scan_[i] == session_of_scan_[i - 1] ? number + 1 : 0;
    out.push_back({session_of_scan_[i],
                   number,
                   mapOfKeyframe(s.keyframe),
                   {s.stamp, keyframe(s.keyframe).pose * s.base_in_keyframe}});
  }
  return out;
}

}  // namespace ngram_slam
