// Where the path is cut into semantic regions (Maffei 2017, 6.4): where the density starts or
// stops to vary.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "hyselam_common/parameters.hpp"

namespace ngram_slam {

struct SemanticCutParams {
  int smoothing = 3;  ///< the mean filter takes this many observations on each side, 0..100
  /// The density varies once it differs by more than this from where it was steady or turned, (0,
  /// 1]
  double change_threshold = 0.025;
  /// It is steady once it keeps within this, in (0, change_threshold] ...
  double steady_tolerance = 0.012;
  int steady_length = 10;  ///< ... for so many observations, >= 2
  /// The border between two regions lies where the density has made this share of its rise from the
  /// lower level to the higher one, in (0, 1)
  double border_share = 0.6;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// A part of the path, [first, last], around a level at which the density was steady or turned.
struct SemanticCut {
  std::uint32_t first = 0;  ///< observation of the run
  std::uint32_t last = 0;
  double level = 0.0;            ///< smoothed density there
  bool steady = false;           ///< it stayed there; else it only turned, at a peak or in a trough
  std::optional<double> before;  ///< level of the cut before; empty at the start of a run
  std::optional<double> after;   ///< of the cut after, as known when it began; empty at the end
};

inline bool operator==(const SemanticCut& a, const SemanticCut& b) {
  return a.first == b.first && a.last == b.last && a.level == b.level && a.steady == b.steady &&
         a.before == b.before && a.after == b.after;
}

/// Cuts the densities of one run while they come in.
///
/// The density is steady at a level while it stays within `change_threshold` of it (of the mean of
/// all densities there). It then moves, and each time it turns back by more than `change_threshold`
/// the extreme is a level of its own (hysteresis: smaller wiggles are none); when it has kept
/// within `steady_tolerance` for `steady_length` observations, it is steady again. Between two
/// levels that follow each other lies one border. Cuts follow each other without gap and together
/// hold every observation of the run.
class SemanticCutter {
 public:
  /// @throws hyselam::ParameterError
  explicit SemanticCutter(const SemanticCutParams& params = {});
  /// Adds the density of the next observation, 0..1. Returns the cuts completed by it, in order.
  std::vector<SemanticCut> add(double density);
  /// Ends the run and returns the remaining cuts. The next observation has index 0 in a new run.
  std::vector<SemanticCut> finish();
  /// Minimum final length of the current cut [observations], whatever is observed next.
  std::uint32_t minLength() const { return (steady_ ? next_ : since_) - growing_.first; }

 private:
  void addSmoothed(double x, std::vector<SemanticCut>& out);
  void addLevel(double level, std::uint32_t begin, bool steady, std::vector<SemanticCut>& out);
  double at(std::uint32_t i) const { return moved_[i - since_]; }

  SemanticCutParams params_;
  std::deque<double> raw_;     // at most 2 * smoothing + 1: the window of the mean filter
  std::uint32_t raw_end_ = 0;  // densities seen
  std::uint32_t next_ = 0;     // smoothed densities seen
  SemanticCut growing_;        // around the last level reached; `last` is not kept up
  bool steady_ = false;        // the density has not left that level
  double sum_ = 0.0;           // of the densities while it is steady
  std::uint32_t count_ = 0;
  std::deque<double> moved_;   // smoothed densities since it moves
  std::uint32_t since_ = 0;    // observation of the first of them
  int direction_ = 1;          // of the move: up 1, down -1
  std::uint32_t extreme_ = 0;  // of the move so far
};

}  // namespace ngram_slam
