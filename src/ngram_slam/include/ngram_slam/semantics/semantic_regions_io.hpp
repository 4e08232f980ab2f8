// Semantic regions as a table.
#pragma once

#include <string>
#include <vector>

#include "ngram_slam/semantics/semantic_segmenter.hpp"

namespace ngram_slam {

/// Writes regions.csv: `first,last,stamp_begin,stamp_end,class,confidence`, replacing the file at
/// once. `stamps`: of all observations [s]. @throws hyselam::InputError if it cannot be written;
/// hyselam::ParameterError for a region beyond the stamps.
void writeRegions(const std::string& path, const std::vector<SemanticRegion>& regions,
                  const std::vector<double>& stamps);

}  // namespace ngram_slam
