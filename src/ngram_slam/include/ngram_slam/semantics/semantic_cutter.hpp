// Where the way is cut into regions of meaning (Maffei 2017, 6.4): where the density starts or
// stops to vary.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace ngram_slam {

struct SemanticCutParams {
  int smoothing = 3;     ///< the mean filter takes this many observations on each side, 0..100
  double leave = 0.025;  ///< density varies once it is this far from where it stood or turned, > 0
  double settled = 0.012;  ///< it stands once it keeps within this, in (0, leave] ...
  int settled_for = 10;    ///< ... for so many observations, >= 2
  double border = 0.6;  ///< the border between two regions lies where the density is this share of
                        ///< the way from the lower level to the higher one, in (0, 1)

  /// @throws hyselam::ParameterError
  void validate() const;
};

/// A piece of way [first, last] around a level at which the density stood or turned.
/// A piece of way [first, last] around a level at which the density stood or turned.
struct SemanticCut {
  std::uint32_t first = 0;  ///< observation of the run
  std::uint32_t last = 0;
  double level = 0.0;            ///< smoothed density there
  bool stands = false;           ///< it stayed there; else it only turned, at a peak or in a trough
  std::optional<double> before;  ///< level of the cut before; empty at the start of a run
  std::optional<double> after;   ///< of the cut after, as known when it began; empty at the end
};

inline bool operator==(const SemanticCut& a, const SemanticCut& b) {
  return a.first == b.first && a.last == b.last && a.level == b.level && a.stands == b.stands &&
         a.before == b.before && a.after == b.after;
}

/// Cuts the densities of one run while they come in.
///
/// The density stands at a level while it stays within `leave` of it (of the mean of all densities
/// there). It then moves, and each time it turns back by more than `leave` the extreme is a level
/// of its own (hysteresis: smaller wiggles are none); when it has kept within `settled` for
/// `settled_for` observations, it stands again. Between two levels that follow each other lies one
/// border. Cuts follow each other without gap and together hold every observation of the run.
class SemanticCutter {
 public:
  /// @throws hyselam::ParameterError
  explicit SemanticCutter(const SemanticCutParams& params = {});
  /// The density of the next observation, 0..1. Returns the cuts that are complete, in order.
  std::vector<SemanticCut> add(double density);
  /// Ends the run: the cuts that remain. What comes next is observation 0 of another run.
  std::vector<SemanticCut> finish();
  /// How many observations the cut that is growing holds at least, whatever comes.
  std::uint32_t grown() const { return (standing_ ? next_ : since_) - growing_.first; }

 private:
  void take(double x, std::vector<SemanticCut>& out);
  void reach(double level, std::uint32_t begin, bool stands, std::vector<SemanticCut>& out);
  double at(std::uint32_t i) const { return moved_[i - since_]; }

  SemanticCutParams params_;
  std::deque<double> raw_;     // at most 2 * smoothing + 1: the window of the mean filter
  std::uint32_t raw_end_ = 0;  // densities seen
  std::uint32_t next_ = 0;     // smoothed densities seen
  SemanticCut growing_;        // around the last level reached; `last` is not kept up
  bool standing_ = false;      // the density has not left that level
  double sum_ = 0.0;           // of the densities while it stands there
  std::uint32_t count_ = 0;
  std::deque<double> moved_;   // smoothed densities since it moves
  std::uint32_t since_ = 0;    // observation of the first of them
  int direction_ = 1;          // of the move: up 1, down -1
  std::uint32_t extreme_ = 0;  // of the move so far
};

}  // namespace ngram_slam
