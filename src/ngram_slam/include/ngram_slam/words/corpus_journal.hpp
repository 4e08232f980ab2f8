// A corpus on the disk that grows with the run: saving costs what is new, not what there is.
#pragma once

#include <cstdint>
#include <string>

#include "ngram_slam/words/corpus.hpp"

namespace ngram_slam {

/// The file of a corpus (CorpusFile), and beside it, with the ending ".journal", what came since.
///
/// A saving appends one block and waits for the disk; a process that is killed meanwhile leaves a
/// block that is cut off, which the next one to load passes over: nothing before the last finished
/// saving is lost. When the journal outgrows the file, the file is written again as a whole,
/// replaced at once, and the journal starts empty.
///
/// Journal, numbers little-endian: "NGRAMJNL", version (u32), checksum of the file that it belongs
/// to (u32), CRC-32 of these 16 bytes (u32). Block: "BLCK", bytes of its body (u32), first
/// observation (u32), CRC-32 of these 12 bytes; body: numbers of observations, classes, bins (u32
/// each); per class: id (u32), mode, upper bound (f64); bins (u64); per observation: whether it
/// starts a run (u8), stamp, x, y, theta, soft, hard, full density (f64, NaN: undefined), frontiers
/// (u8); CRC-32 of the body.
class CorpusJournal {
 public:
  /// What loading found.
  struct Loaded {
    Corpus corpus;
    std::uint32_t blocks = 0;  ///< of the journal that were used
    std::string remark;  ///< about a journal that was cut off or belongs to another file; else ""
  };

  /// Nothing is read or written yet.
  explicit CorpusJournal(std::string path);

  /// Reads file and journal. A file that does not exist is an empty corpus.
  /// @throws hyselam::InputError as CorpusFile::load, and for a journal that is damaged elsewhere
  /// than at its end.
  Loaded load();
  /// Makes the disk equal to this corpus, which must have grown from the one loaded or saved last.
  /// Where file or journal were changed by others, the file is written again as a whole.
  /// @throws hyselam::InputError if it cannot be written; what was saved before is still there
  /// then.
  void save(const ObservationStore& observations, const DensityClasses& classes,
            const DensityHistogram& histogram);
  /// Writes the whole file whatever it holds; to be used where the corpus has not grown from it.
  void saveWhole(const ObservationStore& observations, const DensityClasses& classes,
                 const DensityHistogram& histogram);

  const std::string& path() const { return path_; }
  std::string journalPath() const { return path_ + ".journal"; }
  std::uint32_t saved() const { return saved_; }  ///< observations on the disk
  std::uint64_t fileBytes() const { return file_bytes_; }
  std::uint64_t journalBytes() const { return journal_bytes_; }

  /// A journal smaller than this is never worth a new file [bytes].
  static constexpr std::uint64_t kSmallJournal = 1 << 20;

 private:
  std::uint32_t readJournal(Loaded& loaded);
  void noteFile();
  bool asItWasLeft() const;

  std::string path_;
  bool known_ = false;  // what is on the disk
  std::uint32_t saved_ = 0;
  std::uint32_t file_checksum_ = 0;
  std::uint64_t file_bytes_ = 0, journal_bytes_ = 0;
};

}  // namespace ngram_slam
