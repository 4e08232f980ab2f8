// Density classes (Maffei 2017, 4.2.1): uniform, or by mean shift over the histogram of all past
// observations, re-estimated as observations are added; ids of classes that remain are kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hyselam_common/parameters.hpp"

namespace ngram_slam {

/// One class: an interval of densities.
struct DensityClass {
  int id = 0;          ///< 0..255, as in words
  double mode = 0.0;   ///< its typical density
  double upper = 0.0;  ///< upper bound of the interval; its lower bound is that of the class before
};

/// A partition of [0, 1] into classes, in the order of their densities.
class DensityClasses {
 public:
  /// A single class for all densities.
  DensityClasses() : DensityClasses({{0, 0.5, 1.0}}) {}
  /// @throws hyselam::ParameterError unless ids are unique and in 0..255 and upper bounds grow; the
  /// last class takes all that is left, whatever its bound.
  explicit DensityClasses(std::vector<DensityClass> classes);
  /// `count` classes of equal width, ids 0, 1, ... @throws hyselam::ParameterError unless 1..256.
  static DensityClasses uniform(int count);

  /// The id of the class of a density in [0, 1].
  int classOf(double density) const;
  /// The same, but the class `before` is kept while the density lies within `hysteresis` of it.
  int classOf(double density, int before, double hysteresis) const;
  const std::vector<DensityClass>& list() const { return classes_; }

 private:
  std::vector<DensityClass> classes_;
};

/// Counts of densities in equal bins over [0, 1].
using DensityHistogram = std::vector<std::uint64_t>;

/// Mean shift with a Gaussian window (Cheng 1995): the bins that climb to the same mode.
struct DensityMode {
  double mode = 0.0;      ///< where they end
  std::size_t begin = 0;  ///< bins begin .. end - 1
  std::size_t end = 0;
  double share = 0.0;  ///< of all observations
};

/// The modes of a histogram, in order; together they hold every bin. In one dimension the basins of
/// mean shift are the stretches between the minima of the smoothed histogram, so these are sought.
/// Modes of less than `min_share` join the neighbour on the higher pass.
/// @throws hyselam::ParameterError unless bandwidth > 0 and there are 2 bins or more. An empty
/// histogram has no modes.
std::vector<DensityMode> densityModes(const DensityHistogram& histogram, double bandwidth,
                                      double min_share = 0.0);

/// A bandwidth from the data: of all numbers of modes up to `max_modes` the one that persists
/// longest while the window widens from 0.006 to 0.1 (in its logarithm); the geometric mean of the
/// ends of that interval.
double bandwidthOf(const DensityHistogram& histogram, double min_share, int max_modes);

struct MeanShiftParams {
  double bandwidth = 0.0;  ///< sigma of the window, in densities; 0: from the data
  double min_share =
      0.02;  ///< of the observations; weaker modes are no class of their own, [0, 0.5]
  double tolerance = 0.02;      ///< classes change when a mode or bound has moved farther, > 0
  int max_classes = 12;         ///< for a bandwidth from the data, 1..64
  int uniform_classes = 8;      ///< classes before the first estimate, 1..256
  int first_update = 500;       ///< observations before the first estimate, >= 1
  double update_growth = 1.25;  ///< factor of observations until the next estimate, > 1

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Learns classes from densities.
class MeanShiftQuantizer {
 public:
  explicit MeanShiftQuantizer(const MeanShiftParams& params = {});

  /// Counts a density in [0, 1]; at growing intervals checks whether the classes still fit. True if
  /// they have changed: all words must be built again then.
  bool add(double density);
  /// Checks now. True if the classes have changed.
  bool update();

  const DensityClasses& classes() const { return classes_; }
  const DensityHistogram& histogram() const { return histogram_; }
  std::uint64_t count() const { return count_; }
  /// Goes on from a saved state; as many bins as histogram() has. @throws hyselam::ParameterError
  void restore(const DensityClasses& classes, const DensityHistogram& histogram);

  static constexpr std::size_t kBins = 256;

 private:
  MeanShiftParams params_;
  DensityClasses classes_;
  bool learnt_ = false;
  DensityHistogram histogram_;
  std::uint64_t count_ = 0;
  std::uint64_t next_update_;
};

/// Gives the new modes ids: a mode keeps the id of an old one if it lies within `reach` of it,
/// the nearest pairs first; others get the smallest ids that are free.
std::vector<DensityClass> classesOf(const std::vector<DensityMode>& modes, std::size_t bins,
                                    const std::vector<DensityClass>& old, double reach);

}  // namespace ngram_slam
