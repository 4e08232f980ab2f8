// What is still apart after merging by loops is laid, stretch by stretch, on the other maps as they
// are drawn.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "map_merger.hpp"
#include "ngram_slam/slam/loop_tasks.hpp"
#include "ngram_slam/slam/observed_space.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;

namespace {

// Of two maps; with more of them a building repeats itself too much to believe one.
constexpr std::size_t kMostHypotheses = 4;
constexpr double kMostBend = 0.2;          // [rad]
constexpr double kMostContradicted = 2.0;  // of the common path, in one piece [m]
constexpr double kOnePiece =
    5.0;  // the path has left what is common where no scan is compared for longer [m]

}  // namespace

void MapMerger::tieByPlaces() {
  if (params_.place_interval <= 0.0) return;
  // Until no map is tied; what settle() parts again would be tied again.
  for (bool tied = true; tied;) {
    const std::size_t before = maps();
    askPlaces();
    std::set<MapPair> pairs;
    for (const Placed& p : placed_) pairs.insert(mapsOf(p.placed.loop));
    for (const MapPair& maps : pairs) {
      // Between maps that were not tied since they were asked.
      if (mapOf(maps.first) == maps.first && mapOf(maps.second) == maps.second) tieByPlaces(maps);
    }
    if (this->maps() < before) settle();
    tied = this->maps() < before;
  }
}

MapMerger::MapPair MapMerger::mapsOf(const SlamLoop& loop) const {
  return std::minmax({mapOfKeyframe(loop.older), mapOfKeyframe(loop.newer)});
}

/// The keyframes that the stretches end with, of all maps but the one of most keyframes: what that
/// one has in common with another is found from the other.
std::vector<int> MapMerger::stretches() const {
  std::map<std::uint32_t, int> sizes;
  for (const SlamKeyframe& k : state_.keyframes) ++sizes[mapOf(k.run)];
  const auto largest = std::max_element(
      sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<int> ends;
  if (sizes.size() < 2) return ends;
  std::optional<std::uint32_t> run;
  double last = 0.0;
  for (std::size_t k = 0; k < state_.keyframes.size(); ++k) {
    const SlamKeyframe& here = state_.keyframes[k];
    if (mapOf(here.run) == largest->first) continue;
    if (run != here.run) last = here.path_length;
    run = here.run;
    if (here.path_length - last < params_.place_interval) continue;
    last = here.path_length;
    ends.push_back(static_cast<int>(k));
  }
  return ends;
}

/// Lays each stretch on all other maps, and asks the scans at the places that are likelier than one
/// with an equal beside it.
void MapMerger::askPlaces() {
  placed_.clear();
  const std::vector<int> ends = stretches();
  if (ends.empty()) return;
  KnownMaps drawn(state_, static_cast<int>(state_.keyframes.size()), connections_, std::nullopt,
                  params_.slam.consolidation);
  drawn.draw();
  std::vector<std::optional<KnownPlace>> places(ends.size());
  for (std::size_t i = 0; i < ends.size(); i += kStretchesAtOnce) {
    if (progress_) progress_("laying stretches on maps", i, ends.size());
    const std::size_t n = std::min(kStretchesAtOnce, ends.size() - i);
    forEach(n, [&](std::size_t k) {
      const int last = ends[i + k];
      places[i + k] = drawn.findBut(keyframe(last).run, lastMetres(state_.keyframes, last));
    });
  }
  counters_.stretches += static_cast<int>(ends.size());
  std::vector<LoopTask> tasks;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (!places[i] || places[i]->probability <= params_.slam.run_start.min_place_probability) {
      continue;
    }
    tasks.push_back(placeTask(ends[i], *places[i]));
    placed_.push_back({{{}, places[i]->probability}, ends[i]});
  }
  const std::vector<LoopVerification> answers = verified(tasks);
  for (std::size_t i = 0; i < answers.size(); ++i) placed_[i].placed.loop = answers[i].loop;
  std::vector<Placed> found;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (answers[i].verified) found.push_back(placed_[i]);
  }
  placed_ = std::move(found);
}

