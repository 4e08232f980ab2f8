// Precision and recall of recognized places, evaluated with reference poses of the observations.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_set>
#include <vector>

#include "ngram_slam/words/density_observation.hpp"
#include "ngram_slam/words/density_word.hpp"

namespace ngram_slam {

struct ScoreParams {
  double distance = 2.0;                  ///< two observations of one place are this near [m], > 0
  double heading = hyselam::radians(45);  ///< and look the same way, or opposite ways where a match
                                          ///< in reverse is meant, by this much [rad], in (0, pi/2]
  std::size_t separation = 100;           ///< pairs with fewer observations between them in one run
                                          ///< are no recognition: neither right nor wrong
  std::size_t pass_gap = 20;              ///< observations between two passes at least, >= 1
  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Ground truth of place recognition, from reference poses.
///
/// A pair of observations is true if the reference poses lie within `distance` and their headings
/// differ by at most `heading` (kSame), or by at least pi - `heading` (kReverse). Observations
/// without reference count nowhere.
class RecognitionTruth {
 public:
  /// One earlier passage of the robot: consecutive earlier observations (with gaps below
  /// `pass_gap`) that form true pairs with one later observation. On one line in a similarity
  /// matrix (Fig. 4.11).
  struct Pass {
    std::uint32_t first = 0, last = 0;
    Direction direction = Direction::kSame;
  };

  /// `reference`: the pose of each observation in one common frame, if known; `run`: its run.
  /// @throws hyselam::ParameterError, also for lists of different length.
  RecognitionTruth(std::vector<std::optional<hyselam::Pose2>> reference,
                   std::vector<std::uint32_t> run, const ScoreParams& params = {});

  std::uint32_t size() const { return static_cast<std::uint32_t>(run_.size()); }
  const ScoreParams& params() const { return params_; }
  /// Whether a pair recognized with that direction is true. Nothing if it does not count.
  std::optional<bool> isTrue(std::uint32_t newer, std::uint32_t older, Direction direction) const;

  /// The passes of an observation: indices into passes() from begin to end; by direction, then
  /// time.
  std::size_t passesBegin(std::uint32_t i) const { return begin_[i]; }
  std::size_t passesEnd(std::uint32_t i) const { return begin_[i + 1]; }
  const std::vector<Pass>& passes() const { return passes_; }
  /// Does an earlier observation make a true pair with this one in the same direction?
  bool revisit(std::uint32_t i) const;
  /// In any direction: within `distance`, whatever the headings.
  bool revisitAnyDirection(std::uint32_t i) const { return any_[i] != 0; }

 private:
  bool counts(std::uint32_t newer, std::uint32_t older) const;
  bool near(std::uint32_t a, std::uint32_t b) const;
  bool headingsFit(std::uint32_t a, std::uint32_t b, Direction direction) const;
  void findPasses();

  std::vector<std::optional<hyselam::Pose2>> reference_;
  std::vector<std::uint32_t> run_;
  ScoreParams params_;
  std::vector<std::size_t> begin_;
  std::vector<Pass> passes_;
  std::vector<char> any_;
};

/// Precision and recall, and the counts from which they are computed.
struct RecognitionFigures {
  std::size_t pairs = 0, true_pairs = 0;
  std::size_t revisits = 0, recognized = 0;          ///< same direction
  std::size_t revisits_any = 0, recognized_any = 0;  ///< either direction
  std::size_t passes = 0, recognized_passes = 0;     ///< same direction
  std::size_t passes_any = 0, recognized_passes_any = 0;

  static double share(std::size_t part, std::size_t of, double of_nothing) {
    return of == 0 ? of_nothing : static_cast<double>(part) / static_cast<double>(of);
  }
  /// Share of the pairs that are true; 1 without pairs.
  double precision() const { return share(true_pairs, pairs, 1.0); }
  /// Share of the revisits that were recognized.
  double recall() const { return share(recognized, revisits, 0.0); }
  double recallAnyDirection() const { return share(recognized_any, revisits_any, 0.0); }
  /// Share of all passes of all revisits that were recognized, the stricter measure: after ten laps
  /// a revisit must be matched with each of them.
  double passRecall() const { return share(recognized_passes, passes, 0.0); }
  double passRecallAnyDirection() const { return share(recognized_passes_any, passes_any, 0.0); }
};

/// Counts pairs of observations that a recognizer identifies as one place.
class RecognitionScore {
 public:
  explicit RecognitionScore(std::shared_ptr<const RecognitionTruth> truth);

  /// Adds a pair; one that was added before changes nothing. True if it is true; nothing if
  /// it does not count.
  std::optional<bool> add(std::uint32_t newer, std::uint32_t older,
                          Direction direction = Direction::kSame);
  /// Figures of the observations with indices below `until` (and of the pairs of these).
  RecognitionFigures figures(std::uint32_t until = 0xffffffff) const;
  const RecognitionTruth& truth() const { return *truth_; }
  /// Calls `use(newer, older, direction)` with every pair that counts, in no particular order.
  template <typename Use>
  void forEachPair(Use&& use) const {
    for (const std::uint64_t pair : seen_) {
      use(static_cast<std::uint32_t>(pair >> 32 & 0x7fffffff), static_cast<std::uint32_t>(pair),
          pair >> 63 != 0 ? Direction::kReverse : Direction::kSame);
    }
  }

 private:
  std::shared_ptr<const RecognitionTruth> truth_;
  std::vector<std::uint32_t> pairs_, true_pairs_;         // counts by newer observation
  std::vector<char> recognized_, recognized_any_, pass_;  // by observation, by pass
  std::unordered_set<std::uint64_t> seen_;
};

}  // namespace ngram_slam
