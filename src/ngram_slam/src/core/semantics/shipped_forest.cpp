#include "shipped_forest.hpp"

#include "ngram_slam/semantics/semantic_forest.hpp"

namespace ngram_slam {

SemanticForest SemanticForest::shipped() {
  return parse(kShippedForest[0].text, "models/semantic_forest.txt");
}

}  // namespace ngram_slam
