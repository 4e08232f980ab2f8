#include "hyselam_topo/ros/topo_engine_parameters.hpp"

namespace hyselam_topo {

using hyselam::ParamLoader;
using hyselam::Range;

TopoEngineParams loadTopoEngineParams(ParamLoader& loader) {
  TopoEngineParams p;
  DialogueParams& d = p.dialogue;
  loader.get("language", d.language, Phrases::shippedLanguages(), "of the first words");
  using Ask = DialogueParams::Ask;
  loader.getEnum(
      "ask", d.ask,
      {{"never", Ask::kNever}, {"unconfirmed", Ask::kUnconfirmed}, {"always", Ask::kAlways}},
      "when it asks by itself on entering a place");
  loader.get("ask_from_afar", d.ask_from_afar, "also about places where it is not");
  loader.get("match_time_limit", d.match.time_limit, Range::between(0.01, 60.0),
             "[s] then the best names found so far are taken");
  loader.get("doorway", d.state.inside, Range::between(0.0, 5.0),
             "[m] within this of a door the place is held");
  loader.get("reach", d.state.reach, Range::between(0.0, 5.0),
             "[m] a pose on no place counts to the nearest one");
  loader.get("settle", d.state.settle, Range::between(0.0, 3600.0),
             "[s] after this a place is believed in a doorway, too");
  loader.get("jump", d.state.jump, Range::between(0.01, 100.0),
             "[m] a longer step is a new pose: no doorway holds the place");
  loader.get("glass_aperture", d.glass.aperture, Range::between(0.1, 2.0 * hyselam::kPi),
             "[rad] of the search for walls of glass");
  loader.get("glass_range", d.glass.range, Range::between(0.5, 50.0), "[m]");
  loader.get("glass_corner_cells", d.glass.corner_cells, Range::between(2, 100), "");
  loader.get("glass_corner_angle", d.glass.corner_angle, Range::between(0.01, 3.14), "[rad]");
  loader.get("glass_min_length", d.glass.min_length, Range::between(0.05, 10.0), "[m]");
  loader.get("glass_max_length", d.glass.max_length, Range::between(0.1, 50.0), "[m]");
  loader.get("occupied_min", d.glass.occupied_min, Range::between(1, 100),
             "cells of this or more are occupied");
  loader.get("clearance", d.route.clearance, Range::between(0.0, 5.0),
             "[m] ways keep this from walls where there is room");
  loader.get("comfortable", d.route.comfortable, Range::between(0.0, 10.0), "[m]");
  loader.get("base_frame", p.base_frame, "of the robot");
  loader.get("rate", p.rate, Range::between(0.1, 100.0), "[Hz] of looking for the pose");
  loader.get("pose_timeout", p.pose_timeout, Range::between(0.05, 60.0),
             "[s] an older pose is none");
  loader.get("state_file", p.state_file, "kept across restarts; empty: nothing is kept");
  loader.get("use_move_base", p.use_move_base, "drive by the action move_base, where it is there");
  loader.get("max_map_cells", p.max_map_cells, Range::between(1, 1e9), "a larger map is refused");
  loader.get("max_text_bytes", p.max_text_bytes, Range::between(100, 1e7),
             "a longer text is refused");
  loader.get("object_patience", p.object_patience, Range::between(0.1, 60.0),
             "[s] for the answer to a sentence about objects");
  loader.get("marker_alpha", p.markers.alpha, Range::between(0.0, 1.0), "of the places");
  loader.get("diagnostic_period", p.diagnostic_period, Range::between(0.05, 60.0), "[s]");
  if (p.base_frame.empty()) throw hyselam::ParameterError("base_frame", "''", "a frame");
  if (p.base_frame[0] == '/') p.base_frame.erase(0, 1);  // as tf2 wants it
  checkDialogueParams(d);
  return p;
}

}  // namespace hyselam_topo
