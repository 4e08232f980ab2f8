// Finds earlier places by the signatures of some metres of way.
#pragma once

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

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// An earlier place that may be the same.
struct PlaceCandidate {
  std::uint32_t newer = 0, older = 0;
  Direction direction = Direction::kSame;  ///< in which the ways fit each other better
  double score = 0.0;                      ///< mean log of the ratio of likelihoods along the way
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
  /// The score of two places in one direction: over the pairs of places as far before and after
  /// them as both ways reach.
  double score(std::uint32_t newer, std::uint32_t older, Direction direction) const;
  /// First place of the run of a place, and the one behind its last.
  std::pair<std::uint32_t, std::uint32_t> runOf(std::uint32_t place) const;

 private:
  /// The places around one, each made ready to be compared; none beyond the ends of its run.
  std::vector<std::optional<PlaceIndex::Question>> questionsAround(std::uint32_t place) const;
  double score(const std::vector<std::optional<PlaceIndex::Question>>& questions,
               std::uint32_t older, Direction direction) const;
  /// The places that may be candidates are below this.
  std::uint32_t endOfOlder(std::uint32_t place) const;
  std::vector<PlaceCandidate> best(std::vector<PlaceCandidate> all) const;

  PlaceRecognizerParams params_;
  PlaceIndex index_;
  std::vector<std::uint32_t> run_begins_{0};
};

}  // namespace ngram_slam
