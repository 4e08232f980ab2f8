// Which places were recognized, and how sure: the table and the sentence of slam_offline.
#pragma once

#include <iomanip>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/loop_confidence.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

/// How a loop came to be: each loop is of exactly one kind.
enum class LoopKind {
  kNear,  ///< the graph, or a start that was told, had the robot close by; the scans fit there
  kFar,   ///< the graph did not know: a wide search, accepted with others that agree
  kUnverified,  ///< words alone, without a comparison of scans (mode thesis)
  kSupposed,    ///< a start in a saved map that was told, and that no scan fits
  /// Between keyframes of the saved map that is gone on with, which does not tell more: near, a
  /// start, or composed of loops of any kind when keyframes were dropped.
  kSaved
};

/// `saved`: keyframes of the map that is gone on with, which are the first ones.
inline LoopKind kindOf(const SlamLoop& loop, std::size_t saved) {
  if (loop.far) return LoopKind::kFar;
  // No loop whose scans were compared is accepted without points on known surfaces.
  const bool compared = loop.inlier_ratio > 0.0;
  if (loop.source != LoopSource::kProximity) {
    return compared || loop.source != LoopSource::kNgram ? LoopKind::kNear : LoopKind::kUnverified;
  }
  if (static_cast<std::size_t>(loop.newer) < saved) return LoopKind::kSaved;
  return compared ? LoopKind::kNear : LoopKind::kSupposed;
}

inline const char* toString(LoopKind kind) {
  switch (kind) {
    case LoopKind::kNear:
      return "near";
    case LoopKind::kFar:
      return "far";
    case LoopKind::kUnverified:
      return "unverified";
    case LoopKind::kSupposed:
      return "supposed";
    case LoopKind::kSaved:
      return "saved";
  }
  return "";
}

/// What proposed the place: proximity (by the poses of the graph), words, signatures, or outline (a
/// far place at which what the robot sees was laid on the map by its shape alone); start and saved
/// for loops of these kinds.
inline const char* foundBy(const SlamLoop& loop, std::size_t saved) {
  const LoopKind kind = kindOf(loop, saved);
  if (kind == LoopKind::kSupposed) return "start";
  if (kind == LoopKind::kSaved) return "saved";
  switch (loop.source) {
    case LoopSource::kNgram:
      return "words";
    case LoopSource::kSignature:
      return "signatures";
    case LoopSource::kProximity:
      break;
  }
  return loop.far ? "outline" : "proximity";
}

/// near + far + unverified + supposed + saved == total, and
/// far == far_by_words + far_by_signatures + far_by_outline.
struct LoopCounts {
  std::size_t total = 0, near = 0, far = 0, unverified = 0, supposed = 0, saved = 0;
  std::size_t far_by_words = 0, far_by_signatures = 0, far_by_outline = 0;
  std::size_t near_by_words = 0;  ///< of the near ones
  std::size_t not_believed = 0;   ///< of all: not isUsed()

  LoopCounts(const std::vector<SlamLoop>& loops, std::size_t saved_keyframes)
      : total(loops.size()) {
    for (const SlamLoop& l : loops) {
      const LoopKind kind = kindOf(l, saved_keyframes);
      ++(kind == LoopKind::kNear         ? near
         : kind == LoopKind::kFar        ? far
         : kind == LoopKind::kUnverified ? unverified
         : kind == LoopKind::kSupposed   ? supposed
                                         : saved);
      if (kind == LoopKind::kFar) {
        ++(l.source == LoopSource::kNgram       ? far_by_words
           : l.source == LoopSource::kSignature ? far_by_signatures
                                                : far_by_outline);
      }
      if (kind == LoopKind::kNear && l.source == LoopSource::kNgram) ++near_by_words;
      if (!isUsed(l)) ++not_believed;
    }
  }
};

inline nlohmann::json toJson(const LoopCounts& c) {
  return {{"total", c.total},
          {"near", c.near},
          {"near_by_words", c.near_by_words},
          {"far", c.far},
          {"far_by_words", c.far_by_words},
          {"far_by_signatures", c.far_by_signatures},
          {"far_by_outline", c.far_by_outline},
          {"unverified", c.unverified},
          {"supposed", c.supposed},
          {"saved", c.saved},
          {"not_believed", c.not_believed}};
}

/// "82 places seen again: 69 nearby, 13 after a longer way (4 found by words, 0 by signatures, 9 by
/// their outline); 2 of them not believed".
inline std::string sentenceOf(const LoopCounts& c) {
  const auto text = [](std::size_t n) { return std::to_string(n); };
  if (c.total == 0) return "no place seen again";
  std::string all = text(c.total) + (c.total == 1 ? " place" : " places") +
                    " seen again: " + text(c.near) + " nearby, " + text(c.far) +
                    " after a longer way";
  if (c.far > 0) {
    all += " (" + text(c.far_by_words) + " found by words, " + text(c.far_by_signatures) +
           " by signatures, " + text(c.far_by_outline) + " by their outline)";
  }
  if (c.unverified > 0) all += ", " + text(c.unverified) + " by words that no scan verified";
  if (c.supposed > 0) all += ", " + text(c.supposed) + " where it was told to start";
  if (c.saved > 0) all += ", " + text(c.saved) + " within the saved map";
  return all + "; " + (c.not_believed == 0 ? "none" : text(c.not_believed)) +
         " of them not believed";
}

/// The probability that a far loop is right, by its fit and by all far loops close to it, those
/// that still wait for others too; nothing for other loops, of which none is known.
inline std::optional<double> probabilityOf(const SlamLoop& loop, const std::vector<SlamLoop>& far,
                                           const SlamEngine& engine) {
  if (!loop.far) return std::nullopt;
  return loopProbability(
      loop, companyOf(loop, far, engine.keyframes(), engine.connections(), engine.params().loop));
}

/// loops.csv: README.md names the columns. a is the newer end, as in matches.csv; believed:
/// isUsed().
/// @throws hyselam::InputError
inline void writeLoops(const std::string& path, const SlamEngine& engine,
                       std::size_t saved_keyframes) {
  std::vector<SlamLoop> far = engine.state().pending_loops;
  for (const SlamLoop& l : engine.loops()) {
    if (l.far) far.push_back(l);
  }
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "stamp_a,stamp_b,keyframe_a,keyframe_b,run_a,run_b,path_a,path_b,x,y,theta,kind,"
           "found_by,weight,believed,probability,inliers,fit\n";
    for (const SlamLoop& l : engine.loops()) {
      const SlamKeyframe& a = engine.keyframes()[static_cast<std::size_t>(l.newer)];
      const SlamKeyframe& b = engine.keyframes()[static_cast<std::size_t>(l.older)];
      out << std::setprecision(15) << a.stamp << ',' << b.stamp << std::setprecision(6) << ','
          << l.newer << ',' << l.older << ',' << a.run << ',' << b.run << ',' << a.path_length
          << ',' << b.path_length << ',' << l.measured.x << ',' << l.measured.y << ','
          << l.measured.theta << ',' << toString(kindOf(l, saved_keyframes)) << ','
          << foundBy(l, saved_keyframes) << ',' << l.weight << ',' << (isUsed(l) ? 1 : 0) << ','
          << probabilityOf(l, far, engine).value_or(-1.0) << ',' << l.inlier_ratio << ',' << l.fit
          << '\n';
    }
  });
}

}  // namespace ngram_slam