/// Between the middle of the stretch's last metres and the place.
LoopTask MapMerger::placeTask(int last, const KnownPlace& place) const {
  const LoopParams& p = params_.slam.loop;
  const double end = keyframe(last).path_length;
  int middle = last;
  while (middle > 0 && keyframe(middle - 1).run == keyframe(last).run &&
         end - keyframe(middle).path_length < p.far_new_segment_half_length) {
    --middle;
  }
  const Pose2 there = place.base_in_keyframe * between(keyframe(last).pose, keyframe(middle).pose);
  const bool is_later = place.keyframe < middle;
  LoopTask task = is_later ? farLoopTask(state_.keyframes, place.keyframe, middle, p)
                           : farLoopTask(state_.keyframes, middle, place.keyframe, p);
  task.source = LoopSource::kProximity;
  task.initial_guess = is_later ? there : there.inverse();
  task.any_heading = false;
  task.window = kPlaceWindow;
  task.angle = kPlaceAngle;
  task.place_probability = place.probability;
  return task;
}

/// Whether two places are found with no scan in common, somewhere else in the map: what looks like
/// another place does so each time that a robot passes it.
bool MapMerger::areIndependent(const Placed& a, const Placed& b) const {
  const SlamKeyframe &here = keyframe(a.last), &there = keyframe(b.last);
  return (here.run != there.run || std::abs(here.path_length - there.path_length) > kSubmapPath) &&
         distance(here.pose, there.pose) > 0.5 * kSubmapPath;
}

