#include "ngram_slam/words/corpus_journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <utility>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"

namespace ngram_slam {
namespace {

using hyselam::InputError;

constexpr char kMagic[] = "NGRAMJNL";
constexpr char kBlock[] = "BLCK";
constexpr int kVersion = 1;
constexpr std::size_t kHeader = 20, kBlockHeader = 16, kObservation = 58;

std::string reason() {
  return std::strerror(errno);
}

bool exists(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0;
}

/// [bytes]; 0 if there is none.
std::uint64_t sizeOf(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 ? static_cast<std::uint64_t>(info.st_size) : 0;
}

/// A file of the system that is closed in any case.
class File {
 public:
  File(const std::string& path, int flags) : path_(path), fd_(::open(path.c_str(), flags, 0644)) {
    if (fd_ < 0) throw InputError(path, "", "cannot be opened for writing: " + reason());
  }
  ~File() { ::close(fd_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void write(const std::string& bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t n = ::write(fd_, bytes.data() + at, bytes.size() - at);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) throw InputError(path_, "", "cannot be written: " + reason());
      at += static_cast<std::size_t>(n);
    }
  }
  void cut(std::uint64_t bytes) {
    if (::ftruncate(fd_, static_cast<off_t>(bytes)) != 0) {
      throw InputError(path_, "", "cannot be cut: " + reason());
    }
  }
  void toDisk() {
    if (::fsync(fd_) != 0) throw InputError(path_, "", "cannot be flushed: " + reason());
  }

 private:
  std::string path_;
  int fd_;
};

/// A new name in a folder lasts only once the folder is on the disk; some systems cannot do that.
void folderToDisk(const std::string& path) {
  const auto slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

/// The last bytes of the file of a corpus: the checksum of all that matters. 0 if there is none.
std::uint32_t checksumOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(4, '\0');
  if (!in.seekg(-4, std::ios::end) || !in.read(&bytes[0], 4)) return 0;
  return hyselam::BinaryReader(bytes).get<std::uint32_t>();
}

double orNan(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}
std::optional<double> unlessNan(double value) {
  return std::isnan(value) ? std::nullopt : std::optional<double>(value);
}

std::string headerFor(std::uint32_t file_checksum) {
  std::ostringstream out;
  hyselam::BinaryWriter w(out);
  w.putText(kMagic, 8);
  w.put(static_cast<std::uint32_t>(kVersion));
  w.put(file_checksum);
  w.putChecksum();
  return out.str();
}

std::string blockFrom(const ObservationStore& observations, const DensityClasses& classes,
                      const DensityHistogram& histogram, std::uint32_t from) {
  std::ostringstream body;
  hyselam::BinaryWriter w(body);
  w.put(observations.size() - from);
  w.put(static_cast<std::uint32_t>(classes.list().size()));
  w.put(static_cast<std::uint32_t>(histogram.size()));
  for (const DensityClass& c : classes.list()) {
    w.put(static_cast<std::uint32_t>(c.id));
    w.put(c.mode);
    w.put(c.upper);
  }
  w.putAll(histogram);
  for (std::uint32_t i = from; i < observations.size(); ++i) {
    const DensityObservation o = observations[i];
    w.put(static_cast<std::uint8_t>(observations.runBegin(observations.runOf(i)) == i));
    for (double v : {o.stamp, o.base_in_odom.x, o.base_in_odom.y, o.base_in_odom.theta, o.soft,
                     orNan(o.hard), orNan(o.full)}) {
      w.put(v);
    }
    w.put(static_cast<std::uint8_t>(o.frontiers));
  }
  w.putChecksum();
  const std::string text = body.str();
  std::ostringstream out;
  hyselam::BinaryWriter h(out);
  h.putText(kBlock, 4);
  h.put(static_cast<std::uint32_t>(text.size()));
  h.put(from);
  h.putChecksum();
  return out.str() + text;
}

/// Adds what a block holds. @throws hyselam::Error of any kind for values that cannot be.
void addBlock(const std::string& body, Corpus& corpus) {
  hyselam::BinaryReader r(body);
  const auto n = r.get<std::uint32_t>(), classes = r.get<std::uint32_t>(),
             bins = r.get<std::uint32_t>();
  const std::uint64_t expected =
      12ull + 20ull * classes + 8ull * bins + static_cast<std::uint64_t>(kObservation) * n + 4;
  if (body.size() != expected || classes > 256 ||
      (bins != 0 && bins != MeanShiftQuantizer::kBins)) {
    throw InputError("block", "", "has a wrong length");
  }
  std::vector<DensityClass> list;
  for (std::uint32_t i = 0; i < classes; ++i) {
    DensityClass c;
    c.id = static_cast<int>(r.get<std::uint32_t>());
    c.mode = r.get<double>();
    c.upper = r.get<double>();
    list.push_back(c);
  }
  DensityClasses known(std::move(list));
  DensityHistogram histogram;
  r.getAll(histogram, bins);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (r.get<std::uint8_t>() != 0) corpus.observations.startRun();
    DensityObservation o;
    o.stamp = r.get<double>();
    o.base_in_odom.x = r.get<double>();
    o.base_in_odom.y = r.get<double>();
    o.base_in_odom.theta = r.get<double>();
    o.soft = r.get<double>();
    o.hard = unlessNan(r.get<double>());
    o.full = unlessNan(r.get<double>());
    o.frontiers = r.get<std::uint8_t>();
    corpus.observations.append(o);
  }
  corpus.classes = std::move(known);
  corpus.histogram = std::move(histogram);
}

}  // namespace

