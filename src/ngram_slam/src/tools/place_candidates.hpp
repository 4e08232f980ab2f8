// Questions about places of a recorded run, and the earlier places that may answer them.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "../../bench/peers/polar_context.hpp"
#include "ngram_slam/signatures/place_recognizer.hpp"
#include "place_logs.hpp"

namespace ngram_slam {

constexpr double kPlaceDistance = 2.0;  // of one place [m]
constexpr double kPlaceHeading = hyselam::radians(45.0);
constexpr std::uint32_t kPlaceSeparation = 20;  // places, 10 m
constexpr std::uint32_t kOldPlace = 80;         // places, 40 m
constexpr std::uint32_t kQuestionInterval = 4;  // places from question to question
constexpr int kChainLength = 24;                // places of the longest chain, 12 m

/// How candidates are found.
struct CandidateOptions {
  bool exact = false;
  int candidates = 8;  ///< verified of each question

  int told() const { return std::max(10, candidates); }
};

inline bool isTruePlace(const LogPlace& a, const LogPlace& b) {
  return a.truth && b.truth && distance(*a.truth, *b.truth) <= kPlaceDistance;
}

/// Earlier visits of a place: runs of places along the way, [first, last], that lie where it lies.
struct Pass {
  std::uint32_t first = 0, last = 0;
  bool same = false;  ///< direction
};

/// Passes are apart by `kQuestionInterval` places or more, or by their direction.
inline std::vector<Pass> passesOf(const PlaceLog& log, std::uint32_t i) {
  std::vector<Pass> passes;
  for (std::uint32_t j = 0; j + kPlaceSeparation <= i; ++j) {
    if (!isTruePlace(log.places[i], log.places[j])) continue;
    const double turn = log.places[i].truth->theta - log.places[j].truth->theta;
    const bool same = std::abs(hyselam::normalizeAngle(turn)) <= kPlaceHeading;
    if (!passes.empty() && passes.back().same == same &&
        j - passes.back().last < kQuestionInterval) {
      passes.back().last = j;
    } else {
      passes.push_back({j, j, same});
    }
  }
  return passes;
}

/// What kind of revisit a place is.
struct Revisit {
  bool any = false, same = false, old = false;
};

inline Revisit revisitOf(const std::vector<Pass>& passes, std::uint32_t i) {
  Revisit r;
  r.any = !passes.empty();
  r.same = std::any_of(passes.begin(), passes.end(), [](const Pass& p) { return p.same; });
  r.old = r.any && std::none_of(passes.begin(), passes.end(),
                                [i](const Pass& p) { return p.last + kOldPlace > i; });
  return r;
}
inline Revisit revisitOf(const PlaceLog& log, std::uint32_t i) {
  return revisitOf(passesOf(log, i), i);
}

/// As the SLAM knows before any loop.
inline bool odometryAllows(const PlaceLog& log, std::uint32_t newer, std::uint32_t older) {
  const PlaceOnWay &a = log.places[newer].on_way, &b = log.places[older].on_way;
  return a.way < b.way || distance(a.pose, b.pose) <= LoopParams().signatureReach(a.way - b.way);
}

/// Candidates for each question of a log.
using Candidates = std::vector<std::vector<PlaceCandidate>>;

/// `chain_length`: PlaceRecognizerParams::chain_length.
inline Candidates bySignatures(const CandidateOptions& o, const PlaceLog& log,
                               const SignatureModel& model, int chain_length = 0) {
  PlaceRecognizerParams params;
  params.chain_length = chain_length;
  params.max_candidates = o.told();
  PlaceRecognizer recognizer(model, params);
  for (const LogPlace& p : log.places) recognizer.add(model.signatureOf(p.features));
  Candidates all;
  for (std::uint32_t i = 0; i < log.places.size(); i += kQuestionInterval) {
    const auto may_be = [&](std::uint32_t older) { return odometryAllows(log, i, older); };
    all.push_back(o.exact ? recognizer.candidatesOfAll(i, may_be)
                          : recognizer.candidates(i, may_be));
  }
  return all;
}

/// The polar context of the submap around a place.
inline ngram_slam_peers::PolarContext contextOf(const PlaceFeatures& features) {
  ngram_slam_peers::PolarContext context;
  for (std::size_t s = 0; s < context.columns.size(); ++s) {
    for (std::size_t r = 0; r < context.columns[s].size(); ++r) {
      context.columns[s][r] = static_cast<float>(features.context[s][r]);
    }
  }
  context.computeNorms();
  return context;
}

/// Whether one of the candidates tells of the same earlier place, more or less.
inline bool isNearOne(const PlaceCandidate& c, const std::vector<PlaceCandidate>& candidates) {
  const auto spacing = static_cast<std::uint32_t>(PlaceRecognizerParams().candidate_spacing);
  return std::any_of(candidates.begin(), candidates.end(), [&](const PlaceCandidate& t) {
    return std::max(t.older, c.older) - std::min(t.older, c.older) <= spacing;
  });
}

/// The best, and of several near each other the best, as PlaceRecognizer tells them.
inline std::vector<PlaceCandidate> spaced(std::vector<PlaceCandidate> found, int count) {
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<PlaceCandidate> told;
  for (const PlaceCandidate& c : found) {
    if (static_cast<int>(told.size()) == count) break;
    if (!isNearOne(c, told)) told.push_back(c);
  }
  return told;
}

/// By the distance of polar contexts of all earlier places.
inline Candidates byContexts(const CandidateOptions& o, const PlaceLog& log, bool of_scan) {
  std::vector<ngram_slam_peers::PolarContext> contexts;
  for (const LogPlace& p : log.places) {
    const SlamKeyframe& k = log.keyframes[static_cast<std::size_t>(p.on_way.keyframe)];
    contexts.push_back(of_scan ? ngram_slam_peers::contextOf(ngram_slam_peers::returnsOf(*k.scan),
                                                             PlaceFeatures::kRange)
                               : contextOf(p.features));
  }
  Candidates all;
  for (std::uint32_t i = 0; i < contexts.size(); i += kQuestionInterval) {
    std::vector<PlaceCandidate> found;
    for (std::uint32_t j = 0; j + kPlaceSeparation <= i; ++j) {
      if (!odometryAllows(log, i, j)) continue;
      found.push_back(
          {i, j, Direction::kSame, -ngram_slam_peers::contextDistance(contexts[i], contexts[j])});
    }
    all.push_back(spaced(std::move(found), o.told()));
  }
  return all;
}

}  // namespace ngram_slam
