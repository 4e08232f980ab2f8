// Finds earlier places by the signatures of some metres of way.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "ngram_slam/signatures/place_index.hpp"
#include "ngram_slam/words/density_word.hpp"

namespace ngram_slam {

struct PlaceRecognizerParams {
  int half_length = 4;        ///< places before and after one that are compared along with it
  int separation = 20;        ///< places of a run with fewer between them are not compared
  int max_candidates = 8;     ///< earlier places told for one
  int candidate_spacing = 6;  ///< of several as near as this the best is told [places]
  int shortlist = 60;         ///< places looked up for each of five of the way
  /// Longest chain of places before one that are compared along with it, see
  /// PlaceRecognizer::score(); 0: no chains, the mean over `half_length` decides.
  int chain_length = 0;
  double chain_decay = 0.9;  ///< weight of a place of a chain against the next one, (0, 1)

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// An earlier place that may be the same.
struct PlaceCandidate {
  std::uint32_t newer = 0, older = 0;
  Direction direction = Direction::kSame;  ///< in which the ways fit each other better
  double score = 0.0;                      ///< see PlaceRecognizer::score()
};

class PlaceRecognizer {
 public:
  /// `model` must outlive the recognizer. @throws hyselam::ParameterError
  PlaceRecognizer(const SignatureModel& model, const PlaceRecognizerParams& params = {});

  /// Adds the next place of the way; returns its number, counted from 0 over all runs.
  std::uint32_t add(const PlaceSignature& signature) { return index_.add(signature); }
  /// The next place begins another run.
  void endRun();

  const PlaceIndex& index() const { return index_; }
  /// Whether an older place may be the same by what else is known.
  using MayBe = std::function<bool(std::uint32_t older)>;
  /// The best candidates for a place, best first. It should be followed by `half_length` more.
  std::vector<PlaceCandidate> candidates(std::uint32_t place, const MayBe& may_be = {}) const;
  /// The same, compared with all earlier places.
  std::vector<PlaceCandidate> candidatesOfAll(std::uint32_t place, const MayBe& may_be = {}) const;
  /// The score of two places in one direction. Without chains the mean log of the ratio of
  /// likelihoods over the pairs of places as far before and after them as both ways reach.
  ///
  /// With chains the places are soft words and their likeliest n-gram counts: the sum over the
  /// places before and after, up to `chain_length` and `half_length`, for as long as it gains, each
  /// farther place weighing less by `chain_decay`. So n is counted in metres and in rarity: what is
  /// common adds little, and what contradicts ends the n-gram.
  double score(std::uint32_t newer, std::uint32_t older, Direction direction) const;
  /// First place of the run of a place, and the one behind its last.
  std::pair<std::uint32_t, std::uint32_t> runOf(std::uint32_t place) const;

 private:
  using Questions = std::vector<std::optional<PlaceIndex::Question>>;
  /// The places around one, each made ready to be compared, from before() before it on; none beyond
  /// the ends of its run.
  Questions questionsAround(std::uint32_t place) const;
  double score(const Questions& questions, std::uint32_t older, Direction direction) const;
  double chainScore(const std::vector<std::optional<double>>& pairs) const;
  int before() const { return std::max(params_.half_length, params_.chain_length); }
  /// The places that may be candidates are below this.
  std::uint32_t endOfOlder(std::uint32_t place) const;
  std::vector<PlaceCandidate> best(std::vector<PlaceCandidate> all) const;

  PlaceRecognizerParams params_;
  PlaceIndex index_;
  std::vector<std::uint32_t> run_begins_{0};
};

}  // namespace ngram_slam
