#include "ngram_slam/slam/consolidation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "ngram_slam/slam/graph_reduction.hpp"
#include "ngram_slam/slam/keyframe_grid.hpp"
#include "ngram_slam/slam/run_connections.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;
using hyselam_pose_graph::PoseEdge;
using hyselam_pose_graph::PoseGraph;

namespace {

constexpr double kFirstRadius = 0.5;  // [m] of the search for the nearest keyframe

PoseEdge edgeOf(const SlamLoop& l) {
  return {l.older, l.newer, l.measured, l.weight * l.information};
}

std::vector<Pose2> posesOf(const SlamState& state) {
  std::vector<Pose2> poses;
  for (const SlamKeyframe& k : state.keyframes) poses.push_back(k.pose);
  return poses;
}

/// The part of the graph that each keyframe belongs to.
std::vector<int> componentsOf(const SlamState& state) {
  PoseGraph graph;
  graph.poses = posesOf(state);
  graph.edges = state.odometry;
  for (const SlamLoop& l : state.loops) {
    if (isUsed(l)) graph.edges.push_back(edgeOf(l));
  }
  return connectedComponents(graph);
}

/// Keyframes that must stay: the last one, where the next run is taken to begin, and those whose
/// edges have no inverse.
std::vector<bool> fixedKeyframes(const SlamState& state) {
  std::vector<bool> fixed(state.keyframes.size(), false);
  if (!fixed.empty()) fixed.back() = true;
  const auto fix = [&](const PoseEdge& e) {
    if (isInvertible(e)) return;
    fixed[static_cast<std::size_t>(e.from)] = fixed[static_cast<std::size_t>(e.to)] = true;
  };
  for (const PoseEdge& e : state.odometry) fix(e);
  for (const SlamLoop& l : state.loops) {
    if (isUsed(l)) fix(edgeOf(l));
  }
  return fixed;
}

/// Which keyframe takes the place of each: itself where it stays, else the nearest of its part of
/// the graph that does. `index`: as they are numbered afterwards.
struct Successors {
  std::vector<int> keyframe;  // numbered as before
  std::vector<int> index;     // of `keyframe`
};

int nearestKept(const SlamState& state, const KeyframeGrid& grid, int k,
                const std::vector<bool>& dropped, const std::vector<int>& components) {
  const Pose2& here = state.keyframes[static_cast<std::size_t>(k)].pose;
  int best = -1;
  double nearest = std::numeric_limits<double>::infinity();
  const auto consider = [&](int other, double distance) {
    const auto there = static_cast<std::size_t>(other);
    if (dropped[there] || components[there] != components[static_cast<std::size_t>(k)]) return;
    if (distance < nearest || (distance == nearest && other < best)) {
      nearest = distance;
      best = other;
    }
  };
  for (double radius = kFirstRadius; best < 0 && radius < 10.0; radius *= 2.0) {
    grid.forEachNear(here, radius, consider);
  }
  for (int other = 0; best < 0 && other < static_cast<int>(state.keyframes.size()); ++other) {
    consider(other, distance(state.keyframes[static_cast<std::size_t>(other)].pose, here));
  }
  return best;
}

Successors successorsOf(const SlamState& state, const std::vector<bool>& dropped,
                        const std::vector<int>& components) {
  const KeyframeGrid grid(state.keyframes, 2.0 * kFirstRadius);
  std::vector<int> index(dropped.size(), -1);
  int next = 0;
  for (std::size_t k = 0; k < dropped.size(); ++k) {
    if (!dropped[k]) index[k] = next++;
  }
  Successors s;
  for (std::size_t k = 0; k < dropped.size(); ++k) {
    const int i = static_cast<int>(k);
    s.keyframe.push_back(dropped[k] ? nearestKept(state, grid, i, dropped, components) : i);
    s.index.push_back(index[static_cast<std::size_t>(s.keyframe.back())]);
  }
  return s;
}

/// From one keyframe to what stands for it.
class Renaming {
 public:
  Renaming(const SlamState& state, const Successors& successors)
      : state_(state), successors_(successors) {}

