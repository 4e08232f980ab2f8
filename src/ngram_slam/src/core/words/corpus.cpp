#include "ngram_slam/words/corpus.hpp"

#include <cmath>
#include <functional>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"

namespace ngram_slam {
namespace {

using hyselam::InputError;

constexpr char kMagic[] = "NGRAMTXT";
constexpr int kVersion = 2;
constexpr std::size_t kHeaderBytes = 28;

}  // namespace

void CorpusFile::save(const std::string& path, const Corpus& corpus) {
  save(path, corpus.observations, corpus.classes, corpus.histogram);
}

void CorpusFile::save(const std::string& path, const ObservationStore& o,
                      const DensityClasses& classes, const DensityHistogram& histogram) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { write(out, o, classes, histogram); });
}

void CorpusFile::write(std::ostream& out, const ObservationStore& o, const DensityClasses& classes,
                       const DensityHistogram& histogram) {
  hyselam::BinaryWriter w(out);
  w.putText(kMagic, 8);
  w.put(static_cast<std::uint32_t>(kVersion));
  w.put(o.runs());
  w.put(o.size());
  w.put(static_cast<std::uint32_t>(classes.list().size()));
  w.put(static_cast<std::uint32_t>(histogram.size()));
  w.putChecksum();
  for (const auto& run : o.runs_) {
    w.put(run.begin);
    w.put(run.x);
    w.put(run.y);
  }
  for (const DensityClass& c : classes.list()) {
    w.put(static_cast<std::uint32_t>(c.id));
    w.put(c.mode);
    w.put(c.upper);
  }
  w.putAll(histogram);
  w.putAll(o.stamps_);
  w.putAll(o.x_);
  w.putAll(o.y_);
  w.putAll(o.theta_);
  w.putAll(o.soft_);
  w.putAll(o.hard_);
  w.putAll(o.full_);
  w.putAll(o.frontiers_);
  w.putChecksum();
}

Corpus CorpusFile::load(const std::string& path) {
  return parse(hyselam::readTextFile(path), path);
}

namespace {

/// The numbers of the header, checked.
struct Sizes {
  std::uint32_t runs, observations, classes, bins;
};

using Refuse = std::function<void(const std::string& place, const std::string& reason)>;

/// Reads the header and checks that the whole file fits it.
Sizes readHeader(const std::string& text, hyselam::BinaryReader& r, const Refuse& refuse) {
  if (text.compare(0, 8, kMagic) != 0) refuse("byte 0", "is no corpus of words");
  if (text.size() < kHeaderBytes + 4) refuse("header", "ends too early (truncated)");
  r.skip(8);
  const auto version = r.get<std::uint32_t>();
  if (version != kVersion) {
    refuse("header", hyselam::versionRefusal(std::to_string(version), {kVersion, kVersion}));
  }
  Sizes n{};
  n.runs = r.get<std::uint32_t>();
  n.observations = r.get<std::uint32_t>();
  n.classes = r.get<std::uint32_t>();
  n.bins = r.get<std::uint32_t>();
  if (r.get<std::uint32_t>() != hyselam::checksumOf(text, 0, kHeaderBytes)) {
    refuse("header", "is damaged (wrong checksum)");
  }
  if (n.classes < 1 || n.classes > 256) refuse("header", "has a number of classes outside 1..256");
  if (n.bins != 0 && n.bins != MeanShiftQuantizer::kBins) {
    refuse("header", "has a histogram of " + std::to_string(n.bins) + " bins");
  }
  if (n.runs > n.observations + 1ull) refuse("header", "has more runs than observations");
  // 64 bits hold the sum whatever the counts.
  const std::uint64_t body =
      20ull * n.runs + 20ull * n.classes + 8ull * n.bins + 27ull * n.observations;
  const std::uint64_t expected = kHeaderBytes + 4 + body + 4;
  if (text.size() != expected) {
    refuse("end", "has " + std::to_string(text.size()) + " bytes instead of " +
                      std::to_string(expected) + (text.size() < expected ? " (truncated)" : ""));
  }
  const std::size_t body_begin = r.at(), body_end = text.size() - 4;
  hyselam::BinaryReader tail(text);
  tail.skip(body_end);
  if (tail.get<std::uint32_t>() != hyselam::checksumOf(text, body_begin, body_end)) {
    refuse("body", "is damaged (wrong checksum)");
  }
  return n;
}

DensityClasses readClasses(std::uint32_t count, hyselam::BinaryReader& r, const Refuse& refuse) {
  std::vector<DensityClass> list;
  for (std::uint32_t i = 0; i < count; ++i) {
    DensityClass c;
    const auto id = r.get<std::uint32_t>();
    c.id = id > 255 ? 256 : static_cast<int>(id);
    c.mode = r.get<double>();
    c.upper = r.get<double>();
    list.push_back(c);
  }
  try {
    return DensityClasses(std::move(list));
  } catch (const hyselam::ParameterError& e) {
    refuse("classes", e.what());
    throw;
  }
}

}  // namespace

Corpus CorpusFile::parse(const std::string& text, const std::string& path) {
  const Refuse refuse = [&](const std::string& place, const std::string& reason) {
    throw InputError(path, place, reason);
  };
  hyselam::BinaryReader r(text);
  const Sizes n = readHeader(text, r, refuse);
  Corpus corpus;
  ObservationStore& o = corpus.observations;
  for (std::uint32_t i = 0; i < n.runs; ++i) {
    ObservationStore::Run run{};
    run.begin = r.get<std::uint32_t>();
    run.x = r.get<double>();
    run.y = r.get<double>();
    const bool in_order = i == 0 ? run.begin == 0 : run.begin > o.runs_.back().begin;
    if (!in_order || run.begin > n.observations ||
        (run.begin == n.observations && i + 1 < n.runs) || !std::isfinite(run.x) ||
        !std::isfinite(run.y)) {
      refuse("run " + std::to_string(i), "is out of order or not finite");
    }
    o.runs_.push_back(run);
  }
  if (n.observations > 0 && n.runs == 0) refuse("runs", "are missing");
  corpus.classes = readClasses(n.classes, r, refuse);
  r.getAll(corpus.histogram, n.bins);
  r.getAll(o.stamps_, n.observations);
  r.getAll(o.x_, n.observations);
  r.getAll(o.y_, n.observations);
  r.getAll(o.theta_, n.observations);
  r.getAll(o.soft_, n.observations);
  r.getAll(o.hard_, n.observations);
  r.getAll(o.full_, n.observations);
  r.getAll(o.frontiers_, n.observations);
  for (std::uint32_t i = 0; i < n.observations; ++i) {
    if (!std::isfinite(o.stamps_[i])) {
      refuse("observation " + std::to_string(i), "has a stamp that is not finite");
    }
    if (o.soft_[i] > ObservationStore::kDensitySteps) {
      refuse("observation " + std::to_string(i), "has a soft density above 1");
    }
  }
  return corpus;
}

}  // namespace ngram_slam
