// What the page of slam_offline shows, as JSON; scripts/slam_report makes the page.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "loop_table.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/region_graph.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

/// To a millimeter: a figure needs no more.
inline double rounded(double meters) {
  return std::round(1e3 * meters) / 1e3;
}

/// One trajectory through a building, over the map in the file `map` beside the report. Loops by
/// what found them (foundBy()), those that are not used (isUsed()) apart. `saved_keyframes`:
/// kindOf().
inline nlohmann::json figureJson(const std::string& title, const std::string& map,
                                 const SlamEngine& engine, std::size_t saved_keyframes) {
  using nlohmann::json;
  json trajectory = json::array(), regions = json::array();
  json loops = {{"proximity", json::array()},   {"outline", json::array()},
                {"words", json::array()},       {"signatures", json::array()},
                {"start", json::array()},       {"saved", json::array()},
                {"not_believed", json::array()}};
  for (const hyselam::StampedPose2& p : engine.trajectory()) {
    trajectory.push_back({rounded(p.pose.x), rounded(p.pose.y)});
  }
  for (const SlamLoop& l : engine.loops()) {
    const hyselam::Pose2& a = engine.keyframes()[static_cast<std::size_t>(l.older)].pose;
    const hyselam::Pose2& b = engine.keyframes()[static_cast<std::size_t>(l.newer)].pose;
    loops[isUsed(l) ? foundBy(l, saved_keyframes) : "not_believed"].push_back(
        {rounded(a.x), rounded(a.y), rounded(b.x), rounded(b.y)});
  }
  for (const RegionNode& n : regionGraph(engine).nodes) {
    regions.push_back(
        json::array({rounded(n.pose.x), rounded(n.pose.y), toString(n.semantic_class)}));
  }
  return {{"title", title},
          {"map", map},
          {"trajectory", trajectory},
          {"loops", loops},
          {"places_seen_again", sentenceOf(LoopCounts(engine.loops(), saved_keyframes))},
          {"regions", regions}};
}

/// What came and went, cell by cell: lower left corners.
inline nlohmann::json toJson(const std::vector<MapChange>& changes, double cell) {
  using nlohmann::json;
  json appeared = json::array(), gone = json::array();
  for (const MapChange& c : changes) {
    for (const hyselam::Point2& p : c.cells) {
      (c.kind == MapChange::Kind::kAppeared ? appeared : gone)
          .push_back({rounded(p.x - 0.5 * cell), rounded(p.y - 0.5 * cell)});
    }
  }
  return {{"cell", cell}, {"appeared", appeared}, {"gone", gone}};
}

/// `figures`: of figureJson(). Loops and matches by the path lengths of their keyframes [m].
inline nlohmann::json reportJson(const std::string& log, const SlamEngine& engine,
                                 const nlohmann::json& figures) {
  using nlohmann::json;
  const auto& keyframes = engine.keyframes();
  const auto path_length = [&](int keyframe) {
    return rounded(keyframes[static_cast<std::size_t>(keyframe)].path_length);
  };
  json words = json::array(), loops = json::array(), matches = json::array();
  const WordLattice& text = engine.recognizer().text();
  for (WordIndex i = 0; i < text.words(); ++i) {
    const DensityWord w = text.word(i);
    if (w.level != 0) continue;
    words.push_back({{"word", i},
                     {"class", w.syllables.density_class},
                     {"size", w.syllables.size},
                     {"angle_deg", hyselam::degrees(static_cast<double>(w.syllables.angle))}});
  }
  for (const SlamLoop& l : engine.loops()) {
    loops.push_back({path_length(l.newer), path_length(l.older)});
  }
  for (const SlamMatch& m : engine.matches()) {
    matches.push_back(
        json::array({path_length(m.keyframe_newer), path_length(m.keyframe_older), m.accepted}));
  }
  return {{"log", log},
          {"figures", figures},
          {"words", words},
          {"path_length_m", keyframes.empty() ? 0.0 : rounded(keyframes.back().path_length)},
          {"loops", loops},
          {"matches", matches}};
}

}  // namespace ngram_slam
