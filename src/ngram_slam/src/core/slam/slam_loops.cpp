// Loops of the engine: where to look, what to do with the answers.
#include <algorithm>
#include <cmath>
#include <limits>

#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;

namespace {

constexpr double kLoopWay = 0.5;     // [m] of GraphWays through a loop
constexpr double kWordsApart = 5.0;  // [m] of old way: matches closer than this are one question
constexpr int kWordsMost = 4;        // questions for one new word

hyselam::Point2 laserOf(const SlamKeyframe& k) {
  return {k.scan->laser_in_base.x, k.scan->laser_in_base.y};
}

}  // namespace

void SlamEngine::relearnWays() {
  ways_.clear();
  for (const auto& e : state_.odometry)
    ways_.add(e.from, e.to, std::hypot(e.measured.x, e.measured.y));
  for (const SlamLoop& l : state_.loops)
    if (l.weight >= kDoubtedWeight) ways_.add(l.older, l.newer, kLoopWay);
}

LoopTask::Stretch SlamEngine::stretchAround(int keyframe, double half, double not_after) const {
  const SlamKeyframe& middle = state_.keyframes[static_cast<std::size_t>(keyframe)];
  LoopTask::Stretch stretch;
  const auto belongs = [&](int k) {
    const SlamKeyframe& other = state_.keyframes[static_cast<std::size_t>(k)];
    return other.run == middle.run && std::abs(other.way - middle.way) <= half;
  };
  int first = keyframe;
  while (first > 0 && belongs(first - 1)) --first;
  const auto n = static_cast<int>(state_.keyframes.size());
  for (int k = first; k < n && belongs(k); ++k) {
    const SlamKeyframe& other = state_.keyframes[static_cast<std::size_t>(k)];
    if (other.way > not_after) break;
    stretch.push_back({between(middle.pose, other.pose), other.points, laserOf(other)});
  }
  return stretch;
}

void SlamEngine::ask(int older, int newer, bool far, LoopSource source, const Pose2& guess,
                     double window, double turn, std::int64_t match) {
  LoopTask task;
  task.older = older;
  task.newer = newer;
  task.far = far;
  task.source = source;
  task.guess = guess;
  task.window = window;
  task.turn = std::min(turn, hyselam::kPi);
  task.match = match;
  const LoopParams& p = params_.loop;
  const SlamKeyframe& from = state_.keyframes[static_cast<std::size_t>(older)];
  const SlamKeyframe& to = state_.keyframes[static_cast<std::size_t>(newer)];
  // The new stretch must not be compared with itself.
  const double gap = 10.0;
  const double not_after =
      from.run == to.run ? to.way - gap : std::numeric_limits<double>::infinity();
  task.old_stretch = stretchAround(older, far ? p.far_stretch : p.near_stretch, not_after);
  if (far)
    task.new_stretch = stretchAround(newer, p.far_half, std::numeric_limits<double>::infinity());
  else
    task.new_stretch.push_back({Pose2{}, to.points, laserOf(to)});
  if (match >= 0) {
    SlamMatch& m = state_.matches[static_cast<std::size_t>(match)];
    m.tried = true;
    ++state_.counters.words.tried;
  } else {
    ++(far ? state_.counters.far : state_.counters.near).tried;
  }
  tasks_.push_back(std::move(task));
}

