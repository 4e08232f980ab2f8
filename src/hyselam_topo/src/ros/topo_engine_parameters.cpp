#include "hyselam_topo/ros/topo_engine_parameters.hpp"

namespace hyselam_topo {

void TopoEngineParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("language", dialogue.language, Phrases::shippedLanguages(),
        "of the robot's first sentences");
  visit.group("", dialogue, {{"language", visit.kNotOffered}});
  visit.renamed("rate", "pose_rate");
  visit.renamed("object_patience", "object_answer_timeout");
  visit("base_frame", base_frame, "of the robot");
  visit("pose_rate", pose_rate, Range::between(0.1, 100.0), "Hz",
        "rate at which the robot's pose is looked up");
  visit("pose_timeout", pose_timeout, Range::between(0.05, 60.0), "s", "an older pose is ignored");
  visit("state_file", state_file, "kept across restarts; empty: nothing is kept");
  visit("use_move_base", use_move_base, "drive by the action move_base, where it is available");
  visit("max_map_cells", max_map_cells, Range::between(1, 1e9), "cells", "a larger map is refused");
  visit("max_text_bytes", max_text_bytes, Range::between(100, 1e7), "bytes",
        "a longer text is refused");
  visit("object_answer_timeout", object_answer_timeout, Range::between(0.1, 60.0), "s",
        "for the answer to a sentence about objects");
  visit("marker_alpha", markers.alpha, Range::between(0.0, 1.0), "", "opacity of the places");
  visit("diagnostic_period", diagnostic_period, Range::between(0.05, 60.0), "s",
        "between diagnostics");
}

void TopoEngineParams::validate() const {
  hyselam::checkParameters(*this);
  dialogue.validate();
  if (base_frame.empty()) throw hyselam::ParameterError("base_frame", "''", "a frame");
}

TopoEngineParams loadTopoEngineParams(hyselam::ParamLoader& loader) {
  TopoEngineParams params;
  params.describe(loader);
  params.validate();
  if (params.base_frame[0] == '/') params.base_frame.erase(0, 1);  // as tf2 wants it
  return params;
}

}  // namespace hyselam_topo
