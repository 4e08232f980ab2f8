// Training data of a classifier of regions: features of regions and their true classes.
#pragma once

#include <string>
#include <vector>

#include "ngram_slam/semantics/semantic_class.hpp"
#include "ngram_slam/semantics/semantic_features.hpp"

namespace ngram_slam {

struct SemanticExample {
  SemanticFeatures features;
  SemanticClass semantic_class = SemanticClass::kCorridor;
};

/// A table (CSV): the names of the features and "class", then a line for each example. Numbers are
/// exact: they are read as the same.
std::string textOf(const std::vector<SemanticExample>& examples);

/// @throws hyselam::InputError for a file that is missing or no such table, or one of other
/// features.
std::vector<SemanticExample> readExamples(const std::string& path);

}  // namespace ngram_slam
