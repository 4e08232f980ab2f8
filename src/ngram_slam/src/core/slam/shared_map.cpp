#include "ngram_slam/slam/shared_map.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "ngram_slam/slam/run_connections.hpp"
#include "ngram_slam/slam/state_parts.hpp"

namespace ngram_slam {

using hyselam::Pose2;

namespace {

/// Of each keyframe, its run counted without gaps.
std::vector<std::uint32_t> runsWithoutGaps(const std::vector<SlamKeyframe>& keyframes) {
  std::vector<std::uint32_t> runs;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const std::uint32_t last = runs.empty() ? 0 : runs.back();
    runs.push_back(k > 0 && keyframes[k].run != keyframes[k - 1].run ? last + 1 : last);
  }
  return runs;
}

/// Whether two maps of one robot hold the same scans, more or less.
bool holdSameRecording(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b,
                       double max_shared) {
  const std::set<std::uint64_t> scans(a.begin(), a.end());
  std::size_t shared = 0;
  for (const std::uint64_t scan : b) shared += scans.count(scan);
  return static_cast<double>(shared) >
         max_shared * static_cast<double>(std::min(a.size(), b.size()));
}

}  // namespace

void SharedMapParams::describe(hyselam::ParameterVisitor& visit) {
  visit.group("merging/", merging);
  visit("max_former_maps", max_former_maps, hyselam::Range::between(0, 1000), "",
        "that are kept of robots which began another one");
}

void SharedMapParams::validate() const {
  hyselam::checkParameters(*this);
  merging.validate();
}

SharedMap::SharedMap(std::vector<std::string> robots, const SharedMapParams& params)
    : names_(std::move(robots)), params_(params) {
  params_.validate();
  // Keyframes keep the numbers that they have in the robots.
  params_.merging.slam.consolidation.enabled = false;
  told_.assign(names_.size(), ToldGraph(params_.merging.slam.surface));
}

SharedMap::Session* SharedMap::find(const Key& key) {
  const auto found = std::find_if(sessions_.begin(), sessions_.end(),
                                  [&](const Session& s) { return s.key == key; });
  return found == sessions_.end() ? nullptr : &*found;
}

const SharedMap::Session* SharedMap::presentOf(std::size_t robot) const {
  const auto found = std::find_if(sessions_.begin(), sessions_.end(), [&](const Session& s) {
    return s.present && s.key.robot == robot;
  });
  return found == sessions_.end() ? nullptr : &*found;
}

bool SharedMap::Session::isPlaced() const {
  return std::any_of(placed.begin(), placed.end(), [](const auto& p) { return bool(p); });
}

bool SharedMap::isAnyPlacedBut(const Session* one) const {
  return std::any_of(sessions_.begin(), sessions_.end(),
                     [&](const Session& s) { return &s != one && s.isPlaced(); });
}

/// As its robot has it: the map of its newest run. What was placed first stays where it was.
void SharedMap::placeAlone(Session* session) {
  const std::vector<SlamKeyframe>& all = session->state.keyframes;
  Pose2 correction;
  for (std::size_t k = 0; k < std::min(session->placed.size(), all.size()); ++k) {
    if (!session->placed[k]) continue;
    correction = *session->placed[k] * all[k].pose.inverse();
    break;
  }
  const RunConnections connections(all, session->state.loops);
  session->placed.assign(all.size(), std::nullopt);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (connections.connected(all[k].run, all.back().run)) {
      session->placed[k] = correction * all[k].pose;
    }
  }
}

bool SharedMap::add(std::size_t robot, GraphPart part) {
  if (!told_[robot].add(std::move(part), names_[robot])) return false;
  update(robot);
  return true;
}

