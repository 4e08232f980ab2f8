#include "ngram_slam/slam/told_graph.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/slam/input_checks.hpp"

namespace ngram_slam {

using hyselam::InputError;

namespace {

/// Changes with poses and loops; never 0.
std::uint64_t versionOf(const SlamEngine& engine) {
  return (static_cast<std::uint64_t>(engine.revision()) + 1) << 32 |
         static_cast<std::uint64_t>(engine.loops().size());
}

}  // namespace

GraphPart newGraphPart(const SlamEngine& engine, const std::string& map,
                       const GraphQuestion& question) {
  const std::vector<SlamKeyframe>& all = engine.keyframes();
  const bool known = question.map == map && question.keyframes <= all.size();
  GraphPart part;
  part.map = map;
  part.first = known ? question.keyframes : 0;
  const std::size_t left = all.size() - part.first;
  const std::size_t told =
      question.max_keyframes == 0 ? left : std::min<std::size_t>(left, question.max_keyframes);
  const auto begin = all.begin() + part.first;
  part.keyframes.assign(begin, begin + static_cast<std::ptrdiff_t>(told));
  const auto end = static_cast<int>(part.first + told);
  for (const hyselam_pose_graph::PoseEdge& e : engine.odometry()) {
    const int last = std::max(e.from, e.to);
    if (last >= static_cast<int>(part.first) && last < end) part.odometry.push_back(e);
  }
  part.complete = told == left;
  if (!part.complete) return part;
  part.version = versionOf(engine);
  part.changed = !known || part.version != question.version;
  if (part.changed) {
    for (const SlamKeyframe& k : all) part.poses.push_back(k.pose);
    part.loops = engine.loops();
    if (!known || question.version == 0) part.settled = engine.settled();
  }
  return part;
}

GraphQuestion ToldGraph::question(std::uint32_t max_keyframes) const {
  GraphQuestion question = known_;
  question.max_keyframes = max_keyframes;
  return question;
}

void ToldGraph::begin(const std::string& map) {
  known_ = {};
  known_.map = map;
  told_ = {};
}

/// Whether it is not what was asked for, but all of a map from the start.
bool ToldGraph::isAnew(const GraphPart& part) const {
  return part.map != known_.map || part.first < known_.keyframes;
}

/// The new keyframes, if they follow those that are known.
void ToldGraph::append(GraphPart* part, const std::string& source) {
  if (part->map.empty()) throw InputError(source, "map", "has no name");
  if (isAnew(*part)) begin(part->map);
  if (part->first != told_.keyframes.size()) {
    throw InputError(source, "first",
                     "is " + std::to_string(part->first) + ", but " +
                         std::to_string(told_.keyframes.size()) + " keyframes are known");
  }
  for (SlamKeyframe& k : part->keyframes) {
    const std::string place = "keyframe " + std::to_string(told_.keyframes.size());
    if (!k.scan) throw InputError(source, place, "has no scan");
    if (const char* reason = scanError(*k.scan)) throw InputError(source, place, reason);
    k.points = std::make_shared<const hyselam_scan_matching::SurfacePoints>(
        hyselam_scan_matching::surfacePoints(*k.scan, surface_));
    told_.scans.push_back({k.stamp, static_cast<int>(told_.keyframes.size()), {}});
    told_.keyframes.push_back(std::move(k));
  }
  told_.odometry.insert(told_.odometry.end(), part->odometry.begin(), part->odometry.end());
  known_.keyframes = static_cast<std::uint32_t>(told_.keyframes.size());
}

bool ToldGraph::add(GraphPart part, const std::string& source) {
  const std::uint64_t version = isAnew(part) ? 0 : known_.version;
  if (!isAnew(part) && part.complete && part.keyframes.empty() && !part.changed &&
      part.first == known_.keyframes && part.version == version && map_ == known_.map) {
    return false;  // nothing is new
  }
  try {
    append(&part, source);
    if (!part.complete) return false;
    if (part.changed) {
      if (part.poses.size() != told_.keyframes.size()) {
        throw InputError(source, "poses",
                         "are " + std::to_string(part.poses.size()) + " for " +
                             std::to_string(told_.keyframes.size()) + " keyframes");
      }
      for (std::size_t k = 0; k < part.poses.size(); ++k) told_.keyframes[k].pose = part.poses[k];
      told_.loops = std::move(part.loops);
      if (version == 0) told_.settled = std::move(part.settled);
    } else if (part.version != version && !told_.keyframes.empty()) {
      throw InputError(source, "poses", "of another version are not told");
    }
    told_.counters.scans = told_.scans.size();
    if (const char* reason = told_.error()) throw InputError(source, "", reason);
  } catch (const InputError&) {
    begin({});
    throw;
  }
  known_.version = part.version;
  map_ = known_.map;
  state_ = told_;
  return true;
}

}  // namespace ngram_slam
