#include "ngram_slam/region_graph.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace ngram_slam {

RegionGraph regionGraph(const std::vector<SemanticRegion>& regions,
                        const std::vector<SlamKeyframe>& keyframes,
                        const std::vector<SlamLoop>& loops,
                        const std::vector<std::int32_t>& keyframe_of_observation) {
  RegionGraph graph;
  // The region of each keyframe: one that is on the border of two belongs to the older.
  std::vector<int> region_of(keyframes.size(), -1);
  for (const SemanticRegion& region : regions) {
    if (region.last >= keyframe_of_observation.size() || region.first > region.last) continue;
    const auto id = static_cast<int>(graph.nodes.size());
    for (std::uint32_t o = region.first; o <= region.last; ++o) {
      int& owner = region_of[static_cast<std::size_t>(keyframe_of_observation[o])];
      if (owner < 0) owner = id;
    }
    const auto middle = static_cast<std::size_t>(
        keyframe_of_observation[region.first + (region.last - region.first) / 2]);
    graph.nodes.push_back({region, keyframes[middle].run, keyframes[middle].pose});
    if (id == 0) continue;
    const RegionNode& before = graph.nodes[static_cast<std::size_t>(id) - 1];
    if (before.run == graph.nodes.back().run)
      graph.links.push_back({static_cast<std::size_t>(id) - 1, static_cast<std::size_t>(id), false});
  }
  std::set<std::pair<int, int>> known;
  for (const SlamLoop& loop : loops) {
    if (loop.weight < 0.5) continue;
    const int a = region_of[static_cast<std::size_t>(loop.older)];
    const int b = region_of[static_cast<std::size_t>(loop.newer)];
    if (a < 0 || b < 0 || a == b) continue;
    if (known.insert(std::minmax(a, b)).second)
      graph.links.push_back({static_cast<std::size_t>(std::min(a, b)),
                             static_cast<std::size_t>(std::max(a, b)), true});
  }
  return graph;
}

}  // namespace ngram_slam
