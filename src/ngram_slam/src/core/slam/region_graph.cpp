#include "ngram_slam/slam/region_graph.hpp"

#include <algorithm>
#include <set>
#include <tuple>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

namespace {

using hyselam::Pose2;

RegionGraph graphOf(const SlamEngine& engine, const std::vector<SemanticRegion>& regions) {
  const ObservationStore& observations = engine.recognizer().observations();
  const std::vector<Pose2> poses = observationPoses(engine);
  RegionGraph graph;
  std::vector<std::int32_t> node_of_keyframe(engine.keyframes().size(), -1);
  std::set<std::tuple<std::uint32_t, std::uint32_t, RegionEdge::Kind>> edges;
  for (const SemanticRegion& r : regions) {
    const auto id = static_cast<std::uint32_t>(graph.nodes.size());
    RegionNode n;
    n.first = r.first;
    n.last = r.last;
    n.stamp_begin = observations.stamp(r.first);
    n.stamp_end = observations.stamp(r.last);
    n.run = observations.runOf(r.first);
    n.pose = poses[r.first + (r.last - r.first) / 2];
    n.semantic_class = r.semantic_class;
    n.confidence = r.confidence;
    for (std::uint32_t i = r.first; i <= r.last; ++i) {
      if (i > r.first) n.length += distance(observations.pose(i - 1), observations.pose(i));
      node_of_keyframe[static_cast<std::size_t>(engine.keyframeOfObservation()[i])] =
          static_cast<std::int32_t>(id);
    }
    if (id > 0 && graph.nodes.back().run == n.run)
      edges.emplace(id - 1, id, RegionEdge::Kind::kConsecutive);
    graph.nodes.push_back(n);
  }
  for (const SlamLoop& l : engine.loops()) {
    const std::int32_t a = node_of_keyframe[static_cast<std::size_t>(l.older)];
    const std::int32_t b = node_of_keyframe[static_cast<std::size_t>(l.newer)];
    if (a < 0 || b < 0 || a == b || !isUsed(l)) continue;
    edges.emplace(static_cast<std::uint32_t>(std::min(a, b)),
                  static_cast<std::uint32_t>(std::max(a, b)), RegionEdge::Kind::kLoop);
  }
  for (const auto& [a, b, kind] : edges) graph.edges.push_back({a, b, kind});
  return graph;
}

}  // namespace

std::vector<Pose2> observationPoses(const SlamEngine& engine) {
  std::vector<Pose2> poses;
  for (const std::int32_t k : engine.keyframeOfObservation())
    poses.push_back(engine.keyframes()[static_cast<std::size_t>(k)].pose);
  return poses;
}

RegionGraph regionGraph(const SlamEngine& engine) {
  return graphOf(engine, semanticRegions(engine.recognizer().observations()));
}

RegionGraph regionGraph(const SlamEngine& engine, const std::vector<SemanticRegion>& regions) {
  return graphOf(engine, regions);
}

RegionGraph spacedGraph(const SlamEngine& engine, double spacing) {
  if (!(spacing > 0.0)) throw hyselam::ParameterError("spacing", spacing, "above 0");
  const ObservationStore& observations = engine.recognizer().observations();
  std::vector<SemanticRegion> pieces;
  for (const SemanticRegion& r : semanticRegions(observations)) {
    double path = 0.0;
    SemanticRegion piece = r;
    for (std::uint32_t i = r.first; i <= r.last; ++i) {
      if (i > piece.first) path += distance(observations.pose(i - 1), observations.pose(i));
      if (path < spacing && i < r.last) continue;
      piece.last = i;
      pieces.push_back(piece);
      piece.first = i + 1;
      path = 0.0;
    }
  }
  return graphOf(engine, pieces);
}

}  // namespace ngram_slam
