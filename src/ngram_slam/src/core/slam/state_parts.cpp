#include "ngram_slam/slam/state_parts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ngram_slam {

namespace {

template <typename Counts>
void addCounts(const Counts& from, Counts* to) {
  to->tried += from.tried;
  to->verified += from.verified;
  to->accepted += from.accepted;
}

void addCounters(const SlamCounters& from, SlamCounters* to) {
  to->scans += from.scans;
  to->matched += from.matched;
  to->relocalized += from.relocalized;
  to->weak_matches += from.weak_matches;
  to->odometry_jumps += from.odometry_jumps;
  to->optimizations += from.optimizations;
  addCounts(from.near, &to->near);
  addCounts(from.far, &to->far);
  addCounts(from.words, &to->words);
  addCounts(from.signatures, &to->signatures);
}

void appendObservations(const ObservationStore& from, ObservationStore* to) {
  for (std::uint32_t run = 0; run < from.runs(); ++run) {
    to->startRun();
    for (std::uint32_t i = from.runBegin(run); i < from.runEnd(run); ++i) to->append(from[i]);
  }
}

/// The same in smaller cells: as many beside each other as a large one is wide.
SettledMap withCells(const SettledMap& settled, double cell) {
  const int n = static_cast<int>(std::ceil(settled.cell / cell - 1e-6));
  if (n <= 1) {
    SettledMap same = settled;
    same.cell = cell;
    return same;
  }
  SettledMap out;
  out.cell = cell;
  const double step = settled.cell / n;
  for (const SettledCell& c : settled.cells) {
    for (int i = 0; i < n * n; ++i) {
      SettledCell part = c;
      part.center.x += step * (i % n - 0.5 * (n - 1));
      part.center.y += step * (i / n - 0.5 * (n - 1));
      out.cells.push_back(part);
    }
  }
  return out;
}

/// Puts a state behind others.
void append(const SlamState& s, SlamState* all) {
  const auto keyframes = static_cast<int>(all->keyframes.size());
  const std::uint32_t runs = runsOf(*all), observations = all->corpus.observations.size();
  const double path = keyframes > 0 ? all->keyframes.back().path_length : 0.0;
  const double begin = s.keyframes.empty() ? 0.0 : s.keyframes.front().path_length;
  std::uint32_t run = runs;
  std::vector<std::uint32_t> run_after(std::max(runsOf(s), 1U), runs);  // by run
  for (std::size_t i = 0; i < s.keyframes.size(); ++i) {
    if (i > 0 && s.keyframes[i].run != s.keyframes[i - 1].run) ++run;  // some may be gone
    std::fill(run_after.begin() + s.keyframes[i].run, run_after.end(), run);
    all->keyframes.push_back(s.keyframes[i]);
    all->keyframes.back().run = run;
    all->keyframes.back().path_length += path - begin;
  }
  for (PlacedScan p : s.scans) {
    p.keyframe += keyframes;
    all->scans.push_back(p);
  }
  for (hyselam_pose_graph::PoseEdge e : s.odometry) {
    e.from += keyframes;
    e.to += keyframes;
    all->odometry.push_back(e);
  }
  for (const auto& [from, to] : {std::make_pair(&s.loops, &all->loops),
                                 std::make_pair(&s.pending_loops, &all->pending_loops)}) {
    for (SlamLoop l : *from) {
      l.older += keyframes;
      l.newer += keyframes;
      to->push_back(l);
    }
  }
  for (SlamMatch m : s.matches) {
    m.newer += observations;
    m.older += observations;
    m.keyframe_newer += keyframes;
    m.keyframe_older += keyframes;
    all->matches.push_back(m);
  }
  for (const std::int32_t k : s.keyframe_of_observation) {
    all->keyframe_of_observation.push_back(k + keyframes);
  }
  if (!s.settled.cells.empty()) {
    const double cell =
        all->settled.cells.empty() ? s.settled.cell : std::min(all->settled.cell, s.settled.cell);
    all->settled = withCells(all->settled, cell);
    for (SettledCell c : withCells(s.settled, cell).cells) {
      c.keyframe += keyframes;
      c.run = run_after[std::min<std::size_t>(c.run, run_after.size() - 1)];
      all->settled.cells.push_back(c);
    }
  }
  appendObservations(s.corpus.observations, &all->corpus.observations);
  if (observations == 0) all->corpus.classes = s.corpus.classes;
  addCounters(s.counters, &all->counters);
}

constexpr int kLeftOut = -1;

/// New numbers of what stays, in order; kLeftOut for the rest.
template <typename Stays>
std::vector<int> numbersOf(std::size_t size, const Stays& stays) {
  std::vector<int> numbers(size, kLeftOut);
  int next = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (stays(i)) numbers[i] = next++;
  }
  return numbers;
}

std::vector<SlamLoop> loopsOf(const std::vector<SlamLoop>& loops,
                              const std::vector<int>& keyframes) {
  std::vector<SlamLoop> out;
  for (SlamLoop l : loops) {
    l.older = keyframes[static_cast<std::size_t>(l.older)];
    l.newer = keyframes[static_cast<std::size_t>(l.newer)];
    if (l.older != kLeftOut && l.newer != kLeftOut) out.push_back(l);
  }
  return out;
}