/// Pairs of independent places that say the same of two maps, each without a rival (isSurePlace()
/// of the first, sure_place_probability of the second). Of pairs that do not contradict each other
/// the one with most support stands for all.
std::vector<MapTie> MapMerger::hypothesesOf(const MapPair& maps) const {
  const LoopParams& p = params_.slam.loop;
  std::vector<SlamLoop> found_otherwise, all;
  for (const SlamLoop& l : pending_) {
    if (mapsOf(l) == maps) found_otherwise.push_back(l);
  }
  all = found_otherwise;
  std::vector<const Placed*> placed;
  for (const Placed& one : placed_) {
    if (mapsOf(one.placed.loop) != maps) continue;
    all.push_back(one.placed.loop);
    if (one.placed.place_probability >= params_.slam.run_start.sure_place_probability) {
      placed.push_back(&one);
    }
  }
  const auto contradict = [&](const SlamLoop& a, const SlamLoop& b) {
    return isContradiction(loopInconsistency(a, b, state_.keyframes, connections_), p);
  };
  std::vector<MapTie> pairs;
  for (const Placed* a : placed) {
    const SlamLoop& loop = a->placed.loop;
    if (!isSurePlace(a->placed, all, found_otherwise, state_.keyframes, connections_,
                     params_.slam)) {
      continue;
    }
    double support = 0.0;
    for (const Placed* b : placed) {
      if (!contradict(loop, b->placed.loop)) support += b->placed.loop.inlier_ratio;
    }
    for (const Placed* b : placed) {
      if (a != b && areIndependent(*a, *b) &&
          !consistentLoops(loop, {b->placed.loop}, state_.keyframes, connections_, p).empty()) {
        pairs.push_back({{loop, b->placed.loop}, support, 0.0});
        break;
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const MapTie& a, const MapTie& b) { return a.support > b.support; });
  std::vector<MapTie> hypotheses;
  for (const MapTie& pair : pairs) {
    const bool is_new = std::all_of(hypotheses.begin(), hypotheses.end(), [&](const MapTie& known) {
      return contradict(pair.loops.front(), known.loops.front());
    });
    if (is_new) hypotheses.push_back(pair);
  }
  return hypotheses;
}

/// Each hypothesis of where two maps lie to each other is tried; one that alone is borne out ties
/// them.
void MapMerger::tieByPlaces(const MapPair& maps) {
  const std::vector<MapTie> hypotheses = hypothesesOf(maps);
  if (hypotheses.size() > kMostHypotheses) return;
  const MapTie* right = nullptr;
  for (const MapTie& tie : hypotheses) {
    const Untied before = untied();
    const std::vector<SlamLoop> pending = pending_, withdrawn = withdrawn_;
    join(tie);
    closeNear(maps.first);
    const bool holds =
        mapOf(maps.second) == mapOf(maps.first) && bend(before) <= kMostBend && isBorneOutByScans();
    withdraw(before, tie, true);
    pending_ = pending;  // it was a trial: nothing is known of its loops that was not known before
    withdrawn_ = withdrawn;
    if (!holds) continue;
    if (right != nullptr) return;  // both would do
    right = &tie;
  }
  if (right == nullptr) return;
  join(*right);
  closeNear(maps.first);
  undecided_.clear();
  ++counters_.place_ties;
}

/// How far a tie turned parts of a map against each other that was one before it, at most [rad]:
/// loops of two maps that do not lie so are often far enough apart to pull both out of shape
/// instead of contradicting each other.
double MapMerger::bend(const Untied& before) const {
  std::map<std::uint32_t, std::pair<double, double>> turns;  // by map before, least and most
  std::map<std::uint32_t, double> firsts;
  for (std::size_t k = 0; k < before.poses.size(); ++k) {
    const std::uint32_t map = before.map_of_run[state_.keyframes[k].run];
    const double turn = state_.keyframes[k].pose.theta - before.poses[k].theta;
    const double first = firsts.emplace(map, turn).first->second;
    const double since = hyselam::normalizeAngle(turn - first);
    auto& [least, most] = turns.emplace(map, std::make_pair(0.0, 0.0)).first->second;
    least = std::min(least, since);
    most = std::max(most, since);
  }
  double worst = 0.0;
  for (const auto& [map, range] : turns) worst = std::max(worst, range.second - range.first);
  return worst;
}

/// What a near try says after a tie by places: the scans fit, or what one map saw as a wall the
/// other saw as free. Scans that see what the other map has not seen, as those of a robot that went
/// the other way, say nothing.
MapMerger::Evidence MapMerger::evidenceOf(const NearTry& t) const {
  if (t.fits) return Evidence::kFits;
  const LoopParams& p = params_.slam.loop;
  const LoopTask near = nearLoopTask(state_.keyframes, t.older, t.newer, p.near_max_uncertainty, p);
  const LoopTask::Segment around = farLoopTask(state_.keyframes, t.older, t.newer, p).new_segment;
  ObservedSpace of_old(p.observed_space_side, p.far_resolution), of_new = of_old;
  for (const LoopTask::PosedScan& s : near.old_segment) of_old.insert(s.pose, *s.points, s.laser);
  for (const LoopTask::PosedScan& s : around) of_new.insert(s.pose, *s.points, s.laser);
  const Overlap new_in_old = of_old.overlap(near.initial_guess, *keyframe(t.newer).points);
  Overlap old_in_new;  // mean of the scans
  double observed = 0.0, on_surface = 0.0, all = 0.0;
  for (const LoopTask::PosedScan& s : near.old_segment) {
    const Overlap o = of_new.overlap(near.initial_guess.inverse() * s.pose, *s.points);
    const auto points = static_cast<double>(s.points->size());
    all += points;
    observed += points * o.observed_ratio;
    on_surface += points * o.observed_ratio * o.surface_ratio;
  }
  if (all > 0.0) old_in_new.observed_ratio = observed / all;
  if (observed > 0.0) old_in_new.surface_ratio = on_surface / observed;
  for (const Overlap& o : {new_in_old, old_in_new}) {
    if (o.observed_ratio >= p.min_overlap && o.surface_ratio < p.near_min_surface_ratio) {
      return Evidence::kAgainst;
    }
  }
  return Evidence::kNone;
}

/// Whether most of the common path bears a tie by places out, and no part of it contradicts.
bool MapMerger::isBorneOutByScans() const {
  int fit = 0, against = 0;
  std::map<int, Evidence> along;  // by the newer keyframe; what fits counts more
  for (const NearTry& t : near_tries_) {
    const Evidence e = evidenceOf(t);
    fit += e == Evidence::kFits ? 1 : 0;
    against += e == Evidence::kAgainst ? 1 : 0;
    Evidence& here = along.emplace(t.newer, e).first->second;
    if (e == Evidence::kFits || (e == Evidence::kAgainst && here == Evidence::kNone)) here = e;
  }
  double contradicted = 0.0;  // [m] of path at most
  std::optional<int> begin, before;
  for (const auto& [k, e] : along) {
    const bool goes_on = before && keyframe(*before).run == keyframe(k).run &&
                         keyframe(k).path_length - keyframe(*before).path_length <= kOnePiece;
    before = k;
    if (e == Evidence::kFits || !goes_on) begin.reset();
    if (e != Evidence::kAgainst) continue;
    if (!begin) begin = k;
    contradicted = std::max(contradicted, keyframe(k).path_length - keyframe(*begin).path_length);
  }
  return fit + against >= params_.min_near_tried &&
         fit >= params_.min_place_near_ratio * (fit + against) && contradicted <= kMostContradicted;
}

}  // namespace ngram_slam
