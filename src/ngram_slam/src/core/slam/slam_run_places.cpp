// Where a run lies in the maps of earlier ones: it is searched for, placed, doubted.
#include <algorithm>
#include <cmath>
#include <map>

#include "ngram_slam/slam/far_loops.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;

namespace {

constexpr double kOtherView = hyselam::kPi / 2.0;  // a laser may see only what is ahead

double sumOfInliers(const std::vector<SlamLoop>& loops) {
  double sum = 0.0;
  for (const SlamLoop& l : loops) sum += l.inlier_ratio;
  return sum;
}

}  // namespace

const char* toString(RunPlace place) {
  switch (place) {
    case RunPlace::kFirst:
      return "first";
    case RunPlace::kSupposed:
      return "supposed";
    case RunPlace::kTied:
      return "tied";
    case RunPlace::kOwnMap:
      return "own map";
  }
  return "";
}

bool SlamEngine::isUntied() const {
  return first_of_run_ > 0 && first_of_run_ <= lastKeyframe() &&
         connections_.mapOf(currentRun()) == currentRun();
}

RunPlace SlamEngine::runPlace() const {
  if (state_.keyframes.empty() || currentRun() == 0) return RunPlace::kFirst;
  if (!isUntied()) return RunPlace::kTied;
  return pathOfRun() < params_.run_start.own_map_path ? RunPlace::kSupposed : RunPlace::kOwnMap;
}

bool SlamEngine::knowsChanges() const {
  if (session_ == 0) return true;
  // A run may be tied to another one since the start, and both be apart from the stored map.
  return currentRun() >= session_ && runPlace() == RunPlace::kTied &&
         connections_.mapOf(currentRun()) < session_;
}

std::optional<double> SlamEngine::pathUntilTied() const {
  return run_.tied ? std::make_optional(*run_.tied - run_.begin) : std::nullopt;
}

std::vector<bool> SlamEngine::shownRuns() const {
  if (state_.keyframes.empty()) return {};
  const std::uint32_t map =
      runPlace() == RunPlace::kSupposed ? run_.supposed_in : connections_.mapOf(currentRun());
  std::vector<bool> shown;
  for (std::uint32_t run = 0; run <= currentRun(); ++run) {
    shown.push_back(connections_.mapOf(run) == map);
  }
  return shown;
}