/// The keyframes that stay; each run goes on where the one before it ended.
std::vector<SlamKeyframe> keyframesOf(const SlamState& state, const std::vector<bool>& runs) {
  const std::vector<int> run_numbers =
      numbersOf(runs.size(), [&](std::size_t r) -> bool { return runs[r]; });
  std::vector<SlamKeyframe> out;
  double shift = 0.0;
  std::uint32_t run = 0;
  for (const SlamKeyframe& k : state.keyframes) {
    if (!runs[k.run]) continue;
    if (out.empty() || k.run != run) {
      shift = (out.empty() ? 0.0 : out.back().path_length) - k.path_length;
      run = k.run;
    }
    out.push_back(k);
    out.back().path_length += shift;
    out.back().run = static_cast<std::uint32_t>(run_numbers[k.run]);
  }
  return out;
}

/// Observations, and matches between them.
void takeWords(const SlamState& state, const std::vector<int>& keyframes, SlamState* part) {
  const ObservationStore& all = state.corpus.observations;
  const auto keyframeOf = [&](std::size_t observation) {
    return keyframes[static_cast<std::size_t>(state.keyframe_of_observation[observation])];
  };
  const std::vector<int> observations =
      numbersOf(all.size(), [&](std::size_t i) { return keyframeOf(i) != kLeftOut; });
  for (std::uint32_t run = 0; run < all.runs(); ++run) {
    bool begun = false;
    for (std::uint32_t i = all.runBegin(run); i < all.runEnd(run); ++i) {
      if (observations[i] == kLeftOut) continue;
      if (!begun) part->corpus.observations.startRun();
      begun = true;
      part->corpus.observations.append(all[i]);
      part->keyframe_of_observation.push_back(keyframeOf(i));
    }
  }
  part->corpus.classes = state.corpus.classes;
  for (SlamMatch m : state.matches) {
    const int newer = observations[m.newer], older = observations[m.older];
    m.keyframe_newer = keyframes[static_cast<std::size_t>(m.keyframe_newer)];
    m.keyframe_older = keyframes[static_cast<std::size_t>(m.keyframe_older)];
    if (newer == kLeftOut || older == kLeftOut || m.keyframe_newer == kLeftOut ||
        m.keyframe_older == kLeftOut) {
      continue;
    }
    m.newer = static_cast<std::uint32_t>(newer);
    m.older = static_cast<std::uint32_t>(older);
    part->matches.push_back(m);
  }
}

}  // namespace

std::uint32_t runsOf(const SlamState& state) {
  return state.keyframes.empty() ? 0 : state.keyframes.back().run + 1;
}

std::vector<std::uint64_t> scanNumbers(const SlamState& state) {
  std::vector<std::uint64_t> out;
  for (const SlamKeyframe& k : state.keyframes) {
    std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
    const auto add = [&](const void* data, std::size_t size) {
      const auto* bytes = static_cast<const unsigned char*>(data);
      for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 1099511628211ULL;
    };
    add(&k.stamp, sizeof k.stamp);
    add(k.scan->ranges.data(), k.scan->ranges.size() * sizeof(float));
    out.push_back(hash);
  }
  return out;
}

SlamState joinedStates(const std::vector<SlamState>& states) {
  SlamState all;
  for (const SlamState& s : states) {
    s.validate();
    append(s, &all);
  }
  return all;
}

SlamState partOfState(const SlamState& state, const std::vector<bool>& runs) {
  state.validate();
  std::vector<bool> taken = runs;
  taken.resize(runsOf(state), false);
  const std::vector<int> keyframes = numbersOf(
      state.keyframes.size(), [&](std::size_t k) -> bool { return taken[state.keyframes[k].run]; });
  SlamState part;
  part.keyframes = keyframesOf(state, taken);
  for (PlacedScan p : state.scans) {
    p.keyframe = keyframes[static_cast<std::size_t>(p.keyframe)];
    if (p.keyframe != kLeftOut) part.scans.push_back(p);
  }
  for (hyselam_pose_graph::PoseEdge e : state.odometry) {
    e.from = keyframes[static_cast<std::size_t>(e.from)];
    e.to = keyframes[static_cast<std::size_t>(e.to)];
    if (e.from != kLeftOut && e.to != kLeftOut) part.odometry.push_back(e);
  }
  part.loops = loopsOf(state.loops, keyframes);
  part.pending_loops = loopsOf(state.pending_loops, keyframes);
  part.settled.cell = state.settled.cell;
  for (SettledCell c : state.settled.cells) {
    c.keyframe = keyframes[static_cast<std::size_t>(c.keyframe)];
    if (c.keyframe == kLeftOut) continue;
    // The runs of the part up to that one.
    const auto end = taken.begin() +
                     std::min<std::ptrdiff_t>(c.run + 1, static_cast<std::ptrdiff_t>(taken.size()));
    const auto before = std::count(taken.begin(), end, true);
    c.run = static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(before - 1, 0));
    part.settled.cells.push_back(c);
  }
  takeWords(state, keyframes, &part);
  part.counters.scans = part.scans.size();
  return part;
}

}  // namespace ngram_slam