  int index(int k) const { return successors_.index[static_cast<std::size_t>(k)]; }
  bool stays(int k) const { return successors_.keyframe[static_cast<std::size_t>(k)] == k; }
  /// A keyframe in the one that stands for it.
  Pose2 inSuccessor(int k) const {
    if (stays(k)) return {};
    return between(at(successors_.keyframe[static_cast<std::size_t>(k)]).pose, at(k).pose);
  }
  /// `newer_in_older` between those that stand for them.
  Pose2 moved(int older, int newer, const Pose2& newer_in_older) const {
    if (stays(older) && stays(newer)) return newer_in_older;
    return inSuccessor(older) * newer_in_older * inSuccessor(newer).inverse();
  }

 private:
  const SlamKeyframe& at(int k) const { return state_.keyframes[static_cast<std::size_t>(k)]; }

  const SlamState& state_;
  const Successors& successors_;
};

// ---- the graph

/// The edges of the keyframes that stay, numbered as before.
struct Edges {
  std::vector<PoseEdge> odometry;
  std::vector<SlamLoop> loops;      // as they were
  std::vector<SlamLoop> new_loops;  // composed of edges of dropped keyframes
};

/// The loop ties what the edge does.
void tieAs(const PoseEdge& e, SlamLoop* loop) {
  loop->older = e.from;
  loop->newer = e.to;
  loop->measured = e.measured;
  loop->information = e.information;
}

/// A loop from edges of which some were loops.
SlamLoop loopFrom(const PoseEdge& e) {
  SlamLoop loop;
  tieAs(e, &loop);
  loop.inlier_ratio = 1.0;
  return loop;
}

Edges edgesWithout(const SlamState& state, const std::vector<bool>& dropped) {
  const auto isDropped = [&](int a, int b) {
    return dropped[static_cast<std::size_t>(a)] || dropped[static_cast<std::size_t>(b)];
  };
  Edges edges;
  std::vector<ReducedEdge> replaced;
  for (const PoseEdge& e : state.odometry) {
    if (isDropped(e.from, e.to)) {
      replaced.push_back({e, true});
    } else {
      edges.odometry.push_back(e);
    }
  }
  double ratio = 1.0, fit = 1.0;  // of the worst loop that edges are composed of
  for (const SlamLoop& l : state.loops) {
    if (!isDropped(l.older, l.newer)) {
      edges.loops.push_back(l);
    } else if (isUsed(l)) {
      replaced.push_back({edgeOf(l), false});
      ratio = std::min(ratio, l.inlier_ratio);
      fit = std::min(fit, l.fit);
    }
  }
  for (const ReducedEdge& r : marginalizedEdges(posesOf(state), replaced, dropped)) {
    const auto run = [&](int k) { return state.keyframes[static_cast<std::size_t>(k)].run; };
    if (r.odometry && run(r.edge.from) == run(r.edge.to)) {
      edges.odometry.push_back(r.edge);
      continue;
    }
    SlamLoop loop = loopFrom(r.edge);
    loop.inlier_ratio = ratio;
    loop.fit = fit;
    edges.new_loops.push_back(loop);
  }
  std::sort(edges.odometry.begin(), edges.odometry.end(), [](const PoseEdge& a, const PoseEdge& b) {
    return std::tie(a.from, a.to) < std::tie(b.from, b.to);
  });
  return edges;
}

/// Paths of odometry, cut into pieces.
class PathPieces {
 public:
  PathPieces(const SlamState& state, const std::vector<PoseEdge>& odometry, double length)
      : piece_(state.keyframes.size(), -1), to_(state.keyframes.size(), -1), odometry_(odometry) {
    for (std::size_t e = 0; e < odometry.size(); ++e) {
      if (odometry[e].from < odometry[e].to) {
        to_[static_cast<std::size_t>(odometry[e].to)] = static_cast<int>(e);
      }
    }
    int piece = -1;
    double begin = 0.0;
    for (std::size_t k = 0; k < state.keyframes.size(); ++k) {
      const double way = state.keyframes[k].path_length;
      const int before = to_[k] < 0 ? -1 : odometry[static_cast<std::size_t>(to_[k])].from;
      // One piece has no gap: there is a path within it.
      if (before < 0 || piece_[static_cast<std::size_t>(before)] != piece || way - begin > length) {
        ++piece;
        begin = way;
      }
      piece_[k] = piece;
    }
  }

  int of(int k) const { return piece_[static_cast<std::size_t>(k)]; }

