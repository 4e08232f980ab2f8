// Semantic regions, while the robot drives: observations in, classified regions out.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "ngram_slam/semantics/semantic_classifier.hpp"
#include "ngram_slam/semantics/semantic_cutter.hpp"
#include "ngram_slam/words/density_observation.hpp"

namespace ngram_slam {

/// The observations [first, last] and what they were made in.
struct SemanticRegion {
  std::uint32_t first = 0;  ///< counted from the first observation ever added, over all runs
  std::uint32_t last = 0;
  SemanticClass semantic_class = SemanticClass::kCorridor;
  double confidence = 1.0;  ///< 0..1
  SemanticFeatures features;
};

struct SemanticParams {
  SemanticCutParams cut;
  /// A trough between two higher regions joins them to one if it is shorter than this ...
  int min_gap = 8;  ///< [observations], >= 0
  /// ... or if the robot turns by more than `min_turn` in it and it is no longer than this: the
  /// inside of a wide corner.
  int max_bend = 30;                         ///< [observations], >= min_gap
  double min_turn = hyselam::radians(20.0);  ///< [rad], > 0
  /// Where bifurcations follow each other closely the density hardly falls between them, but the
  /// number of frontiers does: a region is divided where three or more frontiers, or fewer, are
  /// seen so many times in a row. 0: never, as in the thesis.
  int min_frontier_run = 6;  ///< [observations], >= 0
  /// Fewer frontiers at the rim of a region are no reason to divide it up to this length.
  int max_rim = 10;  ///< [observations], >= 0
  /// Where the density is steady and the robot turns by more than this, the bend is a region of its
  /// own. Infinite: never, as in the thesis.
  double bend_angle = hyselam::radians(45.0);  ///< [rad], > 0

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Cuts the path into regions and classifies each as soon as it is known where it ends. The same
/// observations give the same regions, whether they come one by one from a robot or from a file.
/// Regions follow each other without gap and hold every observation.
class SemanticSegmenter {
 public:
  /// Without a classifier: the decision tree with its defaults. @throws hyselam::ParameterError
  explicit SemanticSegmenter(const SemanticParams& params = {},
                             std::shared_ptr<const SemanticClassifier> classifier = nullptr);
  /// Adds an observation; returns the regions completed by it, in order (usually none).
  /// @throws hyselam::InputError for one that cannot be used; nothing is changed then.
  std::vector<SemanticRegion> add(const DensityObservation& observation);
  /// Ends the run and returns the remaining regions. The next observation starts a new run.
  std::vector<SemanticRegion> finish();

 private:
  struct Seen {
    float soft;
    std::uint8_t frontiers;
    hyselam::Pose2 pose;
    double heading;  // unwrapped
  };
  void addCut(const SemanticCut& cut, std::vector<SemanticRegion>& out);
  void closeRegion(std::vector<SemanticRegion>& out);
  std::vector<SemanticCut> divideAtFrontiers(const SemanticCut& cut) const;
  std::vector<SemanticCut> divideAtBend(const SemanticCut& cut) const;
  SemanticFeatures featuresOf(const SemanticCut& cut) const;
  double turnIn(std::uint32_t first, std::uint32_t last) const;

  SemanticParams params_;
  std::shared_ptr<const SemanticClassifier> classifier_;
  SemanticCutter cutter_;
  std::deque<Seen> seen_;  // of the run, from seen_begin_ on
  std::uint32_t seen_begin_ = 0;
  std::uint32_t run_begin_ = 0;         // observations of the runs before
  std::optional<SemanticCut> pending_;  // complete, but what follows may join it
  bool open_ = false;                   // its last part was a gap: what follows joins it
};

/// The regions of all runs, in order, by the decision tree. @throws hyselam::ParameterError
std::vector<SemanticRegion> semanticRegions(const ObservationStore& observations,
                                            const SemanticParams& params = {});

}  // namespace ngram_slam
