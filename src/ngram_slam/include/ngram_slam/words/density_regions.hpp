// Contiguous regions of one density class (Eq. 4.2, Alg. 4.2; differences from the
// thesis: docs/algorithms/words.md).
#pragma once

#include <cstdint>
#include <optional>

namespace ngram_slam {

/// Observations [begin, end) that count as one region.
struct DensityRegion {
  int density_class = 0;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::uint32_t size() const { return end - begin; }
};

inline bool operator==(const DensityRegion& a, const DensityRegion& b) {
  return a.density_class == b.density_class && a.begin == b.begin && a.end == b.end;
}

/// Segments the observations of one run into regions, incrementally.
///
/// A region starts where a class is observed `t_o` times in a row. A shorter sequence belongs to
/// the region before it (at the start of a run: to the first region), so that an interruption
/// shorter than `t_o` neither makes a region nor splits one. Successive regions differ in class,
/// and together they cover every observation of the run.
class DensityRegionBuilder {
 public:
  /// `t_o`: smallest number of observations that make a region. @throws hyselam::ParameterError
  /// unless >= 1. `begin`: index of the first observation.
  explicit DensityRegionBuilder(int t_o = 5, std::uint32_t begin = 0);

  /// The class of the next observation. Returns the region that has just become complete, if any.
  std::optional<DensityRegion> add(int density_class);
  /// Ends the run: the region that was growing, with what is pending; nothing if no class was ever
  /// seen `t_o` times in a row. The builder then expects a new run that follows.
  std::optional<DensityRegion> finish();
  /// The region that is growing, its pending end included.
  std::optional<DensityRegion> current() const;

 private:
  std::uint32_t t_o_;
  std::uint32_t next_;                   // index of the observation that comes next
  std::optional<DensityRegion> region_;  // the current region; `end` is not up to date
  std::uint32_t begin_;                  // of the run, or of the growing region
  int last_ = 0;                         // class seen last, since
  std::uint32_t last_begin_ = 0;
};

}  // namespace ngram_slam
