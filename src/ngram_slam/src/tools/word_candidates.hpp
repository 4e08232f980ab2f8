// Earlier places by words of one quantised density and their n-grams, asked as signatures are.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "ngram_slam/matching/alignment.hpp"
#include "ngram_slam/matching/ngram.hpp"
#include "place_candidates.hpp"
#include "recognition_options.hpp"

namespace ngram_slam {

/// Words as in SLAM with defaults ("words"), as in the thesis ("words-thesis"), and with the
/// regions and the tolerance that suit real buildings better ("words-thesis-wide": t_o = 3, 30 %).
inline std::pair<NgramRecognizerParams, ObservationSensorParams> wordParams(
    const std::string& method) {
  const SlamParams p = method == "words" ? SlamParams() : SlamParams::thesis(3);
  NgramRecognizerParams words = p.words;
  if (method != "words") {
    words.matcher.min_n = {3, 6, 9};  // shorter ones than are told by default, as unsure candidates
  }
  if (method == "words-thesis-wide") {
    words.min_region = 3;
    words.matcher.tolerance.size = 0.3;
  }
  return {words, p.observations};
}

/// The place of the way at which an observation was made.
inline std::uint32_t placeAt(const PlaceLog& log, double stamp) {
  const auto after = std::lower_bound(log.places.begin(), log.places.end(), stamp,
                                      [](const LogPlace& p, double t) { return p.stamp < t; });
  if (after == log.places.begin()) return 0;
  const auto i = static_cast<std::uint32_t>(after - log.places.begin());
  const bool nearer =
      after != log.places.end() && after->stamp - stamp < stamp - (after - 1)->stamp;
  return nearer ? i : i - 1;
}

/// A match answers all questions on the way of its longest n-gram: each by the observation that the
/// alignment lays over it. The longer (where words have a probability: the more probable) the
/// surer; of a level above the first, three words less count.
class WordCandidates {
 public:
  WordCandidates(const PlaceLog& log, const NgramRecognizer& recognizer)
      : log_(log), recognizer_(recognizer) {}

  void add(const NgramMatch& match) {
    const NgramRecognizerParams& params = recognizer_.params();
    const double score = params.with_probability || params.min_probability > 0.0
                             ? match.probability
                             : match.n - 3.0 * (match.levels - 1);
    AlignmentParams alignment;
    alignment.density = params.word_density;
    const ObservationStore& observations = recognizer_.observations();
    constexpr std::size_t kMaxWords = 64;
    for (const ObservationPair& pair : alignedObservations(
             recognizer_.text(), observations,
             longestNgram(recognizer_.text(), params.matcher.tolerance, {match.newer, match.older},
                          match.levels, kMaxWords, match.direction),
             1, alignment, match.direction)) {
      const std::uint32_t newer = placeAt(log_, observations.stamp(pair.newer));
      const std::uint32_t older = placeAt(log_, observations.stamp(pair.older));
      if (newer % kQuestionInterval != 0 || older + kPlaceSeparation > newer) continue;
      double& best =
          found_.emplace(std::make_tuple(newer, older, match.direction), score).first->second;
      best = std::max(best, score);
    }
  }

  Candidates candidates(int count) const {
    Candidates all((log_.places.size() + kQuestionInterval - 1) / kQuestionInterval);
    for (const auto& [key, score] : found_) {
      const auto& [newer, older, direction] = key;
      if (!odometryAllows(log_, newer, older)) continue;
      all[newer / kQuestionInterval].push_back({newer, older, direction, score});
    }
    for (auto& candidates : all) candidates = spaced(std::move(candidates), count);
    return all;
  }

 private:
  const PlaceLog& log_;
  const NgramRecognizer& recognizer_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, Direction>, double> found_;
};

/// `made`: becomes the number of words of the log, if not null.
inline Candidates byWords(const CandidateOptions& o, const PlaceLog& log, const std::string& method,
                          std::size_t* made = nullptr) {
  const auto [words, observations] = wordParams(method);
  RecognitionOptions source;
  source.logs = {log.path};
  source.bag_options = log.bag_options;
  source.observations = observations;
  NgramRecognizer recognizer(words);
  std::vector<NgramMatch> matches;
  feed(source, recognizer, [&](const NgramRecognizerUpdate& u) {
    if (u.requantised) matches.clear();
    matches.insert(matches.end(), u.matches.begin(), u.matches.end());
  });
  if (made != nullptr) *made = recognizer.text().positions();
  WordCandidates found(log, recognizer);
  for (const NgramMatch& m : matches) found.add(m);
  return found.candidates(o.told());
}

}  // namespace ngram_slam
