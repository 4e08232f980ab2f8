// Candidates verified by the scans and believed or not as in SLAM, and the figures of one log.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "hyselam_common/tool.hpp"
#include "ngram_slam/slam/far_loops.hpp"
#include "ngram_slam/slam/loop_confidence.hpp"
#include "ngram_slam/slam/loop_tasks.hpp"
#include "ngram_slam/slam/slam_score.hpp"
#include "place_candidates.hpp"
#include "tool_parts.hpp"

namespace ngram_slam {

constexpr double kPairDistance = 1.0;  // of places laid over each other [m]
constexpr double kSure = 0.95;         // least probability of a match that is told as sure
constexpr int kPairs = 4;              // places before and after a match

inline LoopVerification verify(const PlaceLog& log, const PlaceCandidate& c,
                               const SlamParams& params) {
  return verifyLoop(
      farLoopTask(log.keyframes, static_cast<int>(log.places[c.older].on_way.keyframe),
                  static_cast<int>(log.places[c.newer].on_way.keyframe), params.loop),
      params);
}

/// Counts of one log.
struct Figures {
  std::size_t questions = 0, revisits = 0, revisits_same = 0, revisits_old = 0;
  std::array<std::size_t, 3> first{};  // a true place among the first 1, 5, 10
  std::size_t matches = 0, wrong = 0, pairs = 0, true_pairs = 0;
  std::size_t verified_matches = 0, verified_wrong = 0, sure = 0, sure_wrong = 0;
  std::size_t unknown = 0;  // matches that no reference tells right or wrong; in none of the others
  std::size_t found = 0, found_same = 0, found_old = 0;
  std::size_t passes = 0, passes_same = 0;  // earlier ones of the revisits
  std::size_t found_passes = 0, found_passes_same = 0;
  std::size_t words = 0;  // that were made of the log, if any were
  // The best candidate of a question by itself; "alone": none that is surer or as sure is wrong.
  std::size_t first_told = 0, first_wrong = 0;
  std::size_t alone = 0, alone_same = 0, alone_old = 0, alone_by_pair = 0;
  std::vector<double> verification_s;  // of each candidate
  double retrieval_s = 0.0;

