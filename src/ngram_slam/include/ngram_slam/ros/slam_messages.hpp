// What SLAM knows as messages.
#pragma once

#include <hyselam_msgs/LocalizationStatus.h>
#include <hyselam_msgs/MapChangeArray.h>
#include <hyselam_msgs/RegionGraph.h>
#include <hyselam_msgs/WordMatch.h>
#include <nav_msgs/Path.h>
#include <visualization_msgs/MarkerArray.h>

#include <vector>

#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/region_graph.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// @param header map frame.
hyselam_msgs::RegionGraph toMsg(const RegionGraph& graph, const std_msgs::Header& header);

/// The keyframes of the newest run.
nav_msgs::Path pathMsg(const std::vector<SlamKeyframe>& keyframes, const std_msgs::Header& header);

/// A match as SLAM keeps it: words by the observations, chance and alignment not known.
hyselam_msgs::WordMatch matchMsg(const NgramRecognizer& recognizer, const SlamMatch& match);

/// Whether the pose is to be trusted: not while it is only supposed where the run began.
/// @param update_ms wall time of the last scan.
hyselam_msgs::LocalizationStatus statusMsg(const SlamEngine& engine, double update_ms,
                                           const std_msgs::Header& header);

/// `cell`: side of the cells [m].
hyselam_msgs::MapChangeArray changesMsg(const std::vector<MapChange>& changes, double cell,
                                        const std_msgs::Header& header);
/// Cells that are occupied now in green, those that are free now in red, and a name above each
/// thing of some size.
visualization_msgs::MarkerArray changeMarkers(const std::vector<MapChange>& changes, double cell,
                                              const std_msgs::Header& header);

/// Namespaces: "path", lines between keyframes; "loops", green by proximity, magenta by words,
/// orange by signatures, red where they contradict others; "regions", one ball per region coloured
/// by class; "region_links", lines between them, those of loops in magenta; "region_names".
/// @param shown as SlamEngine::shownRuns(); the current run is always drawn.
visualization_msgs::MarkerArray slamMarkers(const std::vector<SlamKeyframe>& keyframes,
                                            const std::vector<bool>& shown,
                                            const std::vector<SlamLoop>& loops,
                                            const RegionGraph& graph,
                                            const std_msgs::Header& header);

}  // namespace ngram_slam
