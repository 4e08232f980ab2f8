#include "shipped_forest.hpp"

#include "ngram_slam/semantics/semantic_forest.hpp"
#include "ngram_slam/semantics/way_forest.hpp"

namespace ngram_slam {

SemanticForest SemanticForest::shipped() {
  return parse(kShippedForest[0].text, "models/semantic_forest.txt");
}

WayForest WayForest::shipped() {
  return parse(kShippedForest[1].text, "models/way_forest.txt");
}

}  // namespace ngram_slam
