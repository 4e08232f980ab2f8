// The augmented topological map for rviz.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "hyselam_common/parameters.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct MapMarkerParams {
  bool places = true;   ///< the cells of each place in a color of its own
  bool names = true;    ///< the first confirmed word, else the first word, else kind and id
  bool walls = true;    ///< solid thick, glass thinner and blue, virtual thin and grey
  bool doors = true;    ///< real ones with their swing, closed ones red; virtual ones a dashed line
  bool graph = true;    ///< from the centre of a place through its doors to the next
  double alpha = 0.55;  ///< of the places, 0 .. 1

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Namespaces places, names, walls, doors, graph; the first marker deletes what was shown before.
/// Stamps are 0 (newest transform), because latched markers outlive the transforms of their time.
visualization_msgs::MarkerArray mapMarkers(const AugmentedTopologicalMap& map,
                                           const MapMarkerParams& params = {});

}  // namespace hyselam_topo