/// After a robot's graph was told.
void SharedMap::update(std::size_t robot) {
  const Key key{robot, told_[robot].map()};
  const SlamState& state = told_[robot].state();
  for (Session& s : sessions_) {
    if (s.key.robot == robot) s.present = s.key == key;
  }
  if (state.keyframes.empty()) return;
  changed_ = true;
  Session* session = find(key);
  if (session == nullptr) {
    // A map that goes on with a former one takes its place.
    Session added{key, true, state, {}};
    const std::vector<std::uint64_t> scans = scanNumbers(state);
    const auto is_replaced = [&](const Session& s) {
      return s.key.robot == robot &&
             holdSameRecording(scanNumbers(s.state), scans, params_.merging.max_shared_keyframes);
    };
    std::map<std::uint64_t, Pose2> places;  // by scan
    for (const Session& s : sessions_) {
      if (!is_replaced(s)) continue;
      const std::vector<std::uint64_t> known = scanNumbers(s.state);
      for (std::size_t k = 0; k < std::min(known.size(), s.placed.size()); ++k) {
        if (s.placed[k]) places.emplace(known[k], *s.placed[k]);
      }
      if (anchor_ && *anchor_ == s.key) anchor_ = key;
    }
    for (std::size_t k = 0; k < state.keyframes.size(); ++k) {
      const auto place = places.find(scans[k]);
      if (place == places.end()) continue;
      added.placed.resize(k + 1);
      added.placed[k] = place->second;
    }
    sessions_.erase(std::remove_if(sessions_.begin(), sessions_.end(), is_replaced),
                    sessions_.end());
    sessions_.push_back(std::move(added));
    std::stable_sort(sessions_.begin(), sessions_.end(), [](const Session& a, const Session& b) {
      if (a.present != b.present) return a.present;
      return a.present && a.key.robot < b.key.robot;
    });
    giveUpFormerMaps();
  } else {
    session->state = state;
  }
  session = find(key);
  if (!isAnyPlacedBut(nullptr)) {
    placeAlone(&sessions_.front());
    anchor_ = sessions_.front().key;
  } else if (session != nullptr && session->isPlaced() && !isAnyPlacedBut(session)) {
    placeAlone(session);
  }
}

/// Of too many that one of fewest keyframes which lies nowhere, if there is one.
void SharedMap::giveUpFormerMaps() {
  const auto former = [](const Session& s) { return !s.present; };
  while (std::count_if(sessions_.begin(), sessions_.end(), former) > params_.max_former_maps) {
    const auto least =
        std::min_element(sessions_.begin(), sessions_.end(), [&](const auto& a, const auto& b) {
          return std::make_tuple(a.present, a.isPlaced(), a.state.keyframes.size()) <
                 std::make_tuple(b.present, b.isPlaced(), b.state.keyframes.size());
        });
    sessions_.erase(least);
    ++given_up_;
  }
}

std::optional<SharedMap::Work> SharedMap::takeWork() {
  if (!changed_ || sessions_.size() < 2) return std::nullopt;
  changed_ = false;
  Work work;
  for (const Session& s : sessions_) {
    work.keys.push_back(s.key);
    work.sessions.push_back({names_[s.key.robot] + (s.present ? "" : ", before"), s.state});
    work.runs.push_back(runsWithoutGaps(s.state.keyframes));
  }
  return work;
}

MergedMaps SharedMap::merge(Work* work, const MapMergingParams& params,
                            const MergingProgress& progress) {
  return mergeMaps(std::move(work->sessions), params, progress);
}

namespace {

std::vector<std::pair<std::size_t, std::size_t>> keyframesOf(const MergedMap& map,
                                                             const SharedMap::Work& work) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (const MergedPart& part : map.parts) {
    const std::vector<std::uint32_t>& runs = work.runs[part.session];
    for (std::size_t k = 0; k < runs.size(); ++k) {
      if (std::find(part.session_runs.begin(), part.session_runs.end(), runs[k]) !=
          part.session_runs.end()) {
        out.emplace_back(part.session, k);
      }
    }
  }
  return out;
}

}  // namespace

