#include "hyselam_topo/ros/gr2to_parameters.hpp"

#include "hyselam_gr2to/segmentation/border_model.hpp"

namespace hyselam_topo {

void Gr2ToServerParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  constexpr const char* kNotOffered = hyselam::ParameterVisitor::kNotOffered;
  visit.group("", gr2to);
  visit("border_model", border_model,
        "file of border trees, by train_borders, for mode default; empty: those of the package");
  visit("use_octomap", use_octomap, "input from the topic octomap, else from map");
  visit.group("", octomap,
              {{"max_height", kNotOffered},
               {"free_below", kNotOffered},
               {"occupied_from", kNotOffered},
               {"filter", kNotOffered},
               {"max_cells", kNotOffered}});
  visit("partial_updates", partial_updates, Range::between(0, 1e6), "",
        "around changes only, until the whole map is segmented again; 0: always the whole map");
  visit("max_map_cells", max_map_cells, Range::between(1, 1e9), "", "a larger map is refused");
  visit("map_file", map_file, "topological map to begin with; empty: none");
  visit.group("marker_", markers,
              {{"places", kNotOffered},
               {"names", kNotOffered},
               {"walls", kNotOffered},
               {"doors", kNotOffered},
               {"graph", kNotOffered}});
  visit("diagnostic_period", diagnostic_period, Range::between(0.05, 60.0), "s", "of /diagnostics");
}

void Gr2ToServerParams::validate() const {
  hyselam::checkParameters(*this);
  gr2to.validate();
  octomap.validate();
}

Gr2ToServerParams loadGr2ToParams(hyselam::ParamLoader& loader) {
  Gr2ToServerParams params;
  params.describe(loader);
  params.octomap.max_cells = static_cast<std::size_t>(params.max_map_cells);
  params.validate();
  if (!params.border_model.empty()) {
    params.gr2to.segmentation.border_model =
        std::make_shared<BorderModel>(BorderModel::load(params.border_model));
  }
  return params;
}

}  // namespace hyselam_topo
