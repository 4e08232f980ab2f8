#include "ngram_slam/slam/slam_state_io.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/errors.hpp"

namespace ngram_slam {

namespace {

using hyselam::InputError;
using hyselam::Pose2;

constexpr char kMagic[] = "NGRAMSLM";
constexpr std::size_t kHeaderBytes = 20;

/// One description of each part for both ways: `Io` is Out or In, values are put or got.
class Out {
 public:
  explicit Out(hyselam::BinaryWriter* writer) : writer_(writer) {}
  template <typename T>
  void number(const T& value) {
    writer_->put(value);
  }
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
  In(const std::string& body, const std::string& path)
      : reader_(body), left_(body.size()), path_(path) {}
  template <typename T>
  void number(T& value) {
    need(sizeof(T));
    if constexpr (std::is_same_v<T, bool>)
      value = reader_.get<std::uint8_t>() != 0;
    else
      value = reader_.get<T>();
    if constexpr (std::is_floating_point_v<T>)
      if (!may_be_anything_ && !std::isfinite(value)) refuse("holds a number that is not finite");
  }
  /// `bytes`: what each takes at least.
  template <typename Values>
  void size(Values& values, std::size_t bytes) {
    std::uint32_t n = 0;
    number(n);
    if (n > left_ / bytes) refuse("counts more than it holds");
    values.resize(n);
  }
  void need(std::size_t bytes) {
    if (bytes > left_) refuse("ends too early");
    left_ -= bytes;
  }
  std::size_t left() const { return left_; }
  std::size_t at() const { return reader_.at(); }
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(path_, "byte " + std::to_string(kHeaderBytes + 4 + reader_.at()), why);
  }
  void anything(bool yes) { may_be_anything_ = yes; }

 private:
  hyselam::BinaryReader reader_;
  std::size_t left_;
  std::string path_;
  bool may_be_anything_ = false;
};

template <typename Io, typename P>
void pose(Io& io, P& p) {
  io.number(p.x);
  io.number(p.y);
  io.number(p.theta);
}

template <typename Io, typename M>
void matrix(Io& io, M& m) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) io.number(m(r, c));
}

void rangeMax(Out& io, const hyselam::LaserScan& s) {
  io.number(s.range_max);
}
void rangeMax(In& io, hyselam::LaserScan& s) {
  io.anything(true);  // a laser may name no limit: infinite
  io.number(s.range_max);
  io.anything(false);
  if (std::isnan(s.range_max)) io.refuse("holds a scan whose largest range is not a number");
}
void ranges(Out& io, const hyselam::LaserScan& s) {
  for (const float r : s.ranges) io.number(r);
}
void ranges(In& io, hyselam::LaserScan& s) {
  io.anything(true);  // a range may say that there is none
  for (float& r : s.ranges) io.number(r);
  io.anything(false);
}

template <typename Io, typename Scan>
void scan(Io& io, Scan& s) {
  io.number(s.stamp);
  io.number(s.angle_min);
  io.number(s.angle_increment);
  io.number(s.range_min);
  rangeMax(io, s);
  pose(io, s.laser_in_base);
  io.size(s.ranges, sizeof(float));
  ranges(io, s);
}

template <typename Io, typename K>
void keyframe(Io& io, K& k) {
  io.number(k.stamp);
  pose(io, k.odometry);
  pose(io, k.pose);
  io.number(k.way);
  io.number(k.run);
}

template <typename Io, typename L>
void loop(Io& io, L& l) {
  io.number(l.older);
  io.number(l.newer);
  pose(io, l.measured);
  matrix(io, l.information);
  io.number(l.source);
  io.number(l.far);
  io.number(l.matched);
  io.number(l.weight);
}

template <typename Io, typename M>
void match(Io& io, M& m) {
  io.number(m.newer);
  io.number(m.older);
  io.number(m.stamp_newer);
  io.number(m.stamp_older);
  io.number(m.level);
  io.number(m.n);
  io.number(m.direction);
  io.number(m.probability);
  io.number(m.keyframe_newer);
  io.number(m.keyframe_older);
  pose(io, m.measured);
  io.number(m.tried);
  io.number(m.verified);
  io.number(m.accepted);
}

template <typename Io, typename C>
void counters(Io& io, C& c) {
  io.number(c.scans);
  io.number(c.matched);
  io.number(c.searched);
  io.number(c.weak);
  io.number(c.leaps);
  io.number(c.optimisations);
  for (auto* kind : {&c.near, &c.far, &c.words}) {
    io.number(kind->tried);
    io.number(kind->verified);
    io.number(kind->accepted);
  }
}

/// All but keyframes and corpus.
template <typename Io, typename State>
void rest(Io& io, State& s) {
  io.size(s.scans, 36);
  for (auto& p : s.scans) {
    io.number(p.stamp);
    io.number(p.keyframe);
    pose(io, p.base_in_keyframe);
  }
  io.size(s.odometry, 104);
  for (auto& e : s.odometry) {
    io.number(e.from);
    io.number(e.to);
    pose(io, e.measured);
    matrix(io, e.information);
  }
  for (auto* loops : {&s.loops, &s.waiting}) {
    io.size(*loops, 122);
    for (auto& l : *loops) loop(io, l);
  }
  io.size(s.matches, 60);
  for (auto& m : s.matches) match(io, m);
  counters(io, s.counters);
  io.size(s.keyframe_of_observation, 4);
  for (auto& k : s.keyframe_of_observation) io.number(k);
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
    w.put(static_cast<std::uint64_t>(body.size() - 4));
    w.putChecksum();
    out.write(body.data(), static_cast<std::streamsize>(body.size()));
  });
}

SlamState SlamStateFile::load(const std::string& path,
                              const hyselam_scan_matching::SurfacePointParams& surface) {
  const std::string text = hyselam::readTextFile(path);
  const auto refuse = [&](const std::string& place, const std::string& reason) {
    throw InputError(path, place, reason);
  };
  if (text.compare(0, 8, kMagic) != 0) refuse("byte 0", "is no state of SLAM");
  if (text.size() < kHeaderBytes + 4) refuse("header", "ends too early (truncated)");
  hyselam::BinaryReader header(text);
  header.skip(8);
  const auto version = header.get<std::uint32_t>();
  const auto length = header.get<std::uint64_t>();
  if (version != kVersion)
    refuse("version", "is " + std::to_string(version) + ", but only " + std::to_string(kVersion) +
                          " is known");
  if (header.get<std::uint32_t>() != hyselam::checksumOf(text, 0, kHeaderBytes))
    refuse("header", "is damaged (wrong checksum)");
  const std::size_t begin = kHeaderBytes + 4, expected = begin + length + 4;
  if (length > text.size() || text.size() != expected)
    refuse("end", "has " + std::to_string(text.size()) + " bytes instead of " +
                      std::to_string(expected) + (text.size() < expected ? " (truncated)" : ""));
  hyselam::BinaryReader tail(text);
  tail.skip(begin + length);
  if (tail.get<std::uint32_t>() != hyselam::checksumOf(text, begin, begin + length))
    refuse("body", "is damaged (wrong checksum)");

  const std::string body = text.substr(begin, length);
  In in(body, path);
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
  in.number(corpus_bytes);
  if (corpus_bytes != in.left()) in.refuse("the corpus has a wrong length");
  state.corpus = CorpusFile::parse(body.substr(in.at()), path);
  try {
    state.validate();
  } catch (const std::invalid_argument& e) {
    throw InputError(path, "", e.what());
  }
  return state;
}

}  // namespace ngram_slam
