// Where, how large and in which lines the name of a place is written so that it stays within the
// place, seen from above with x to the right.
#pragma once

#include <string>

#include "hyselam_topological_map/place_paths.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct PlaceLabelParams {
  double min_height = 0.3;   ///< of a line [m], > 0; written even if it does not fit
  double max_height = 0.5;   ///< of a line [m], >= min_height
  double margin = 0.1;       ///< kept free around the text [m]
  double node_radius = 0.3;  ///< kept free around the center of the place, where its node is [m]
};

struct PlaceLabel {
  hyselam::Point2 position;  ///< middle of the block of text, map frame [m]
  double height = 0.0;       ///< of a line [m]
  std::string text;          ///< lines; the shorter ones are indented to the middle
};

/// Size of a block of lines whose height is 1, as rviz sets them: flush left, blanks as wide as an
/// A. To a tenth or so, because it does not see the font.
struct TextSize {
  double width = 0.0;
  double height = 0.0;
};
TextSize textSize(const std::string& text);

/// The label of a place with a centre. The largest height at which the text, broken at some of its
/// blanks, lies within the cells of the place and beside its node; there, as near above the node
/// as it can be. If it does not fit at the least height beside the node, it may reach over a border
/// without a wall, close to the node; else it may cover the node; if it does not fit even then, it
/// lies on the point deepest inside the place. Without cells it lies above the node.
/// `box`: the place's, of placeBoxes(); null: it has no cells. `code`: stands on a line of its own
/// or before the whole name; may be empty.
PlaceLabel placeLabel(const AugmentedTopologicalMap& map, const Place& place, const CellBox* box,
                      const std::string& code, const std::string& name,
                      const PlaceLabelParams& params = {});

}  // namespace hyselam_topo