/// The map of most keyframes, the earliest of equal ones, without that of a run.
std::uint32_t SlamEngine::largestMapBut(std::uint32_t run) const {
  std::map<std::uint32_t, int> keyframes;
  for (const SlamKeyframe& k : state_.keyframes) ++keyframes[connections_.mapOf(k.run)];
  keyframes.erase(connections_.mapOf(run));
  const auto largest =
      std::max_element(keyframes.begin(), keyframes.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return largest == keyframes.end() ? 0 : largest->first;
}

/// Keyframes of other maps than that of `keyframe` that stand for what is around them, nearest to
/// it by their supposed poses first.
std::vector<int> SlamEngine::placesOfOtherMaps(int k) const {
  std::vector<int> places;
  const SlamKeyframe& here = keyframe(k);
  for (int other = 0; other < first_of_run_; ++other) {
    const SlamKeyframe& there = keyframe(other);
    if (connections_.connected(there.run, here.run)) continue;
    const bool stood_for = std::any_of(places.begin(), places.end(), [&](int place) {
      const SlamKeyframe& p = keyframe(place);
      return connections_.connected(p.run, there.run) &&
             distance(p.pose, there.pose) < params_.run_start.place_spacing &&
             std::abs(hyselam::normalizeAngle(p.pose.theta - there.pose.theta)) < kOtherView;
    });
    if (!stood_for) places.push_back(other);
  }
  std::stable_sort(places.begin(), places.end(), [&](int a, int b) {
    return distance(keyframe(a).pose, here.pose) < distance(keyframe(b).pose, here.pose);
  });
  return places;
}

/// While the run is not tied: asks the scans, around where it is supposed to be, now and then in
/// the whole of the other maps.
void SlamEngine::searchOtherMaps() {
  const RunStartParams& p = params_.run_start;
  if (!isUntied() || runPlace() == RunPlace::kOwnMap) return;
  const bool whole_map = path_length_ - run_.searched_map >= p.whole_map_interval;
  const bool around = !run_.anywhere && path_length_ - run_.searched >= p.search_interval;
  if (!whole_map && !around) return;
  run_.searched = path_length_;
  if (whole_map) run_.searched_map = path_length_;
  const int middle = middleOfNewSegment();
  for (const int place : placesOfOtherMaps(middle)) {
    if (!whole_map && distance(keyframe(place).pose, keyframe(middle).pose) > p.search_radius) {
      break;
    }
    requestVerification({place, middle, true, LoopSource::kProximity, Pose2{},
                         params_.loop.signature_search_window, params_.loop.signature_search_angle,
                         kNoMatch, true});
  }
}

/// While the run is not tied: asks where in the other maps its last metres fit best.
void SlamEngine::askForPlace() {
  const RunStartParams& p = params_.run_start;
  if (!isUntied()) return;
  if (runPlace() == RunPlace::kOwnMap) {
    forgetPlaces();
    return;
  }
  if (p.place_interval <= 0.0 || path_length_ - run_.drawn < p.place_interval) return;
  run_.drawn = path_length_;
  if (!run_.other_maps) {
    run_.other_maps = std::make_shared<KnownMaps>(state_, first_of_run_, connections_, currentRun(),
                                                  params_.consolidation);
  }
  PlaceQuestion question;
  question.keyframe = lastKeyframe();
  question.middle = middleOfNewSegment();
  question.maps = run_.other_maps;
  question.scans = lastMetres(state_.keyframes, lastKeyframe());
  place_question_ = std::move(question);
}

/// Where the run lies is known, or no longer asked: the drawn maps are large.
void SlamEngine::forgetPlaces() {
  run_.other_maps.reset();
  run_.placed.clear();
  place_question_.reset();
}

/// A place that is likelier than one with an equal beside it is looked at by the scans themselves.
void SlamEngine::applyPlace(const PlaceAnswer& answer) {
  if (!isUntied() || answer.middle < first_of_run_ || !answer.place ||
      answer.place->probability <= params_.run_start.min_place_probability) {
    return;
  }
  LoopGuess guess{answer.place->keyframe,
                  answer.middle,
                  true,
                  LoopSource::kProximity,
                  answer.place->base_in_keyframe *
                      between(keyframe(answer.keyframe).pose, keyframe(answer.middle).pose),
                  kPlaceWindow,
                  kPlaceAngle,
                  kNoMatch};
  guess.place_probability = answer.place->probability;
  requestVerification(guess);
}

/// A loop at the place of the other maps that explains the last metres best. It ties the run if
/// that no other place does and what the scans say of this one together leave no doubt, and if
/// another loop along the run says the same: one found otherwise, or at another place as sure.
void SlamEngine::addPlacedLoop(const SlamLoop& loop, double place_probability) {
  if (loop.newer < first_of_run_) return;
  if (!isUntied()) {  // tied while it was verified
    addFarLoop(loop);
    return;
  }
  const LoopParams& p = params_.loop;
  std::vector<SlamLoop> all_others = state_.pending_loops;  // may contradict it
  std::vector<SlamLoop> others = state_.pending_loops;      // may be the second loop of a tie
  for (const PlacedLoop& placed : run_.placed) {
    all_others.push_back(placed.loop);
    if (placed.place_probability >= params_.run_start.sure_place_probability) {
      others.push_back(placed.loop);
    }
  }
  run_.placed.push_back({loop, place_probability});
  if (!isSurePlace(run_.placed.back(), all_others, state_.pending_loops, state_.keyframes,
                   connections_, params_)) {
    return;
  }
  for (const std::size_t i : consistentLoops(loop, others, state_.keyframes, connections_, p)) {
    const SlamLoop other = others[i];
    if (std::abs(keyframe(loop.newer).path_length - keyframe(other.newer).path_length) <
        params_.run_start.place_min_span) {
      continue;
    }
    std::vector<SlamLoop>& waiting = state_.pending_loops;
    waiting.erase(std::remove_if(waiting.begin(), waiting.end(),
                                 [&](const SlamLoop& l) { return isSamePair(l, other); }),
                  waiting.end());
    acceptFarLoop(loop);
    acceptFarLoop(other);
    return;
  }
}

/// Moves the later one of two maps to where a loop between them says that it lies.
void SlamEngine::placeRun(const SlamLoop& tie) {
  const SlamKeyframe &older = keyframe(tie.older), &newer = keyframe(tie.newer);
  const std::uint32_t a = connections_.mapOf(older.run), b = connections_.mapOf(newer.run);
  if (a == b) return;
  Pose2 correction = older.pose * tie.measured * newer.pose.inverse();
  if (b < a) correction = correction.inverse();
  const std::uint32_t moved = std::max(a, b);
  for (SlamKeyframe& k : state_.keyframes) {
    if (connections_.mapOf(k.run) == moved) k.pose = correction * k.pose;
  }
  if (connections_.mapOf(currentRun()) == moved) {
    pose_ = correction * pose_;
    matched_pose_ = correction * matched_pose_;
    run_.tied = path_length_;
    forgetPlaces();
  }
  connections_.connect(a, b);
  run_.other_maps.reset();
  rebuildLocalMap();
  ++revision_;
}

/// Whether the run was tied by far loops not long ago.
bool SlamEngine::mayBeDoubted() const {
  return run_.tied && !run_.known && path_length_ - *run_.tied <= params_.run_start.own_map_path;
}

/// A far loop between the run and others that its ties exclude. Loops that agree with each other
/// and weigh more than the ties take their place.
void SlamEngine::doubtTies(const SlamLoop& loop) {
  const std::uint32_t run = currentRun();
  if (keyframe(loop.newer).run != run || keyframe(loop.older).run == run || !mayBeDoubted()) {
    return;
  }
  const std::vector<SlamLoop> others = loopsWithinRuns(state_.loops, state_.keyframes, run);
  const RunConnections untied(state_.keyframes, others);
  std::vector<SlamLoop> waiting = doubts_;
  doubts_.push_back(loop);
  const std::vector<SlamLoop> group =
      believeFarLoops(loop, {}, state_.keyframes, untied, params_.loop, &waiting);
  std::vector<SlamLoop> ties;
  for (const SlamLoop& l : usedFarLoops()) {
    if ((keyframe(l.older).run == run) != (keyframe(l.newer).run == run)) ties.push_back(l);
  }
  if (group.empty() || sumOfInliers(group) <= sumOfInliers(ties)) return;
  state_.loops = others;
  ++ties_withdrawn_;
  doubts_.clear();
  refreshConnections();
  rebuildPathLengths();
  for (const SlamLoop& l : group) acceptFarLoop(l);
}

/// The map of each run.
std::vector<std::uint32_t> SlamEngine::mapsOfRuns() const {
  std::vector<std::uint32_t> maps;
  for (std::uint32_t run = 0; run <= currentRun(); ++run) maps.push_back(connections_.mapOf(run));
  return maps;
}

/// After loops lost their weight or were taken away.
void SlamEngine::refreshConnections() {
  const std::vector<std::uint32_t> before = mapsOfRuns();
  connections_ = RunConnections(state_.keyframes, state_.loops);
  if (mapsOfRuns() != before) run_.other_maps.reset();  // one fell apart, or two are one
  if (isUntied()) {
    run_.tied.reset();
    run_.searched = run_.searched_map = run_.drawn = path_length_;
    run_.placed.clear();
  }
}

}  // namespace ngram_slam