  static double share(std::size_t part, std::size_t of) {
    return of == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(of);
  }
  Figures& operator+=(const Figures& o) {
    for (std::size_t Figures::*count : {&Figures::questions,
                                        &Figures::revisits,
                                        &Figures::revisits_same,
                                        &Figures::revisits_old,
                                        &Figures::matches,
                                        &Figures::wrong,
                                        &Figures::pairs,
                                        &Figures::true_pairs,
                                        &Figures::verified_matches,
                                        &Figures::verified_wrong,
                                        &Figures::sure,
                                        &Figures::sure_wrong,
                                        &Figures::unknown,
                                        &Figures::found,
                                        &Figures::found_same,
                                        &Figures::found_old,
                                        &Figures::passes,
                                        &Figures::passes_same,
                                        &Figures::found_passes,
                                        &Figures::found_passes_same,
                                        &Figures::words,
                                        &Figures::first_told,
                                        &Figures::first_wrong,
                                        &Figures::alone,
                                        &Figures::alone_same,
                                        &Figures::alone_old,
                                        &Figures::alone_by_pair}) {
      this->*count += o.*count;
    }
    for (std::size_t i = 0; i < first.size(); ++i) first[i] += o.first[i];
    verification_s.insert(verification_s.end(), o.verification_s.begin(), o.verification_s.end());
    retrieval_s += o.retrieval_s;
    return *this;
  }
  /// What is recognized, in the names that evaluate_recognition has for words, too: `revisits`,
  /// `recall`, `pass_recall` in the same direction.
  nlohmann::json recognition() const {
    return {{"recognized_by", "places"},
            {"words", words},
            {"questions", questions},
            {"matches", matches},
            {"match_precision", matches == 0 ? 1.0 : 1.0 - share(wrong, matches)},
            {"matches_without_reference", unknown},
            {"pairs", pairs},
            {"precision", pairs == 0 ? 1.0 : share(true_pairs, pairs)},
            {"revisits", revisits_same},
            {"recall", share(found_same, revisits_same)},
            {"pass_recall", share(found_passes_same, passes_same)},
            {"revisits_any_direction", revisits},
            {"recall_any_direction", share(found, revisits)},
            {"pass_recall_any_direction", share(found_passes, passes)},
            {"revisits_older_than_40_m", revisits_old},
            {"recall_older_than_40_m", share(found_old, revisits_old)},
            {"verified", verified_matches},
            {"verified_precision",
             verified_matches == 0 ? 1.0 : 1.0 - share(verified_wrong, verified_matches)},
            {"sure", sure},
            {"sure_precision", sure == 0 ? 1.0 : 1.0 - share(sure_wrong, sure)},
            {"first_candidate_right", share(first[0], revisits)},
            {"recall_unverified_none_wrong", share(alone, revisits)},
            {"ms_verification_95_percent", 1e3 * verificationQuantile(0.95)}};
  }
  nlohmann::json json(const std::string& name, const std::string& method) const {
    return {
        {"log", name},
        {"method", method},
        {"questions", questions},
        {"revisits", revisits},
        {"revisits_same", revisits_same},
        {"revisits_old", revisits_old},
        {"first_1", share(first[0], revisits)},
        {"first_5", share(first[1], revisits)},
        {"first_10", share(first[2], revisits)},
        {"first_told", first_told},
        {"first_wrong", first_wrong},
        {"recall_unverified_none_wrong", share(alone, revisits)},
        {"recall_unverified_none_wrong_same", share(alone_same, revisits_same)},
        {"recall_unverified_none_wrong_old", share(alone_old, revisits_old)},
        {"recall_unverified_no_pair_wrong", share(alone_by_pair, revisits)},
        {"verified", verified_matches},
        {"verified_wrong", verified_wrong},
        {"matches", matches},
        {"matches_wrong", wrong},
        {"matches_without_reference", unknown},
        {"sure", sure},
        {"sure_wrong", sure_wrong},
        {"pair_precision", pairs == 0 ? 1.0 : share(true_pairs, pairs)},
        {"recall", share(found, revisits)},
        {"recall_same", share(found_same, revisits_same)},
        {"recall_old", share(found_old, revisits_old)},
        {"ms_retrieval", questions == 0 ? 0.0 : 1e3 * retrieval_s / static_cast<double>(questions)},
        {"ms_verification",
         verification_s.empty()
             ? 0.0
             : 1e3 * std::accumulate(verification_s.begin(), verification_s.end(), 0.0) /
                   static_cast<double>(verification_s.size())},
        {"ms_verification_95_percent", 1e3 * verificationQuantile(0.95)},
        {"ms_verification_worst", 1e3 * verificationQuantile(1.0)}};
  }
  /// Seconds that this part of the verifications did not exceed.
  double verificationQuantile(double part) const {
    if (verification_s.empty()) return 0.0;
    std::vector<double> sorted = verification_s;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  }
};

/// The pairs of places that a match lays over each other.
inline void countPairs(const PlaceLog& log, const PlaceCandidate& c,
                       const hyselam::Pose2& newer_in_older, Figures* f) {
  const auto& older_frame =
      log.keyframes[static_cast<std::size_t>(log.places[c.older].on_way.keyframe)].pose;
  const auto& newer_frame =
      log.keyframes[static_cast<std::size_t>(log.places[c.newer].on_way.keyframe)].pose;
  const auto last = static_cast<std::int64_t>(log.places.size()) - 1;
  for (std::int64_t n = std::max<std::int64_t>(0, static_cast<std::int64_t>(c.newer) - kPairs);
       n <= std::min<std::int64_t>(last, static_cast<std::int64_t>(c.newer) + kPairs); ++n) {
    const LogPlace& newer = log.places[static_cast<std::size_t>(n)];
    const hyselam::Pose2 there =
        older_frame * newer_in_older * between(newer_frame, newer.on_way.pose);
    const LogPlace* nearest = nullptr;
    for (std::int64_t m = std::max<std::int64_t>(0, static_cast<std::int64_t>(c.older) - 20);
         m <= std::min<std::int64_t>(n - 1, static_cast<std::int64_t>(c.older) + 20); ++m) {
      const LogPlace& older = log.places[static_cast<std::size_t>(m)];
      if (distance(older.on_way.pose, there) > kPairDistance) continue;
      if (nearest == nullptr ||
          distance(older.on_way.pose, there) < distance(nearest->on_way.pose, there)) {
        nearest = &older;
      }
    }
    if (nearest == nullptr || !newer.truth || !nearest->truth) continue;
    ++f->pairs;
    f->true_pairs += isTruePlace(newer, *nearest) ? 1 : 0;
  }
}

/// Whether a candidate by itself lays a pair of places over each other that is none, along `reach`
/// places before and after.
inline bool hasWrongPair(const PlaceLog& log, const PlaceCandidate& c, int reach) {
  const int step = c.direction == Direction::kSame ? 1 : -1;
  for (int d = -reach; d <= reach; ++d) {
    const std::int64_t n = std::int64_t{c.newer} + d, o = std::int64_t{c.older} + step * d;
    const auto end = static_cast<std::int64_t>(log.places.size());
    if (n < 0 || o < 0 || n >= end || o >= end) continue;
    const LogPlace& newer = log.places[static_cast<std::size_t>(n)];
    const LogPlace& older = log.places[static_cast<std::size_t>(o)];
    if (newer.truth && older.truth && !isTruePlace(newer, older)) return true;
  }
  return false;
}

/// What the best candidates by themselves find, as far as none surer or as sure is wrong.
inline void countUnverified(const PlaceLog& log, const Candidates& all, int reach, Figures* f) {
  std::vector<PlaceCandidate> tops;
  for (const auto& candidates : all) {
    if (candidates.empty() || !log.places[candidates[0].newer].truth) continue;
    if (log.places[candidates[0].older].truth) tops.push_back(candidates[0]);
  }
  const double nothing = -std::numeric_limits<double>::infinity();
  double wrong = nothing, wrong_pair = nothing;  // surest of those
  for (const PlaceCandidate& c : tops) {
    if (!isTruePlace(log.places[c.newer], log.places[c.older])) wrong = std::max(wrong, c.score);
    if (hasWrongPair(log, c, reach)) wrong_pair = std::max(wrong_pair, c.score);
    f->first_wrong += isTruePlace(log.places[c.newer], log.places[c.older]) ? 0 : 1;
  }
  f->first_told = tops.size();
  for (const PlaceCandidate& c : tops) {
    if (c.score > wrong_pair && c.score > wrong) ++f->alone_by_pair;
    if (c.score <= wrong) continue;
    const Revisit revisit = revisitOf(log, c.newer);
    f->alone += revisit.any ? 1 : 0;
    f->alone_same += revisit.same ? 1 : 0;
    f->alone_old += revisit.old ? 1 : 0;
  }
}

/// A candidate that the scans fit.
struct Match {
  PlaceCandidate candidate;
  std::size_t rank;
  LoopVerification verification;
  LoopCompany company;
  bool is_believed;  ///< as SLAM believes it, by the loops found until then and soon after
  std::optional<bool> is_right;  ///< nothing where no reference tells
};

/// Whether SLAM believes each, in the order in which they are found.
inline void believe(const PlaceLog& log, const LoopParams& params, std::vector<Match>* matches) {
  std::vector<SlamLoop> believed, waiting;
  for (const Match& m : *matches) {
    if (!m.verification.verified) continue;
    const auto now =
        believeFarLoops(m.verification.loop, believed, log.keyframes, {}, params, &waiting);
    believed.insert(believed.end(), now.begin(), now.end());
  }
  for (Match& m : *matches) {
    m.is_believed = std::any_of(believed.begin(), believed.end(), [&](const SlamLoop& l) {
      const SlamLoop& own = m.verification.loop;
      return l.older == own.older && l.newer == own.newer && l.measured.x == own.measured.x &&
             l.measured.y == own.measured.y;
    });
  }
}

/// The first `verified` candidates of each question, compared by the scans.
inline std::vector<Match> matchesOf(const PlaceLog& log, const Candidates& all,
                                    std::size_t verified, Figures* f) {
  const SlamParams params;
  std::vector<Match> matches;
  std::vector<SlamLoop> loops;
  hyselam::Progress progress("verification in " + log.name, all.size());
  for (std::size_t q = 0; q < all.size(); ++q) {
    progress.update(q + 1);
    if (!log.places[q * kQuestionInterval].truth) continue;
    for (std::size_t k = 0; k < std::min(verified, all[q].size()); ++k) {
      const double begin = cpuSeconds();
      const LoopVerification v = verify(log, all[q][k], params);
      f->verification_s.push_back(cpuSeconds() - begin);
      if (v.score == 0.0) continue;
      const auto error = loopError(log.keyframes[static_cast<std::size_t>(v.loop.older)],
                                   log.keyframes[static_cast<std::size_t>(v.loop.newer)],
                                   v.loop.measured, log.reference);
      std::optional<bool> is_right;
      if (error) is_right = !error->isFalse();
      matches.push_back({all[q][k], k, v, {}, false, is_right});
      if (v.verified) loops.push_back(v.loop);
    }
  }
  for (Match& m : matches) {
    m.company = companyOf(m.verification.loop, loops, log.keyframes, {}, params.loop);
  }
  believe(log, params.loop, &matches);
  return matches;
}

inline void writeRows(const PlaceLog& log, const std::vector<Match>& matches, std::ostream& out) {
  for (const Match& m : matches) {
    const LoopVerification& v = m.verification;
    out << log.name << ',' << m.candidate.newer << ',' << m.candidate.older << ',' << m.rank << ','
        << m.candidate.score << ',' << v.score << ',' << v.loop.inlier_ratio << ','
        << v.new_in_old.observed_ratio << ',' << v.new_in_old.surface_ratio << ','
        << v.old_in_new.surface_ratio << ',' << v.ambiguous_score << ',' << m.company.support << ','
        << m.company.contradiction << ',' << (v.verified ? loopProbability(v.loop, m.company) : 0.0)
        << ',' << (v.verified ? 1 : 0) << ',' << (m.is_believed ? 1 : 0) << ','
        << (m.is_right ? *m.is_right ? 1 : 0 : -1) << '\n';
  }
}

/// Which earlier passes of a question's place were told by matches with these earlier places: a
/// match tells of what lies within the distance of one place.
inline void countPasses(const std::vector<Pass>& passes, const std::vector<std::uint32_t>& told,
                        Figures* f) {
  for (const Pass& p : passes) {
    const bool found = std::any_of(told.begin(), told.end(), [&](std::uint32_t older) {
      return older + kQuestionInterval >= p.first && older <= p.last + kQuestionInterval;
    });
    ++f->passes;
    f->found_passes += found ? 1 : 0;
    f->passes_same += p.same ? 1 : 0;
    f->found_passes_same += found && p.same ? 1 : 0;
  }
}

/// `reach`: places before and after that an unverified candidate lays over each other; `verified`:
/// candidates of each question that are; `rows`: what each came to, if not null.
inline Figures figuresOf(const PlaceLog& log, const Candidates& all, int reach,
                         std::size_t verified, std::ostream* rows) {
  Figures f;
  const std::vector<Match> matches = matchesOf(log, all, verified, &f);
  if (rows != nullptr) writeRows(log, matches, *rows);
  std::vector<std::vector<std::uint32_t>> right(all.size());  // earlier places, of each question
  for (const Match& m : matches) {
    if (!m.verification.verified) continue;
    if (!m.is_right) {
      ++f.unknown;
      continue;
    }
    ++f.verified_matches;
    f.verified_wrong += *m.is_right ? 0 : 1;
    if (loopProbability(m.verification.loop, m.company) >= kSure) {
      ++f.sure;
      f.sure_wrong += *m.is_right ? 0 : 1;
    }
    if (!m.is_believed) continue;
    ++f.matches;
    f.wrong += *m.is_right ? 0 : 1;
    if (*m.is_right) right[m.candidate.newer / kQuestionInterval].push_back(m.candidate.older);
    countPairs(log, m.candidate, m.verification.loop.measured, &f);
  }
  for (std::size_t q = 0; q < all.size(); ++q) {
    const auto i = static_cast<std::uint32_t>(q * kQuestionInterval);
    if (!log.places[i].truth) continue;
    ++f.questions;
    const std::vector<Pass> passes = passesOf(log, i);
    countPasses(passes, right[q], &f);
    const Revisit revisit = revisitOf(passes, i);
    f.revisits += revisit.any ? 1 : 0;
    f.revisits_same += revisit.same ? 1 : 0;
    f.revisits_old += revisit.old ? 1 : 0;
    f.found += !right[q].empty() && revisit.any ? 1 : 0;
    f.found_same += !right[q].empty() && revisit.same ? 1 : 0;
    f.found_old += !right[q].empty() && revisit.old ? 1 : 0;
    for (std::size_t k = 0; k < all[q].size(); ++k) {
      if (!isTruePlace(log.places[i], log.places[all[q][k].older])) continue;
      for (std::size_t n = 0; n < 3; ++n) f.first[n] += k < std::array{1U, 5U, 10U}[n] ? 1 : 0;
      break;
    }
  }
  countUnverified(log, all, reach, &f);
  return f;
}

}  // namespace ngram_slam