/// How a merged map moves into the frame of the shared one: the anchor stays where it was, or else
/// the first session that was there.
Pose2 SharedMap::correctionOf(const MergedMap& map, const Keyframes& keyframes, const Work& work) {
  std::optional<Pose2> first;
  Key key;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const auto [s, k] = keyframes[i];
    const Session* session = find(work.keys[s]);
    if (session == nullptr || k >= session->placed.size() || !session->placed[k]) continue;
    const Pose2 correction = *session->placed[k] * map.state.keyframes[i].pose.inverse();
    if (anchor_ && *anchor_ == session->key) return correction;
    if (!first) {
      first = correction;
      key = session->key;
    }
  }
  anchor_ = first ? key : work.keys[keyframes.front().first];
  return first.value_or(Pose2{});
}

void SharedMap::apply(const Work& work, const MergedMaps& merged) {
  ++merges_;
  remarks_ = merged.left_out;
  remarks_.insert(remarks_.end(), merged.doubtful.begin(), merged.doubtful.end());
  // The map in which most robots are now; among equals that which it was: nobody's frame jumps.
  const MergedMap* shared = nullptr;
  std::set<std::size_t> best;
  bool is_anchored = false;
  for (const MergedMap& map : merged.maps) {
    std::set<std::size_t> robots;
    for (const MergedPart& part : map.parts) {
      const Session* session = find(work.keys[part.session]);
      if (session == nullptr || !session->present || part.session_runs.empty()) continue;
      if (part.session_runs.back() == work.runs[part.session].back()) {
        robots.insert(session->key.robot);
      }
    }
    if (robots.empty()) continue;
    const bool anchored =
        std::any_of(map.parts.begin(), map.parts.end(), [&](const MergedPart& part) {
          return anchor_ && work.keys[part.session] == *anchor_ && !part.session_runs.empty();
        });
    const auto rank = [](const std::set<std::size_t>& in, bool anchors) {
      return std::make_tuple(in.size(), anchors);
    };
    const bool better = rank(robots, anchored) > rank(best, is_anchored) ||
                        (rank(robots, anchored) == rank(best, is_anchored) && robots < best);
    if (better) {
      shared = &map;
      best = robots;
      is_anchored = anchored;
    }
  }
  if (shared == nullptr) return;

  const auto keyframes = keyframesOf(*shared, work);
  std::map<std::size_t, std::vector<std::optional<Pose2>>> placed;  // by session
  for (std::size_t s = 0; s < work.keys.size(); ++s) placed[s].resize(work.runs[s].size());
  const Pose2 correction = correctionOf(*shared, keyframes, work);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const auto [s, k] = keyframes[i];
    placed[s][k] = correction * shared->state.keyframes[i].pose;
  }
  for (auto& [s, poses] : placed) {
    if (Session* session = find(work.keys[s])) session->placed = std::move(poses);
  }
  ties_.clear();
  for (const SlamLoop& l : shared->state.loops) {
    const auto& older = keyframes[static_cast<std::size_t>(l.older)];
    const auto& newer = keyframes[static_cast<std::size_t>(l.newer)];
    if (older.first == newer.first || !isUsed(l)) continue;
    ties_.push_back({work.keys[older.first], work.keys[newer.first], l});
    ties_.back().loop.older = static_cast<int>(older.second);
    ties_.back().loop.newer = static_cast<int>(newer.second);
  }
}

/// From a session's own frame to the shared one, by run; nothing for what is not in it.
SharedMap::Corrections SharedMap::correctionsOf(const Session& session) {
  const std::vector<SlamKeyframe>& all = session.state.keyframes;
  const std::uint32_t runs = runsOf(session.state);
  Corrections corrections(runs);
  std::vector<bool> judged(runs, false);  // when it was merged
  for (std::size_t k = 0; k < std::min(session.placed.size(), all.size()); ++k) {
    judged[all[k].run] = true;
    if (session.placed[k]) corrections[all[k].run] = *session.placed[k] * all[k].pose.inverse();
  }
  const RunConnections connections(all, session.state.loops);
  std::map<std::uint32_t, Pose2> of_map;  // of its last run that was
  for (std::uint32_t run = 0; run < runs; ++run) {
    if (corrections[run]) of_map[connections.mapOf(run)] = *corrections[run];
  }
  for (std::uint32_t run = 0; run < runs; ++run) {
    const auto found = of_map.find(connections.mapOf(run));
    if (!judged[run] && found != of_map.end()) corrections[run] = found->second;
  }
  return corrections;
}

