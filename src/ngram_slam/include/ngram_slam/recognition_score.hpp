// How much of what was recognised is true, and how much of what is true was recognised, against
// reference poses of the observations.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_set>
#include <vector>

#include "ngram_slam/alignment.hpp"
#include "ngram_slam/observation.hpp"

namespace ngram_slam {

struct ScoreParams {
  double distance = 2.0;                  ///< two observations of one place are this near [m], > 0
  double heading = hyselam::radians(45);  ///< and look the same way by this much [rad], > 0
  std::uint32_t separation = 100;         ///< pairs with fewer observations between them in one run
                                          ///< are no recognition: neither right nor wrong
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Counts pairs of observations that a recogniser takes for one place.
///
/// A pair is true if the reference poses lie within `distance` and their headings within `heading`.
/// A revisit is an observation for which an earlier one would make a true pair; with headings that
/// differ by any amount it is a revisit in either direction. Observations without reference count
/// nowhere.
class RecognitionScore {
 public:
  /// `reference`: the pose of each observation in one common frame, if known; `run`: its run.
  /// @throws hyselam::ParameterError; std::invalid_argument for lists of different length.
  RecognitionScore(std::vector<std::optional<hyselam::Pose2>> reference,
                   std::vector<std::uint32_t> run, const ScoreParams& params = {});

  /// Takes a pair in, once. True if it is true; nothing if it does not count.
  std::optional<bool> add(std::uint32_t newer, std::uint32_t older);

  std::size_t pairs() const { return pairs_; }
  std::size_t truePairs() const { return true_pairs_; }
  std::size_t revisits() const { return revisits_; }  ///< same direction
  std::size_t revisitsAnyDirection() const { return revisits_any_; }
  /// Share of the pairs that are true; 1 without pairs.
  double precision() const;
  /// Share of the revisits that are near (within `reach` observations of) the newer end of a true
  /// pair.
  double recall(std::uint32_t reach = 0) const;
  double recallAnyDirection(std::uint32_t reach = 0) const;

 private:
  bool counts(std::uint32_t newer, std::uint32_t older) const;
  bool near(std::uint32_t a, std::uint32_t b) const;
  bool sameWay(std::uint32_t a, std::uint32_t b) const;
  void findRevisits();
  std::size_t recognised(const std::vector<char>& revisit, std::uint32_t reach) const;

  std::vector<std::optional<hyselam::Pose2>> reference_;
  std::vector<std::uint32_t> run_;
  ScoreParams params_;
  std::vector<char> revisit_, revisit_any_, recognised_;
  std::size_t revisits_ = 0, revisits_any_ = 0, pairs_ = 0, true_pairs_ = 0;
  std::unordered_set<std::uint64_t> seen_;
};

}  // namespace ngram_slam