  /// Appends the steps between two keyframes of one piece.
  void appendPath(int from, int to, std::vector<PathStep>* path) const {
    std::vector<PathStep> steps;
    for (int k = std::max(from, to); k != std::min(from, to);) {
      const PoseEdge& e = odometry_[static_cast<std::size_t>(to_[static_cast<std::size_t>(k)])];
      steps.push_back({e, from > to});
      k = e.from;
    }
    if (from < to) std::reverse(steps.begin(), steps.end());
    path->insert(path->end(), steps.begin(), steps.end());
  }

 private:
  std::vector<int> piece_, to_;  // to_: edge by which a keyframe is reached
  const std::vector<PoseEdge>& odometry_;
};

/// The loop between the ends of another, by the path of odometry beside it.
SlamLoop movedOnto(const SlamLoop& loop, const SlamLoop& other, const PathPieces& pieces,
                   const std::vector<Pose2>& poses) {
  std::vector<PathStep> path;
  const bool turned = pieces.of(loop.older) != pieces.of(other.older);
  pieces.appendPath(other.older, turned ? loop.newer : loop.older, &path);
  path.push_back({edgeOf(loop), turned});
  pieces.appendPath(turned ? loop.older : loop.newer, other.newer, &path);
  SlamLoop moved = loop;
  tieAs(composedEdge(poses, path), &moved);
  moved.weight = 1.0;
  return moved;
}

/// At most `max_loops` of the loops between two pieces: the others are averaged into the best one.
std::vector<SlamLoop> limited(std::vector<SlamLoop> loops, int max_loops, const PathPieces& pieces,
                              const std::vector<Pose2>& poses) {
  const auto size = static_cast<std::size_t>(max_loops);
  if (loops.size() <= size) return loops;
  std::stable_sort(loops.begin(), loops.end(), [](const SlamLoop& a, const SlamLoop& b) {
    return (a.weight * a.information).determinant() > (b.weight * b.information).determinant();
  });
  std::vector<PoseEdge> edges = {edgeOf(loops.front())};
  for (std::size_t i = size; i < loops.size(); ++i) {
    edges.push_back(edgeOf(movedOnto(loops[i], loops.front(), pieces, poses)));
  }
  const PoseEdge mean = meanEdge(poses, edges);
  loops.front().measured = mean.measured;
  loops.front().information = mean.information;
  loops.front().weight = 1.0;
  loops.resize(size);
  return loops;
}

using LoopGroups = std::map<std::pair<int, int>, std::vector<SlamLoop>>;

/// Leaves out groups of new loops alone, within a run, of which a piece ends enough loops already;
/// the best ones stay.
void leaveOutWhereEnough(const SlamState& state, const Edges& edges, const PathPieces& pieces,
                         int max_place_loops, LoopGroups* groups) {
  std::map<int, int> ends;  // by piece
  std::set<std::pair<int, int>> known;
  for (const SlamLoop& l : edges.loops) {
    const int a = pieces.of(l.older), b = pieces.of(l.newer);
    ++ends[a];
    ++ends[b];
    known.insert(std::minmax({a, b}));
  }
  struct Fresh {
    std::pair<int, int> pair;
    double information;
  };
  std::vector<Fresh> fresh;
  for (const auto& [pair, group] : *groups) {
    const auto isWithinRun = [&](const SlamLoop& l) {
      return state.keyframes[static_cast<std::size_t>(l.older)].run ==
             state.keyframes[static_cast<std::size_t>(l.newer)].run;
    };
    if (known.count(pair) > 0 || !std::all_of(group.begin(), group.end(), isWithinRun)) continue;
    double best = 0.0;
    for (const SlamLoop& l : group) best = std::max(best, l.information.determinant());
    fresh.push_back({pair, best});
  }
  std::stable_sort(fresh.begin(), fresh.end(),
                   [](const Fresh& a, const Fresh& b) { return a.information > b.information; });
  for (const Fresh& f : fresh) {
    if (ends[f.pair.first] >= max_place_loops || ends[f.pair.second] >= max_place_loops) {
      groups->erase(f.pair);
    } else {
      ++ends[f.pair.first];
      ++ends[f.pair.second];
    }
  }
}

/// Adds the new loops to the others: between pieces of path where there are new ones, no more than
/// the limit stay.
std::vector<SlamLoop> withNewLoops(const SlamState& state, const Edges& edges,
                                   const ConsolidationParams& params) {
  const PathPieces pieces(state, edges.odometry, params.place_length);
  const auto pairOf = [&](const SlamLoop& l) {
    return std::minmax({pieces.of(l.older), pieces.of(l.newer)});  // a list: values, no references
  };
  LoopGroups groups;
  for (const SlamLoop& l : edges.new_loops) {
    // Within a piece odometry says enough.
    if (pieces.of(l.older) != pieces.of(l.newer)) groups[pairOf(l)];
  }
  std::vector<SlamLoop> loops;
  for (const SlamLoop& l : edges.loops) {
    const auto group = groups.find(pairOf(l));
    if (group == groups.end() || !isUsed(l) || !isInvertible(edgeOf(l))) {
      loops.push_back(l);
    } else {
      group->second.push_back(l);
    }
  }
  for (const SlamLoop& l : edges.new_loops) {
    const auto group = groups.find(pairOf(l));
    if (group != groups.end()) group->second.push_back(l);
  }
  const std::vector<Pose2> poses = posesOf(state);
  leaveOutWhereEnough(state, edges, pieces, params.max_place_loops, &groups);
  for (auto& [pair, group] : groups) {
    const auto few = limited(std::move(group), params.max_loops, pieces, poses);
    loops.insert(loops.end(), few.begin(), few.end());
  }
  std::stable_sort(loops.begin(), loops.end(), [](const SlamLoop& a, const SlamLoop& b) {
    return std::tie(a.newer, a.older) < std::tie(b.newer, b.older);
  });
  return loops;
}

// ---- what refers to keyframes

/// The scans that are remembered, at the keyframes that stay.
std::vector<PlacedScan> renamedScans(const SlamState& state, const Renaming& renaming,
                                     int max_scans) {
  const std::uint32_t last_run = state.keyframes.back().run;
  auto begin = state.scans.begin();
  if (max_scans > 0 && state.scans.size() > static_cast<std::size_t>(max_scans)) {
    begin = state.scans.end() - max_scans;
  }
  while (begin != state.scans.begin() &&
         state.keyframes[static_cast<std::size_t>((begin - 1)->keyframe)].run == last_run) {
    --begin;
  }
  std::vector<PlacedScan> scans(begin, state.scans.end());
  for (PlacedScan& s : scans) {
    if (!renaming.stays(s.keyframe)) {
      s.base_in_keyframe = renaming.inSuccessor(s.keyframe) * s.base_in_keyframe;
    }
    s.keyframe = renaming.index(s.keyframe);
  }
  return scans;
}

/// Far loops that wait for others like them: those of which both ends are still two.
std::vector<SlamLoop> renamedPending(const SlamState& state, const Renaming& renaming) {
  std::vector<SlamLoop> loops;
  for (SlamLoop l : state.pending_loops) {
    l.measured = renaming.moved(l.older, l.newer, l.measured);
    l.older = renaming.index(l.older);
    l.newer = renaming.index(l.newer);
    if (l.older < l.newer) loops.push_back(l);
  }
  return loops;
}

constexpr std::int64_t kForgotten = -1;

/// The numbers that the observations which stay have then; kForgotten for others.
std::vector<std::int64_t> numbersWithout(const std::vector<bool>& forgotten) {
  std::vector<std::int64_t> numbers;
  std::int64_t next = 0;
  for (const bool f : forgotten) numbers.push_back(f ? kForgotten : next++);
  return numbers;
}

/// Observations and matches of those that stay. What is left of a run after a gap is another one:
/// no word goes across.
void renameWords(const Renaming& renaming, const std::vector<std::int64_t>& numbers,
                 SlamState* state) {
  const ObservationStore& all = state->corpus.observations;
  ObservationStore kept;
  std::vector<std::int32_t> keyframes;
  for (std::uint32_t run = 0; run < all.runs(); ++run) {
    bool begun = false;
    for (std::uint32_t i = all.runBegin(run); i < all.runEnd(run); ++i) {
      if (numbers[i] == kForgotten) begun = false;
      if (numbers[i] == kForgotten) continue;
      if (!begun) kept.startRun();
      begun = true;
      kept.append(all[i]);
      keyframes.push_back(renaming.index(state->keyframe_of_observation[i]));
    }
  }
  std::vector<SlamMatch> matches;
  for (SlamMatch m : state->matches) {
    if (numbers[m.newer] == kForgotten || numbers[m.older] == kForgotten) continue;
    m.newer = static_cast<std::uint32_t>(numbers[m.newer]);
    m.older = static_cast<std::uint32_t>(numbers[m.older]);
    m.measured = renaming.moved(m.keyframe_older, m.keyframe_newer, m.measured);
    m.keyframe_older = renaming.index(m.keyframe_older);
    m.keyframe_newer = renaming.index(m.keyframe_newer);
    matches.push_back(m);
  }
  state->corpus.observations = std::move(kept);
  state->keyframe_of_observation = std::move(keyframes);
  state->matches = std::move(matches);
}

/// What the map is without the dropped keyframes, numbered as before.
SettledMap settledWithout(const SlamState& state, const std::vector<bool>& dropped,
                          const ConsolidationParams& params) {
  const RunConnections connections(state.keyframes, state.loops);
  std::vector<std::uint32_t> map_of_run;
  for (std::uint32_t run = 0; run <= state.keyframes.back().run; ++run) {
    map_of_run.push_back(connections.mapOf(run));
  }
  std::vector<bool> kept;
  for (const bool d : dropped) kept.push_back(!d);
  hyselam::OccupancyMapperParams map = params.map;
  map.resolution = params.settled_cell;
  try {
    return settledMap(state.keyframes, kept, map_of_run, state.settled, map, params.present);
  } catch (const std::length_error&) {
    return {};  // no map could be drawn
  }
}

}  // namespace

void ConsolidationParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("enabled", enabled, "drop what later runs add nothing by, when a map is loaded or saved");
  visit.group("", keyframes);
  visit("place_length", place_length, Range::above(0.0), "m",
        "of the pieces of path between which loops are counted");
  visit("max_loops", max_loops, Range::between(1, 1e6), "", "between two of them");
  visit("max_place_loops", max_place_loops, Range::between(1, 1e6), "",
        "that a piece of path ends, from which it gets no more of dropped keyframes");
  visit.group("", observations);
  visit("max_scans", max_scans, Range::between(0, 1e9), "",
        "whose poses are remembered, those of the last run besides; 0: all");
  visit.group("", present);
  visit("settled_cell", settled_cell, Range::between(0.01, 1.0), "m",
        "side of the cells in which the map of dropped keyframes is remembered");
}

void ConsolidationParams::validate() const {
  hyselam::checkParameters(*this);
}

SlamState consolidated(SlamState state, const ConsolidationParams& params) {
  params.validate();
  state.validate();
  if (!params.enabled || state.keyframes.empty()) return state;
  const std::vector<int> components = componentsOf(state);
  const std::vector<bool> dropped =
      redundantKeyframes(state.keyframes, components, fixedKeyframes(state), params.keyframes);
  if (std::find(dropped.begin(), dropped.end(), true) == dropped.end()) return state;

  const Successors successors = successorsOf(state, dropped, components);
  const Renaming renaming(state, successors);
  state.settled = settledWithout(state, dropped, params);
  for (SettledCell& c : state.settled.cells) c.keyframe = renaming.index(c.keyframe);
  Edges edges = edgesWithout(state, dropped);
  std::vector<SlamLoop> loops = withNewLoops(state, edges, params);
  state.scans = renamedScans(state, renaming, params.max_scans);
  state.pending_loops = renamedPending(state, renaming);
  renameWords(
      renaming,
      numbersWithout(redundantObservations(state, dropped, components, params.observations)),
      &state);
  for (PoseEdge& e : edges.odometry) {
    e.from = renaming.index(e.from);
    e.to = renaming.index(e.to);
  }
  for (SlamLoop& l : loops) {
    l.older = renaming.index(l.older);
    l.newer = renaming.index(l.newer);
  }
  state.odometry = std::move(edges.odometry);
  state.loops = std::move(loops);
  std::vector<SlamKeyframe> kept;
  for (std::size_t k = 0; k < dropped.size(); ++k) {
    if (!dropped[k]) kept.push_back(std::move(state.keyframes[k]));
  }
  state.keyframes = std::move(kept);
  state.validate();
  return state;
}

}  // namespace ngram_slam
