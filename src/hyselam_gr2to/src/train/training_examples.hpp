// Maps with known rooms, ready to learn from: given ones and floors of the simulator.
#pragma once

#include <string>
#include <vector>

#include "hyselam_gr2to/segmentation/place_segmentation.hpp"
#include "segmentation/region_adjacency_graph.hpp"

namespace hyselam_topo {

struct ExampleOptions {
  /// Folder with index.csv, maps and images of their rooms; empty: generated floors only.
  std::string data;
  std::vector<double> scales{1.0, 0.85, 1.2};  ///< at which each given map is used
  int plans = 24;                              ///< generated floors
  SegmentationParams segmentation;
};

/// A map at one scale, before any region was merged.
struct Example {
  std::string name;
  std::string kind;      ///< "unfurnished", "furnished", "robot", "generated"
  std::string building;  ///< all of a building are left out together
  bool scored = true;    ///< false: a changed copy of a map, for training only
  RegionAdjacencyGraph graph;
  std::vector<std::vector<int>> rooms;  ///< cells of [basin][room], room 0: none
};

struct TrainingData {
  std::vector<Example> examples;
  std::string summary;  ///< what they are, with checksums of maps and rooms, one line
};

/// Each given map at each scale, with 1 % noise and turned by 31 degrees; then the generated
/// floors.
/// @throws hyselam::InputError for a file that cannot be used or a map whose resolution is not near
/// the working resolution.
TrainingData loadExamples(const ExampleOptions& options);

}  // namespace hyselam_topo
