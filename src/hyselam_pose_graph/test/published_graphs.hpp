// The published graphs of $HYSELAM_DATA/posegraphs and the lowest cost known of each.
#pragma once

namespace published_graphs {

struct Published {
  const char* name;
  double
      cost;  ///< sum of e^T Omega e, by Gauss-Newton from certified optima of the relaxed problem
};

constexpr Published kGraphs[] = {
    {"M3500", 137.91295},
    {"M3500a", 912.11501},
    {"M3500c", 2554.7324},
    {"manhattanOlson3500", 146.07661},
    {"manhattan_sesync", 3549.0368},
    {"city10000", 511.98516},
    {"intel", 45.004696},
    {"input_INTEL", 215.83024},
    {"MITb", 41.163269},
    {"CSAIL", 40.555129},
    {"FR079", 37.598468},
    {"ring", 11.163101},
    {"ais2klinik", 172.81558},
    {"kitti_00", 98.322012},
    {"kitti_02", 78.764327},
};

/// A solution counts as the best one below this part of the lowest cost.
constexpr double kReached = 1.001;

}  // namespace published_graphs
