// Loops of the engine: where to look for them, and what verified ones become.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "ngram_slam/slam/far_loops.hpp"
#include "ngram_slam/slam/loop_tasks.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;

namespace {

/// The thesis' edge of a match of words: the same pose, with fixed information (5.2.4).
Eigen::Matrix3d thesisInformation(const LoopParams& p) {
  const double position = 1.0 / (p.thesis_position_stddev * p.thesis_position_stddev);
  const double heading = 1.0 / (p.thesis_heading_stddev * p.thesis_heading_stddev);
  return Eigen::Vector3d(position, position, heading).asDiagonal();
}

}  // namespace

void SlamEngine::rebuildPathLengths() {
  path_lengths_.clear();
  for (const auto& e : state_.odometry) {
    path_lengths_.addEdge(e.from, e.to, std::hypot(e.measured.x, e.measured.y));
  }
  for (const SlamLoop& l : state_.loops) {
    if (isUsed(l)) {
      path_lengths_.addEdge(l.older, l.newer, params_.loop.loop_path_length);
    }
  }
}

// ---- by the poses

void SlamEngine::searchLoopClosures() {
  if (params_.loops == LoopClosureMode::kNone || params_.loops == LoopClosureMode::kThesis) return;
  const LoopParams& p = params_.loop;
  searchOtherMaps();
  askForPlace();
  if (lastKeyframe() % p.near_search_interval == 0) searchNearLoops();
  // Far ones by words only, or by signatures only.
  if (params_.loops == LoopClosureMode::kNgrams || params_.loops == LoopClosureMode::kSignatures) {
    return;
  }
  if (path_length_ - far_search_path_length_ >= p.far_search_interval) searchFarLoops();
}

std::vector<double> SlamEngine::pathLengthsInReach(int k) const {
  return path_lengths_.from(k, keyframesInReach(state_.keyframes, k, params_.loop));
}

void SlamEngine::searchNearLoops() {
  const LoopParams& p = params_.loop;
  const int newest = lastKeyframe();
  int requested = 0;
  for (const LoopCandidate& c :
       loopCandidates(state_.keyframes, newest, pathLengthsInReach(newest), p)) {
    if (c.position_uncertainty > p.near_max_uncertainty) continue;
    if (requested++ == p.near_max_candidates) break;
    requestVerification({c.older, newest, false, LoopSource::kProximity,
                         between(keyframe(c.older).pose, keyframe(newest).pose),
                         c.position_uncertainty, p.near_search_angle, kNoMatch});
  }
}

/// Of the path driven last.
int SlamEngine::middleOfNewSegment() const {
  int middle = lastKeyframe();
  const double half = std::min(params_.loop.far_new_segment_half_length, 0.5 * pathOfRun());
  while (middle > first_of_run_ && path_length_ - keyframe(middle).path_length < half) {
    --middle;
  }
  return middle;
}

void SlamEngine::searchFarLoops() {
  const LoopParams& p = params_.loop;
  far_search_path_length_ = path_length_;
  const int middle = middleOfNewSegment();
  int requested = 0;
  for (const LoopCandidate& c :
       loopCandidates(state_.keyframes, middle, pathLengthsInReach(middle), p)) {
    if (c.position_uncertainty <= p.near_max_uncertainty) continue;
    if (requested++ == p.far_max_candidates) break;
    requestVerification({c.older, middle, true, LoopSource::kProximity,
                         between(keyframe(c.older).pose, keyframe(middle).pose),
                         c.position_uncertainty, c.heading_uncertainty, kNoMatch});
  }
}

// ---- by words

void SlamEngine::addWordMatches(WordPlaces::Update update) {
  for (const double stamp : update.stamps) {
    state_.keyframe_of_observation.push_back(keyframeAt(stamp));
  }
  if (update.requantized) {
    state_.matches.clear();
    for (LoopTask& t : tasks_) t.match = kNoMatch;
  }
  // The most probable first: few loops are tried for each word.
  std::stable_sort(update.matches.begin(), update.matches.end(),
                   [](const SlamMatch& a, const SlamMatch& b) {
                     return a.newer != b.newer ? a.newer < b.newer : a.probability > b.probability;
                   });
  WordSearch search;
  for (SlamMatch& m : update.matches) {
    m.keyframe_newer = state_.keyframe_of_observation[m.newer];
    m.keyframe_older = state_.keyframe_of_observation[m.older];
    m.measured = {0.0, 0.0, m.direction == Direction::kReverse ? hyselam::kPi : 0.0};
    state_.matches.push_back(m);
    if (m.keyframe_newer <= m.keyframe_older) continue;
    if (params_.loops == LoopClosureMode::kThesis) {
      addUnverifiedLoop(&state_.matches.back());
    } else {
      searchWordLoop(static_cast<std::int64_t>(state_.matches.size()) - 1, &search);
    }
  }
}

