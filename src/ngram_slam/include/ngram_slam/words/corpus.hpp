// The data that are saved: all observations of all runs and the density classes. Words, levels and
// the index are computed from them again after loading.
#pragma once

#include <ostream>
#include <string>

#include "ngram_slam/words/density_observation.hpp"
#include "ngram_slam/words/quantizer.hpp"

namespace ngram_slam {

struct Corpus {
  ObservationStore observations;
  DensityClasses classes;
  DensityHistogram histogram;  ///< of MeanShiftQuantizer; empty for fixed classes
};

/// Reads and writes corpora. Format, version 2, all numbers little-endian: "NGRAMTXT", version
/// (u32), numbers of runs, observations, classes, bins (u32 each), CRC-32 of these 28 bytes (u32);
/// then the body: per run: first observation (u32), position [m] of it (2 x f64); per class: id
/// (u32), mode, upper bound (f64); bins (u64); then the columns of the observations: stamps [s]
/// (f64), x, y [0.1 mm from the run's first], theta [pi / (2^31 - 1)] (i32), soft, hard, full
/// density [1/65534; 65535: undefined] (u16), frontiers (u8); CRC-32 of the body (u32). Version 1
/// had no full density.
class CorpusFile {
 public:
  /// Replaces the file atomically: if the process is killed while saving, the old file remains.
  /// @throws hyselam::InputError if it cannot be written.
  static void save(const std::string& path, const Corpus& corpus);
  static void save(const std::string& path, const ObservationStore& observations,
                   const DensityClasses& classes, const DensityHistogram& histogram);
  /// @throws hyselam::InputError, naming the place and the reason, for a file that is no corpus, of
  /// another version, cut off, damaged, or that holds values out of range.
  static Corpus load(const std::string& path);

  /// The same as part of another file; `name` begins the errors of parse().
  static void write(std::ostream& out, const ObservationStore& observations,
                    const DensityClasses& classes, const DensityHistogram& histogram);
  static Corpus parse(const std::string& text, const std::string& name);
};

}  // namespace ngram_slam
