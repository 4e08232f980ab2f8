// A robot drives along a corridor, over a crossing, and on. The density of free space rises at the
// crossing, so the path is cut into three regions, which the shipped random forest classifies.
#include <cstdio>
#include <memory>

#include "ngram_slam/semantics/semantic_forest.hpp"
#include "ngram_slam/semantics/semantic_segmenter.hpp"

int main() {
  auto forest = std::make_shared<ngram_slam::SemanticForest>(ngram_slam::SemanticForest::shipped());
  ngram_slam::SemanticSegmenter segmenter({}, forest);
  const auto print = [](const std::vector<ngram_slam::SemanticRegion>& regions) {
    for (const ngram_slam::SemanticRegion& r : regions) {
      std::printf("observations %u to %u: %s\n", r.first, r.last, toString(r.semantic_class));
    }
  };
  ngram_slam::DensityObservation observation;  // one each 0.1 m
  for (int i = 0; i < 160; ++i) {
    const bool crossing = i >= 70 && i < 100;
    observation.soft = crossing ? 0.7 : 0.3;
    observation.frontiers = crossing ? 4 : 2;
    observation.base_in_odom.x = 0.1 * i;
    print(segmenter.add(observation));
  }
  print(segmenter.finish());
  return 0;
}
