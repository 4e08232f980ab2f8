#include "ngram_slam/slam/slam_state_io.hpp"

#include <cmath>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"

namespace ngram_slam {

namespace {

using hyselam::InputError;
using hyselam::Pose2;

constexpr char kMagic[] = "NGRAMSLM";
constexpr std::uint32_t kFirstVersion = 1;
constexpr std::uint32_t kSettledVersion = 3;  // the first that has a settled map
constexpr std::uint32_t kRunsVersion = 4;     // the first in which each of its cells has a run
// Of loops in files that do not tell: LoopParams::near_min_surface_ratio and far_min_surface_ratio.
constexpr double kLeastFit = 0.85;
constexpr std::size_t kHeaderBytes = 20, kChecksumBytes = 4;
constexpr std::size_t kBodyBegin = kHeaderBytes + kChecksumBytes;

/// One description of each part for both directions: `Io` is Out or In.
class Out {
 public:
  explicit Out(hyselam::BinaryWriter* writer) : writer_(writer) {}
  template <typename... T>
  void numbers(const T&... values) {
    (writer_->put(values), ...);
  }
  /// Of a scan: any number, as none may be measured.
  void ranges(const std::vector<float>& values) {
    for (const float r : values) writer_->put(r);
  }
  void rangeMax(double value) { writer_->put(value); }
  void fit(double value) { writer_->put(value); }
  static bool hasSettled() { return true; }
  static bool hasRuns() { return true; }
  template <typename Values>
  void size(const Values& values, std::size_t) {
    writer_->put(static_cast<std::uint32_t>(values.size()));
  }

 private:
  hyselam::BinaryWriter* writer_;
};

/// Never reads beyond the end.
class In {
 public:
  In(const std::string& body, std::uint32_t version, const std::string& path)
      : reader_(body), version_(version), left_(body.size()), path_(path) {}
  template <typename... T>
  void numbers(T&... values) {
    (finite(values), ...);
  }
  void ranges(std::vector<float>& values) {
    for (float& r : values) get(r);
  }
  /// A laser may name no limit: infinite.
  void rangeMax(double& value) {
    get(value);
    if (std::isnan(value)) refuse("holds a scan whose largest range is not a number");
  }
  void fit(double& value) {
    value = kLeastFit;
    if (version_ > kFirstVersion) finite(value);
  }
  bool hasSettled() const { return version_ >= kSettledVersion; }
  bool hasRuns() const { return version_ >= kRunsVersion; }
  /// `bytes`: what each value takes at least.
  template <typename Values>
  void size(Values& values, std::size_t bytes) {
    std::uint32_t n = 0;
    get(n);
    if (n > left_ / bytes) refuse("counts more than it holds");
    values.resize(n);
  }
  std::size_t left() const { return left_; }
  std::size_t at() const { return reader_.at(); }
  /// @throws hyselam::InputError
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(path_, "byte " + std::to_string(kBodyBegin + reader_.at()), why);
  }

 private:
  template <typename T>
  void get(T& value) {
    if (sizeof(T) > left_) refuse("ends too early");
    left_ -= sizeof(T);
    if constexpr (std::is_same_v<T, bool>) {
      value = reader_.get<std::uint8_t>() != 0;
    } else {
      value = reader_.get<T>();
    }
  }
  template <typename T>
  void finite(T& value) {
    get(value);
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) refuse("holds a number that is not finite");
    }
  }

  hyselam::BinaryReader reader_;
  std::uint32_t version_;
  std::size_t left_;
  std::string path_;
};

template <typename Io, typename P>
void pose(Io& io, P& p) {
  io.numbers(p.x, p.y, p.theta);
}

template <typename Io, typename M>
void matrix(Io& io, M& m) {
  for (int r = 0; r < 3; ++r) io.numbers(m(r, 0), m(r, 1), m(r, 2));
}

template <typename Io, typename Scan>
void scan(Io& io, Scan& s) {
  io.numbers(s.stamp, s.angle_min, s.angle_increment, s.range_min);
  io.rangeMax(s.range_max);
  pose(io, s.laser_in_base);
  io.size(s.ranges, sizeof(float));
  io.ranges(s.ranges);
}

template <typename Io, typename K>
void keyframe(Io& io, K& k) {
  io.numbers(k.stamp);
  pose(io, k.odometry);
  pose(io, k.pose);
  io.numbers(k.path_length, k.run);
}

template <typename Io, typename L>
void loop(Io& io, L& l) {
  io.numbers(l.older, l.newer);
  pose(io, l.measured);
  matrix(io, l.information);
  io.numbers(l.source, l.far, l.inlier_ratio, l.weight);
  io.fit(l.fit);
}

template <typename Io, typename M>
void match(Io& io, M& m) {
  io.numbers(m.newer, m.older, m.stamp_newer, m.stamp_older, m.level, m.n, m.direction,
             m.probability, m.keyframe_newer, m.keyframe_older);
  pose(io, m.measured);
  io.numbers(m.tried, m.verified, m.accepted);
}

template <typename Io, typename C>
void counters(Io& io, C& c) {
  io.numbers(c.scans, c.matched, c.relocalized, c.weak_matches, c.odometry_jumps, c.optimizations);
  for (auto* kind : {&c.near, &c.far, &c.words}) {
    io.numbers(kind->tried, kind->verified, kind->accepted);
  }
}

