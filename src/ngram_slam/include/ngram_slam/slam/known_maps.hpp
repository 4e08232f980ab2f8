// Where in the maps of other runs the last metres of a run fit best, and how sure that is beside
// all other places of these maps.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "ngram_slam/slam/consolidation.hpp"
#include "ngram_slam/slam/run_connections.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// A keyframe of the run, as the search of whole maps needs it.
struct SubmapScan {
  hyselam::Pose2 pose;
  std::shared_ptr<const hyselam::LaserScan> scan;  ///< never null
};

/// A place at which the newest keyframe of a run may lie.
struct KnownPlace {
  int keyframe = 0;  ///< of another map, the nearest one
  hyselam::Pose2 base_in_keyframe;
  /// That no other place of any of the maps is the right one, if one of them is, 0..1: the odds of
  /// the localizer as shipped (the defaults of fsd_localization::PlaceOdds, not place_odds_* as
  /// they may be set for the localizer), and no more than the margin to the best other place tells.
  double probability = 0.0;
};

class KnownMaps {
 public:
  /// The maps of the keyframes before `end`, each drawn and searched by itself, since nothing is
  /// known of where they lie to each other; without the map that the run `but` belongs to, if it is
  /// told. Nothing is drawn before the first search or draw().
  KnownMaps(const SlamState& state, int end, const RunConnections& connections,
            std::optional<std::uint32_t> but, const ConsolidationParams& drawn);
  ~KnownMaps();
  KnownMaps(const KnownMaps&) = delete;
  KnownMaps& operator=(const KnownMaps&) = delete;

  /// The place at which the scans fit best; nothing if they fit nowhere, or only where there is
  /// none, or if a map is too large to be drawn: it would be missed as a rival. `scans`: the last
  /// metres of a run, the newest last. Deterministic; not thread-safe. If drawing fails otherwise
  /// (std::bad_alloc), that is thrown once, and nothing is found from then on.
  std::optional<KnownPlace> find(const std::vector<SubmapScan>& scans);

  /// Draws the maps if they are not drawn yet, as the first search does.
  void draw();
  /// The same in maps that are drawn, nothing if they are not; without the map that the run `but`
  /// belongs to. On several threads at once.
  std::optional<KnownPlace> findBut(std::uint32_t but, const std::vector<SubmapScan>& scans) const;

 private:
  struct Map;
  std::optional<KnownPlace> find(std::optional<std::uint32_t> but,
                                 const std::vector<SubmapScan>& scans) const;

  /// Where a keyframe lies.
  struct Keyframe {
    hyselam::Pose2 pose;
    std::uint32_t map;
  };
  std::vector<Keyframe> keyframes_;
  // What the maps are drawn from; let go then.
  std::vector<SlamKeyframe> drawn_from_;
  SettledMap settled_;
  std::vector<std::uint32_t> map_of_run_;
  std::optional<std::uint32_t> but_;  // a map
  ConsolidationParams params_;        // how maps are drawn
  bool drawn_ = false;
  std::vector<Map> maps_;
};

}  // namespace ngram_slam