void SlamEngine::lookAround() {
  if (params_.loops == SlamLoops::kNone || params_.loops == SlamLoops::kThesis) return;
  const LoopParams& p = params_.loop;
  const auto n = static_cast<int>(state_.keyframes.size()) - 1;
  if (n % p.every == 0) {
    const std::vector<double> ways = ways_.from(n);
    int asked = 0;
    for (const LoopCandidate& c : loopCandidates(state_.keyframes, n, ways, p)) {
      if (c.window > p.near_window) continue;
      if (asked++ == p.most) break;
      const Pose2 guess = between(state_.keyframes[static_cast<std::size_t>(c.older)].pose,
                                  state_.keyframes[static_cast<std::size_t>(n)].pose);
      ask(c.older, n, false, LoopSource::kProximity, guess, c.window, p.near_turn, -1);
    }
  }
  if (params_.loops == SlamLoops::kNgrams || way_ - far_searched_ < p.far_every) return;
  far_searched_ = way_;
  // The middle of the stretch driven last.
  int middle = n;
  while (middle > first_of_run_ &&
         way_ - state_.keyframes[static_cast<std::size_t>(middle)].way < p.far_half)
    --middle;
  const std::vector<double> ways = ways_.from(middle);
  int asked = 0;
  for (const LoopCandidate& c : loopCandidates(state_.keyframes, middle, ways, p)) {
    if (c.window <= p.near_window) continue;
    if (asked++ == p.far_most) break;
    const Pose2 guess = between(state_.keyframes[static_cast<std::size_t>(c.older)].pose,
                                state_.keyframes[static_cast<std::size_t>(middle)].pose);
    ask(c.older, middle, true, LoopSource::kProximity, guess, c.window, c.turn, -1);
  }
}

int SlamEngine::keyframeAt(double stamp) const {
  const auto begin = state_.keyframes.begin() + first_of_run_;
  const auto after = std::upper_bound(begin, state_.keyframes.end(), stamp,
                                      [](double s, const SlamKeyframe& k) { return s < k.stamp; });
  return static_cast<int>((after == begin ? begin : after - 1) - state_.keyframes.begin());
}

void SlamEngine::takeWords(WordPlaces::Update update) {
  for (const double stamp : update.stamps)
    state_.keyframe_of_observation.push_back(keyframeAt(stamp));
  if (update.requantised) {
    state_.matches.clear();
    for (LoopTask& t : tasks_) t.match = -1;
  }
  const LoopParams& p = params_.loop;
  // The likeliest first: few questions are asked for each word.
  std::stable_sort(update.matches.begin(), update.matches.end(),
                   [](const SlamMatch& a, const SlamMatch& b) {
                     return a.newer != b.newer ? a.newer < b.newer : a.probability > b.probability;
                   });
  std::vector<double> ways, asked;
  int ways_from = -1;
  for (SlamMatch& m : update.matches) {
    m.keyframe_newer = state_.keyframe_of_observation[m.newer];
    m.keyframe_older = state_.keyframe_of_observation[m.older];
    const bool reverse = m.direction == Direction::kReverse;
    m.measured = {0.0, 0.0, reverse ? hyselam::kPi : 0.0};
    state_.matches.push_back(m);
    SlamMatch& kept = state_.matches.back();
    const SlamKeyframe& newer = state_.keyframes[static_cast<std::size_t>(m.keyframe_newer)];
    const SlamKeyframe& older = state_.keyframes[static_cast<std::size_t>(m.keyframe_older)];
    if (m.keyframe_newer <= m.keyframe_older) continue;
    if (params_.loops == SlamLoops::kThesis) {
      SlamLoop loop;
      loop.older = m.keyframe_older;
      loop.newer = m.keyframe_newer;
      loop.measured = m.measured;
      loop.source = LoopSource::kNgram;
      const double position = 1.0 / (p.thesis_deviation * p.thesis_deviation);
      loop.information = Eigen::Vector3d(position, position,
                                         1.0 / (p.thesis_turn_deviation * p.thesis_turn_deviation))
                             .asDiagonal();
      kept.accepted = true;
      ++state_.counters.words.accepted;
      accept(loop);
      continue;
    }
    if (newer.run == older.run && newer.way - older.way < p.least_way) continue;
    if (m.keyframe_newer != ways_from) {
      ways_from = m.keyframe_newer;
      ways = ways_.from(ways_from);
      asked.clear();
    }
    const auto index = static_cast<std::int64_t>(state_.matches.size()) - 1;
    const double way = ways[static_cast<std::size_t>(m.keyframe_older)];
    const Pose2 known = between(older.pose, newer.pose);
    const bool same_place = std::hypot(known.x, known.y) <= p.word_window;
    if (p.reach(way) <= p.near_window) {
      // The graph knows better; the scans say whether words were right.
      if (same_place)
        ask(m.keyframe_older, m.keyframe_newer, false, LoopSource::kNgram, known, p.reach(way),
            p.near_turn, index);
      else
        kept.tried = true;
      continue;
    }
    const bool again = std::any_of(asked.begin(), asked.end(),
                                   [&](double w) { return std::abs(w - older.way) < kWordsApart; });
    if (again || static_cast<int>(asked.size()) == kWordsMost) continue;
    asked.push_back(older.way);
    ask(m.keyframe_older, m.keyframe_newer, true, LoopSource::kNgram, m.measured, p.word_window,
        p.word_turn, index);
  }
}

