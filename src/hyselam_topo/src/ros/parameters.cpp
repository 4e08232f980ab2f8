#include "hyselam_topo/ros/parameters.hpp"

namespace hyselam_topo {
namespace {

using hyselam::ParamLoader;
using hyselam::Range;

void loadHeight(ParamLoader& loader, const std::string& name, std::optional<double>& value,
                const std::string& meaning) {
  if (!loader.isSet(name)) {
    loader.know(name);
    return;
  }
  double height = 0.0;
  loader.get(name, height, Range::between(-10000.0, 10000.0), meaning);
  value = height;
}

void loadOctomap(ParamLoader& loader, CompressionParams& p) {
  loadHeight(loader, "z_min", p.z_min, "[m] lower limit of what is pressed");
  loadHeight(loader, "z_max", p.z_max, "[m] upper limit");
  if (p.z_min && p.z_max && *p.z_max <= *p.z_min) {
    throw hyselam::ParameterError("z_max", *p.z_max, "greater than z_min");
  }
  int storey = -1;
  loader.get("storey", storey, Range::between(-1, 1000), "from 0 for the lowest; -1: the only one");
  if (storey >= 0) p.storey = storey;
  loader.get("floor_margin", p.floor_margin, Range::between(0.0, 10.0), "[m]");
  loader.get("ceiling_margin", p.ceiling_margin, Range::between(0.0, 10.0), "[m]");
  loader.get("max_free_height", p.max_free_height, Range::between(0.0, 100.0),
             "[m] a column with more free space is free");
  loader.get("min_occupied_height", p.min_occupied_height, Range::between(0.0, 100.0),
             "[m] else occupied with more than this");
}

}  // namespace

Gr2ToServerParams loadGr2ToParams(ParamLoader& loader) {
  Gr2ToServerParams p;
  using Mode = Gr2ToParams::Mode;
  loader.getEnum("mode", p.gr2to.mode, {{"default", Mode::kDefault}, {"thesis", Mode::kThesis}},
                 "how places are found");
  SegmentationParams& segmentation = p.gr2to.segmentation;
  loader.get("free_max", segmentation.free_max, Range::between(0, 99),
             "cells of 0 .. free_max are free");
  loader.get("working_resolution", segmentation.working_resolution, Range::between(0.01, 0.25),
             "[m] cells are joined or split to about this");
  loader.get("clutter", segmentation.clutter, Range::between(0.0, 2.0),
             "[m] obstacles up to this across do not part places");
  loader.get("smallest_place", segmentation.smallest_place, Range::between(0.0, 100.0), "[m^2]");
  loader.get("use_octomap", p.use_octomap, "input from the topic octomap, else from map");
  loadOctomap(loader, p.octomap);
  loader.get("partial_updates", p.partial_updates, Range::between(0, 1e6),
             "around changes only, before everything is looked at again; 0: always everything");
  loader.get("max_map_cells", p.max_map_cells, Range::between(1, 1e9), "a larger map is refused");
  p.octomap.max_cells = static_cast<std::size_t>(p.max_map_cells);
  loader.get("map_file", p.map_file, "topological map to begin with; empty: none");
  loader.get("marker_alpha", p.markers.alpha, Range::between(0.0, 1.0), "of the places");
  loader.get("diagnostic_period", p.diagnostic_period, Range::between(0.05, 60.0), "[s]");
  return p;
}

}  // namespace hyselam_topo