/// Those that ended first come first: what was seen last is drawn over it.
std::vector<std::size_t> SharedMap::sessionsByTime() const {
  std::vector<std::size_t> order(sessions_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return sessions_[a].state.keyframes.back().stamp < sessions_[b].state.keyframes.back().stamp;
  });
  return order;
}

/// Nothing for a keyframe that is not there any more.
std::optional<std::size_t> SharedMap::sessionOf(const Key& key, int keyframe) const {
  for (std::size_t s = 0; s < sessions_.size(); ++s) {
    if (sessions_[s].key != key) continue;
    if (static_cast<std::size_t>(keyframe) < sessions_[s].state.keyframes.size()) return s;
  }
  return std::nullopt;
}

SharedMapState SharedMap::state() const {
  SharedMapState out;
  std::vector<SlamState> states;
  std::vector<bool> taken;                                      // runs
  std::vector<std::vector<int>> all_numbers(sessions_.size());  // of keyframes, in the result
  int next = 0;
  for (const std::size_t index : sessionsByTime()) {
    const Session& s = sessions_[index];
    std::vector<int>& numbers = all_numbers[index];
    SlamState state = s.state;
    const Corrections corrections = correctionsOf(s);
    const std::vector<std::uint32_t> runs = runsWithoutGaps(state.keyframes);
    numbers.assign(state.keyframes.size(), -1);
    for (std::size_t k = 0; k < state.keyframes.size(); ++k) {
      SlamKeyframe& here = state.keyframes[k];
      const auto& correction = corrections[here.run];
      if (k == 0 || runs[k] != runs[k - 1]) {
        taken.push_back(correction.has_value());
        if (correction) out.robot_of_run.push_back(s.key.robot);
      }
      if (!correction) continue;
      here.pose = k < s.placed.size() && s.placed[k] ? *s.placed[k] : *correction * here.pose;
      numbers[k] = next++;
    }
    states.push_back(std::move(state));
  }
  out.state = partOfState(joinedStates(states), taken);
  const auto numberOf = [&](const Key& key, int k) {
    const auto session = sessionOf(key, k);
    return session ? all_numbers[*session][static_cast<std::size_t>(k)] : -1;
  };
  for (const Tie& tie : ties_) {
    SlamLoop loop = tie.loop;
    loop.older = numberOf(tie.older, tie.loop.older);
    loop.newer = numberOf(tie.newer, tie.loop.newer);
    if (loop.older >= 0 && loop.newer >= 0) out.state.loops.push_back(loop);
  }
  return out;
}

std::vector<RobotInSharedMap> SharedMap::robots() const {
  std::vector<RobotInSharedMap> out(names_.size());
  for (const Session& s : sessions_) out[s.key.robot].keyframes += s.state.keyframes.size();
  for (std::size_t robot = 0; robot < names_.size(); ++robot) {
    const Session* session = presentOf(robot);
    if (session == nullptr) continue;
    out[robot].map_in_shared = correctionsOf(*session)[session->state.keyframes.back().run];
  }
  for (const Tie& t : ties_) {
    if (t.older.robot == t.newer.robot || !sessionOf(t.older, t.loop.older) ||
        !sessionOf(t.newer, t.loop.newer)) {
      continue;
    }
    ++out[t.older.robot].ties;
    ++out[t.newer.robot].ties;
  }
  return out;
}

}  // namespace ngram_slam