void SlamEngine::takeAnswer(const LoopTask& task, const LoopAnswer& answer) {
  SlamCounters::Loops& count = task.source == LoopSource::kNgram ? state_.counters.words
                               : task.far                        ? state_.counters.far
                                                                 : state_.counters.near;
  if (!answer.verified) return;
  ++count.verified;
  SlamMatch* match =
      task.match >= 0 && task.match < static_cast<std::int64_t>(state_.matches.size())
          ? &state_.matches[static_cast<std::size_t>(task.match)]
          : nullptr;
  // Matches may have been found anew while the task was out.
  if (match != nullptr &&
      (match->keyframe_newer != task.newer || match->keyframe_older != task.older))
    match = nullptr;
  if (match != nullptr) {
    match->verified = true;
    match->measured = answer.loop.measured;
  }
  if (task.far) {
    takeFar(answer.loop);
    return;
  }
  if (match != nullptr) match->accepted = true;
  ++count.accepted;
  accept(answer.loop);
}

void SlamEngine::accept(const SlamLoop& loop) {
  state_.loops.push_back(loop);
  ways_.add(loop.older, loop.newer, kLoopWay);
  dirty_ = true;
}

void SlamEngine::takeFar(const SlamLoop& loop) {
  const LoopParams& p = params_.loop;
  // A place that the graph excludes.
  const double way = ways_.from(loop.newer)[static_cast<std::size_t>(loop.older)];
  const Pose2 known = between(state_.keyframes[static_cast<std::size_t>(loop.older)].pose,
                              state_.keyframes[static_cast<std::size_t>(loop.newer)].pose);
  if (std::isfinite(way) && distance(known, loop.measured) > p.reach(way) + 2.0) return;

  const auto admit = [&](const SlamLoop& l) {
    SlamCounters::Loops& count =
        l.source == LoopSource::kNgram ? state_.counters.words : state_.counters.far;
    ++count.accepted;
    for (SlamMatch& m : state_.matches)
      if (m.keyframe_newer == l.newer && m.keyframe_older == l.older && m.verified)
        m.accepted = true;
    accept(l);
    urgent_ = true;
  };
  std::vector<SlamLoop> standing;
  for (const SlamLoop& l : state_.loops)
    if (l.far && l.weight >= kDoubtedWeight) standing.push_back(l);
  if (!agreeing(loop, standing, state_.keyframes, p).empty()) {
    admit(loop);
    return;
  }
  const std::vector<std::size_t> company = agreeing(loop, state_.waiting, state_.keyframes, p);
  double first = state_.keyframes[static_cast<std::size_t>(loop.newer)].way, last = first;
  for (const std::size_t i : company) {
    const double at = state_.keyframes[static_cast<std::size_t>(state_.waiting[i].newer)].way;
    first = std::min(first, at);
    last = std::max(last, at);
  }
  if (static_cast<int>(company.size()) + 1 < p.company || last - first < p.company_span) {
    state_.waiting.push_back(loop);
    return;
  }
  admit(loop);
  for (auto i = company.rbegin(); i != company.rend(); ++i) {
    admit(state_.waiting[*i]);
    state_.waiting.erase(state_.waiting.begin() + static_cast<std::ptrdiff_t>(*i));
  }
}

}  // namespace ngram_slam