void SlamEngine::addUnverifiedLoop(SlamMatch* match) {
  SlamLoop loop;
  loop.older = match->keyframe_older;
  loop.newer = match->keyframe_newer;
  loop.measured = match->measured;
  loop.source = LoopSource::kNgram;
  loop.information = thesisInformation(params_.loop);
  match->accepted = true;
  ++state_.counters.words.accepted;
  addLoopEdge(loop);
}

/// Requests the verification of a match, as a near loop where the graph knows the pose well.
void SlamEngine::searchWordLoop(std::int64_t index, WordSearch* search) {
  const LoopParams& p = params_.loop;
  SlamMatch& match = state_.matches[static_cast<std::size_t>(index)];
  const SlamKeyframe& newer = keyframe(match.keyframe_newer);
  const SlamKeyframe& older = keyframe(match.keyframe_older);
  if (newer.run == older.run && newer.path_length - older.path_length < p.min_path_length) return;
  if (match.keyframe_newer != search->newer) {
    search->newer = match.keyframe_newer;
    search->path_lengths = path_lengths_.from(search->newer);
    search->requested.clear();
  }
  const double uncertainty =
      p.positionUncertainty(search->path_lengths[static_cast<std::size_t>(match.keyframe_older)]);
  if (uncertainty <= p.near_max_uncertainty) {
    // The graph knows the pose better than words; the scans say whether these were right.
    const Pose2 known = between(older.pose, newer.pose);
    if (std::hypot(known.x, known.y) > p.word_search_window) {
      match.tried = true;  // words are wrong
      return;
    }
    requestVerification({match.keyframe_older, match.keyframe_newer, false, LoopSource::kNgram,
                         known, uncertainty, p.near_search_angle, index});
    return;
  }
  std::vector<double>& requested = search->requested;
  const bool repeated = std::any_of(requested.begin(), requested.end(), [&](double length) {
    return std::abs(length - older.path_length) < p.word_candidate_spacing;
  });
  if (repeated || static_cast<int>(requested.size()) == p.word_max_candidates) return;
  requested.push_back(older.path_length);
  requestVerification({match.keyframe_older, match.keyframe_newer, true, LoopSource::kNgram,
                       match.measured, p.word_search_window, p.word_search_angle, index});
}

int SlamEngine::keyframeAt(double stamp) const {
  const auto begin = state_.keyframes.begin() + first_of_run_;
  const auto after = std::upper_bound(begin, state_.keyframes.end(), stamp,
                                      [](double s, const SlamKeyframe& k) { return s < k.stamp; });
  return static_cast<int>((after == begin ? begin : after - 1) - state_.keyframes.begin());
}

// ---- by signatures

/// Those of a saved map, whose signatures are not saved.
void SlamEngine::queueSavedKeyframes() {
  if (!usesSignatures()) return;
  const auto saved = static_cast<int>(state_.keyframes.size());
  signatures_->askFrom(saved);
  std::vector<const Pose2*> motions(state_.keyframes.size(), nullptr);
  for (const auto& e : state_.odometry) {
    if (e.from + 1 == e.to) motions[static_cast<std::size_t>(e.to)] = &e.measured;
  }
  for (int k = 0; k < saved; ++k) {
    queueKeyframe(k, motions[static_cast<std::size_t>(k)]);
  }
  run_to_end_ = true;
}

/// `motion`: from the keyframe before; null at the beginning of a run.
void SlamEngine::queueKeyframe(int k, const Pose2* motion) {
  if (!usesSignatures()) return;
  if (motion == nullptr) run_to_end_ = false;  // this one tells it
  keyframes_to_sign_.push_back(
      {k, motion == nullptr, motion == nullptr ? Pose2{} : *motion, keyframe(k).scan});
}

/// Requests the verification of candidates of which the graph knows nothing better.
void SlamEngine::searchSignatureLoops(const std::vector<SignatureCandidate>& candidates) {
  const LoopParams& p = params_.loop;
  int searched = -1;
  std::vector<double> path_lengths;
  for (const SignatureCandidate& c : candidates) {
    if (c.keyframe_newer <= c.keyframe_older) continue;
    const SlamKeyframe& newer = keyframe(c.keyframe_newer);
    const SlamKeyframe& older = keyframe(c.keyframe_older);
    if (newer.run == older.run && newer.path_length - older.path_length < p.min_path_length) {
      continue;
    }
    if (c.keyframe_newer != searched) {
      searched = c.keyframe_newer;
      path_lengths = path_lengths_.from(searched);
    }
    const double length = path_lengths[static_cast<std::size_t>(c.keyframe_older)];
    const double uncertainty = p.positionUncertainty(length);
    if (uncertainty <= p.near_max_uncertainty) continue;  // searchNearLoops() looks there
    // addFarLoop() would not believe what is found, unless it doubts where the run lies.
    if (std::isfinite(length) && (newer.run == older.run || !mayBeDoubted()) &&
        distance(newer.pose, older.pose) >
            uncertainty + p.visibility_margin + p.signature_search_window) {
      continue;
    }
    requestVerification({c.keyframe_older,
                         c.keyframe_newer,
                         true,
                         LoopSource::kSignature,
                         {0.0, 0.0, c.direction == Direction::kReverse ? hyselam::kPi : 0.0},
                         p.signature_search_window,
                         p.signature_search_angle,
                         kNoMatch});
  }
}