/// Of what is read; what is written has it.
void setRun(std::uint32_t run, SettledCell* cell) {
  cell->run = run;
}
void setRun(std::uint32_t, const SettledCell*) {}

/// All but keyframes and corpus. The numbers: bytes of each at least.
template <typename Io, typename State>
void rest(Io& io, State& s) {
  io.size(s.scans, 36);
  for (auto& p : s.scans) {
    io.numbers(p.stamp, p.keyframe);
    pose(io, p.base_in_keyframe);
  }
  io.size(s.odometry, 104);
  for (auto& e : s.odometry) {
    io.numbers(e.from, e.to);
    pose(io, e.measured);
    matrix(io, e.information);
  }
  for (auto* loops : {&s.loops, &s.pending_loops}) {
    io.size(*loops, 122);
    for (auto& l : *loops) loop(io, l);
  }
  io.size(s.matches, 60);
  for (auto& m : s.matches) match(io, m);
  counters(io, s.counters);
  io.size(s.keyframe_of_observation, 4);
  for (auto& k : s.keyframe_of_observation) io.numbers(k);
  if (!io.hasSettled()) return;
  std::uint32_t run_of_all = 0;
  if (!io.hasRuns()) io.numbers(run_of_all);
  io.numbers(s.settled.cell);
  io.size(s.settled.cells, 28);
  for (auto& c : s.settled.cells) {
    io.numbers(c.keyframe, c.center.x, c.center.y, c.log_odds, c.visits, c.changes);
    if (io.hasRuns()) {
      io.numbers(c.run);
    } else {
      setRun(run_of_all, &c);
    }
  }
}

struct Body {
  std::uint32_t version;
  std::string text;
};

/// The body of a file, after its header and checksums were checked.
Body bodyOf(const std::string& text, const std::string& path) {
  const auto refuse = [&](const std::string& place, const std::string& reason) {
    throw InputError(path, place, reason);
  };
  if (text.compare(0, 8, kMagic) != 0) refuse("byte 0", "is no state of SLAM");
  if (text.size() < kBodyBegin) refuse("header", "ends too early (truncated)");
  hyselam::BinaryReader header(text);
  header.skip(8);
  const auto version = header.get<std::uint32_t>();
  const auto length = header.get<std::uint64_t>();
  if (version < kFirstVersion || version > SlamStateFile::kVersion) {
    refuse("header", hyselam::versionRefusal(std::to_string(version),
                                             {static_cast<int>(kFirstVersion),
                                              static_cast<int>(SlamStateFile::kVersion)}));
  }
  if (header.get<std::uint32_t>() != hyselam::checksumOf(text, 0, kHeaderBytes)) {
    refuse("header", "is damaged (wrong checksum)");
  }
  const std::size_t expected = kBodyBegin + length + kChecksumBytes;
  if (length > text.size() || text.size() != expected) {
    refuse("end", "has " + std::to_string(text.size()) + " bytes instead of " +
                      std::to_string(expected) + (text.size() < expected ? " (truncated)" : ""));
  }
  hyselam::BinaryReader tail(text);
  tail.skip(kBodyBegin + length);
  if (tail.get<std::uint32_t>() != hyselam::checksumOf(text, kBodyBegin, kBodyBegin + length)) {
    refuse("body", "is damaged (wrong checksum)");
  }
  return {version, text.substr(kBodyBegin, length)};
}

}  // namespace

void SlamStateFile::save(const std::string& path, const SlamState& state) {
  std::ostringstream stream;
  {
    hyselam::BinaryWriter w(stream);
    Out out(&w);
    out.size(state.keyframes, 0);
    for (const SlamKeyframe& k : state.keyframes) {
      keyframe(out, k);
      scan(out, *k.scan);
    }
    rest(out, state);
    std::ostringstream corpus;
    CorpusFile::write(corpus, state.corpus.observations, state.corpus.classes,
                      state.corpus.histogram);
    const std::string text = corpus.str();
    w.put(static_cast<std::uint64_t>(text.size()));
    w.putText(text.data(), text.size());
    w.putChecksum();
  }
  const std::string body = stream.str();
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    hyselam::BinaryWriter w(out);
    w.putText(kMagic, 8);
    w.put(kVersion);
    w.put(static_cast<std::uint64_t>(body.size() - kChecksumBytes));
    w.putChecksum();
    out.write(body.data(), static_cast<std::streamsize>(body.size()));
  });
}

SlamState SlamStateFile::load(const std::string& path,
                              const hyselam_scan_matching::SurfacePointParams& surface) {
  const auto [version, body] = bodyOf(hyselam::readTextFile(path), path);
  In in(body, version, path);
  SlamState state;
  in.size(state.keyframes, 100);
  for (SlamKeyframe& k : state.keyframes) {
    keyframe(in, k);
    hyselam::LaserScan s;
    scan(in, s);
    k.points = std::make_shared<const hyselam_scan_matching::SurfacePoints>(
        hyselam_scan_matching::surfacePoints(s, surface));
    k.scan = std::make_shared<const hyselam::LaserScan>(std::move(s));
  }
  rest(in, state);
  std::uint64_t corpus_bytes = 0;
  in.numbers(corpus_bytes);
  if (corpus_bytes != in.left()) in.refuse("the corpus has a wrong length");
  state.corpus = CorpusFile::parse(body.substr(in.at()), path);
  if (const char* reason = state.error()) throw InputError(path, "", reason);
  return state;
}

}  // namespace ngram_slam
