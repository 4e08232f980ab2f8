#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_pose_graph/g2o_file.hpp"

namespace hyselam_pose_graph {
namespace {

using hyselam::testing::require;

/// A pose graph in g2o's format: refused, or sound, and written and read as the same. Aborts else.
void g2o(const std::uint8_t* data, std::size_t size) {
  static const hyselam::testing::FuzzFolder folder;
  PoseGraph graph;
  try {
    graph = readG2o(folder.put("graph.g2o", hyselam::testing::textOf(data, size)));
  } catch (const hyselam::InputError&) {
    return;
  }
  graph.validate();
  require(!graph.poses.empty());
  const std::string again = folder.path("again.g2o");
  writeG2o(again, graph);
  const PoseGraph same = readG2o(again);
  require(same.ids == graph.ids && same.edges.size() == graph.edges.size());
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    require(same.edges[i].from == graph.edges[i].from && same.edges[i].to == graph.edges[i].to);
  }
}

}  // namespace
}  // namespace hyselam_pose_graph

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace hyselam_pose_graph;  // NOLINT: its own targets
  return {{"g2o", g2o}};
}