// ---- verification

SlamCounters::Loops& SlamEngine::counterOf(LoopSource source, bool far) {
  SlamCounters& c = state_.counters;
  if (source == LoopSource::kNgram) return c.words;
  if (source == LoopSource::kSignature) return c.signatures;
  return far ? c.far : c.near;
}

void SlamEngine::requestVerification(const LoopGuess& guess) {
  const LoopParams& p = params_.loop;
  LoopTask task = guess.far
                      ? farLoopTask(state_.keyframes, guess.older, guess.newer, p)
                      : nearLoopTask(state_.keyframes, guess.older, guess.newer, guess.window, p);
  task.source = guess.source;
  task.initial_guess = guess.newer_in_older;
  task.window = guess.window;
  task.angle = std::min(guess.angle, hyselam::kPi);
  task.match = guess.match;
  task.any_heading = guess.source == LoopSource::kSignature || guess.any_heading;
  task.place_probability = guess.place_probability;
  if (guess.match != kNoMatch) state_.matches[static_cast<std::size_t>(guess.match)].tried = true;
  ++counterOf(guess.source, guess.far).tried;
  tasks_.push_back(std::move(task));
}

void SlamEngine::applyVerification(const LoopTask& task, const LoopVerification& answer) {
  if (task.step) {
    applyStep(task, answer);
    return;
  }
  SlamCounters::Loops& count = counterOf(task.source, task.far);
  if (!answer.verified) return;
  ++count.verified;
  SlamMatch* match =
      task.match >= 0 && task.match < static_cast<std::int64_t>(state_.matches.size())
          ? &state_.matches[static_cast<std::size_t>(task.match)]
          : nullptr;
  // Matches may have been found again, in another order, while the task was out.
  if (match != nullptr &&
      (match->keyframe_newer != task.newer || match->keyframe_older != task.older)) {
    match = nullptr;
  }
  if (match != nullptr) {
    match->verified = true;
    match->measured = answer.loop.measured;
  }
  if (task.place_probability > 0.0) {
    addPlacedLoop(answer.loop, task.place_probability);
    return;
  }
  if (task.far) {
    addFarLoop(answer.loop);
    return;
  }
  if (!isWhereSupposed(answer.loop)) return;
  if (match != nullptr) match->accepted = true;
  ++count.accepted;
  addLoopEdge(answer.loop);
}

/// Whether a near loop still is one: its run may have been taken elsewhere while it was verified.
bool SlamEngine::isWhereSupposed(const SlamLoop& loop) const {
  const SlamKeyframe &older = keyframe(loop.older), &newer = keyframe(loop.newer);
  if (older.run == newer.run) return true;
  return connections_.connected(older.run, newer.run) &&
         distance(between(older.pose, newer.pose), loop.measured) <=
             params_.loop.near_max_uncertainty + params_.loop.visibility_margin;
}

void SlamEngine::addLoopEdge(const SlamLoop& loop) {
  state_.loops.push_back(loop);
  path_lengths_.addEdge(loop.older, loop.newer, params_.loop.loop_path_length);
  connections_.connect(keyframe(loop.older).run, keyframe(loop.newer).run);
  loops_changed_ = true;
}

/// Accepts a verified far loop, or lets it wait until enough others are consistent with it.
void SlamEngine::addFarLoop(const SlamLoop& loop) {
  const LoopParams& p = params_.loop;
  // A place that the graph excludes.
  const double length =
      path_lengths_.from(loop.newer, {loop.older})[static_cast<std::size_t>(loop.older)];
  const Pose2 known = between(keyframe(loop.older).pose, keyframe(loop.newer).pose);
  if (std::isfinite(length) &&
      distance(known, loop.measured) > p.positionUncertainty(length) + p.visibility_margin) {
    doubtTies(loop);
    return;
  }
  for (const SlamLoop& l : believeFarLoops(loop, usedFarLoops(), state_.keyframes, connections_, p,
                                           &state_.pending_loops)) {
    acceptFarLoop(l);
  }
}

std::vector<SlamLoop> SlamEngine::usedFarLoops() const {
  std::vector<SlamLoop> used;
  for (const SlamLoop& l : state_.loops) {
    if (l.far && isUsed(l)) used.push_back(l);
  }
  return used;
}

void SlamEngine::acceptFarLoop(const SlamLoop& loop) {
  ++counterOf(loop.source, true).accepted;
  for (SlamMatch& m : state_.matches) {
    if (m.keyframe_newer == loop.newer && m.keyframe_older == loop.older && m.verified) {
      m.accepted = true;
    }
  }
  placeRun(loop);
  addLoopEdge(loop);
  optimize_now_ = true;
}

}  // namespace ngram_slam