CorpusJournal::CorpusJournal(std::string path) : path_(std::move(path)) {}

void CorpusJournal::noteFile() {
  file_bytes_ = sizeOf(path_);
  file_checksum_ = checksumOf(path_);
}

/// Whether what a block would be appended to is still there: someone may have removed or replaced
/// the file or the journal, or saved to it by another name.
bool CorpusJournal::asItWasLeft() const {
  return known_ && file_bytes_ > 0 && sizeOf(path_) == file_bytes_ &&
         checksumOf(path_) == file_checksum_ && sizeOf(journalPath()) >= journal_bytes_;
}

CorpusJournal::Loaded CorpusJournal::load() {
  Loaded loaded;
  known_ = false;
  if (exists(path_)) loaded.corpus = CorpusFile::load(path_);
  noteFile();
  journal_bytes_ = 0;
  if (exists(journalPath())) readJournal(loaded);
  saved_ = loaded.corpus.observations.size();
  known_ = true;
  return loaded;
}

std::uint32_t CorpusJournal::readJournal(Loaded& loaded) {
  const std::string path = journalPath();
  const std::string text = hyselam::readTextFile(path);
  if (text.size() < kHeader) {
    loaded.remark = path + ": is cut off before its first block";
    return 0;
  }
  hyselam::BinaryReader header(text);
  header.skip(8);
  const auto version = header.get<std::uint32_t>(), belongs_to = header.get<std::uint32_t>();
  if (text.compare(0, 8, kMagic) != 0) {
    throw InputError(path, "byte 0", "is no journal of a corpus");
  }
  if (version != kVersion) {
    throw InputError(path, "header",
                     hyselam::versionRefusal(std::to_string(version), {kVersion, kVersion}));
  }
  if (header.get<std::uint32_t>() != hyselam::checksumOf(text, 0, kHeader - 4)) {
    throw InputError(path, "header", "is damaged (wrong checksum)");
  }
  if (belongs_to != file_checksum_) {
    // The file was written anew and holds all of it, or it is another one.
    loaded.remark = path + ": belongs to another version of the corpus, not used";
    return 0;
  }
  std::size_t at = kHeader;
  while (at < text.size()) {
    const std::string place =
        "block " + std::to_string(loaded.blocks) + ", byte " + std::to_string(at);
    const auto cutOff = [&] {
      (loaded.remark = path).append(": ").append(place).append(": is cut off, not used");
    };
    if (text.size() - at < kBlockHeader) {
      cutOff();
      break;
    }
    hyselam::BinaryReader r(text);
    r.skip(at + 4);
    const auto bytes = r.get<std::uint32_t>(), first = r.get<std::uint32_t>();
    if (text.compare(at, 4, kBlock) != 0 ||
        r.get<std::uint32_t>() != hyselam::checksumOf(text, at, at + kBlockHeader - 4)) {
      throw InputError(path, place, "is damaged (wrong checksum)");
    }
    const std::size_t begin = at + kBlockHeader;
    if (text.size() - begin < bytes) {
      cutOff();
      break;
    }
    if (bytes < 16) throw InputError(path, place, "has a wrong length");
    hyselam::BinaryReader tail(text);
    tail.skip(begin + bytes - 4);
    if (tail.get<std::uint32_t>() != hyselam::checksumOf(text, begin, begin + bytes - 4)) {
      throw InputError(path, place, "is damaged (wrong checksum)");
    }
    if (first != loaded.corpus.observations.size()) {
      throw InputError(path, place, "does not follow what is before it");
    }
    try {
      addBlock(text.substr(begin, bytes), loaded.corpus);
    } catch (const std::exception& e) {
      throw InputError(path, place, e.what());
    }
    ++loaded.blocks;
    at = begin + bytes;
  }
  journal_bytes_ = at;
  return loaded.blocks;
}

void CorpusJournal::save(const ObservationStore& observations, const DensityClasses& classes,
                         const DensityHistogram& histogram) {
  const bool as_left = asItWasLeft();
  if (as_left && observations.size() == saved_) return;
  const bool append = as_left && observations.size() > saved_ &&
                      journal_bytes_ <= std::max(file_bytes_, kSmallJournal);
  if (!append) {
    saveWhole(observations, classes, histogram);
    return;
  }
  const std::string block = blockFrom(observations, classes, histogram, saved_);
  const bool fresh = journal_bytes_ == 0;
  File file(journalPath(), O_WRONLY | O_CREAT | O_APPEND);
  // What stands behind the last good block was cut off while it was written.
  file.cut(journal_bytes_);
  const std::string bytes = fresh ? headerFor(file_checksum_) + block : block;
  file.write(bytes);
  file.toDisk();
  if (fresh) folderToDisk(path_);
  journal_bytes_ += bytes.size();
  saved_ = observations.size();
}

void CorpusJournal::saveWhole(const ObservationStore& observations, const DensityClasses& classes,
                              const DensityHistogram& histogram) {
  CorpusFile::save(path_, observations, classes, histogram);
  // From here on the journal belongs to another version and would not be used.
  noteFile();
  ::unlink(journalPath().c_str());
  journal_bytes_ = 0;
  saved_ = observations.size();
  known_ = true;
}

}  // namespace ngram_slam
