// The map as it is now, of a building that changes from visit to visit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hyselam_common/occupancy_mapper.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

struct PresentMapParams {
  /// How often a cell changes from one visit to the next, before anything is known of it, 0..0.5.
  double change_probability = 0.1;
  double change_memory = 5.0;  ///< visits that this counts as, > 0
  /// Log odds by which one observation more than OccupancyMapperParams::occupied_ratio asks for
  /// moves a cell, > 0; a visit moves it by `max_visit` at most, all of them to `max_log_odds`.
  double observation = 3.3;
  double max_visit = 4.0;     ///< > 0
  double max_log_odds = 6.0;  ///< > 0
  /// Changes nearer than so many cells to where the same was before are errors of the poses, 0..20.
  int tolerance = 2;
  int min_cells = 3;  ///< of a change, >= 1
  /// Log odds, before and now, of a cell that is said to have changed, >= 0.
  double sure = 1.0;

  void describe(hyselam::ParameterVisitor& visit);
};

/// Neighbouring cells that changed the same way.
struct MapChange {
  enum class Kind : std::uint8_t { kAppeared, kGone };
  Kind kind = Kind::kAppeared;
  bool again = false;  ///< most of its cells have changed before
  hyselam::Point2 center;
  double size = 0.0;                   ///< side of the square along the axes that holds it [m]
  double probability = 0.0;            ///< mean over the cells, 0..1
  std::vector<hyselam::Point2> cells;  ///< centres
};
/// "appeared", "gone".
const char* toString(MapChange::Kind kind);
/// "12 things appeared, 9 are gone, 3 of them not for the first time"; "nothing changed"; that
/// nothing is known of it (SlamEngine::knowsChanges()).
std::string summaryOf(const std::vector<MapChange>& changes, bool known = true);

/// Each run that saw a cell is one visit. Between visits the cell may have changed, with a
/// probability that is learnt of each cell: one that never changed needs more evidence than a
/// door (an occupancy grid of independent Markov chains, as in Saarinen et al. 2012). A map of one
/// run is that of OccupancyMapper.
class PresentMap {
 public:
  /// @throws hyselam::ParameterError
  explicit PresentMap(const hyselam::OccupancyMapperParams& map,
                      const PresentMapParams& params = {});

  /// What a map is drawn from. `shown`: by run, whether it is in the map; runs beyond are not.
  /// `session`: the first run of the present session. `revision`: changes whenever poses of earlier
  /// keyframes do. Keyframes come in the order of their runs.
  struct Source {
    const std::vector<SlamKeyframe>& keyframes;
    const SettledMap& settled;
    const std::vector<bool>& shown;
    std::uint32_t session = 0;
    long revision = 0;
  };
  /// Inserts keyframes as they come; all of them again after old ones moved.
  /// @throws std::length_error when the map would be too large; what fits remains.
  void update(const Source& source);

  hyselam::OccupancyGrid grid() const;
  /// How sure: the probability that a cell is occupied, in per cent; -1 where it is unknown.
  hyselam::OccupancyGrid probabilities() const;
  /// All of it at once.
  struct Drawn {
    hyselam::OccupancyGrid grid, probabilities;
    std::vector<MapChange> changes;
  };
  Drawn draw() const;
  double cell() const { return map_.resolution; }
  /// Since the runs before the session; nothing in a first session. The largest first.
  std::vector<MapChange> changes() const;

  struct Belief {
    float log_odds = 0.0F;
    std::uint16_t visits = 0, changes = 0;
    std::uint16_t observations = 0;
    bool now = false;  ///< seen in the newest session
  };
  /// Of all cells that were observed, in the same order each time: use(x, y, belief), as
  /// OccupancyMapper::forEachObserved().
  template <typename Use>
  void forEachKnown(Use use) const {
    withPresent([&](const Grid& g) {
      g.cells.forEach([&](int x, int y, const Belief& b) {
        if (b.observations > 0) use(x, y, b);
      });
    });
  }
  bool isKnown(const Belief& b) const;

 private:
  struct Grid {
    int x0 = 0, y0 = 0, width = 0, height = 0;  ///< in the lattice of the map's frame
    hyselam::TiledGrid<Belief> cells;           ///< in that lattice, too
    /// Of a cell counted from x0, y0.
    const Belief& at(int x, int y) const {
      static const Belief kUnknown;
      const Belief* b = cells.find(x + x0, y + y0);
      return b == nullptr ? kUnknown : *b;
    }
    /// Of a cell of the lattice that is covered.
    Belief& of(int x, int y) { return *cells.at(x, y); }
    /// @throws std::length_error beyond `max_cells`.
    void cover(int min_x, int min_y, int max_x, int max_y, std::size_t max_cells);
  };
  void closeRun();
  void beginRun(std::uint32_t run, const Source& source);
  void fold(const hyselam::OccupancyMapper& visit, bool now, Grid* grid) const;
  void settleBefore(std::uint32_t run, const Source& source);
  /// Calls `use` with all runs as they are now; copies only what an open run goes on top of.
  template <typename Use>
  auto withPresent(Use use) const {
    if (!open_) return use(past_);
    Grid g = past_;
    fold(visit_, in_session_, &g);
    return use(g);
  }
  template <typename Value>
  hyselam::OccupancyGrid gridOf(const Grid& g, const Value& value) const;
  hyselam::OccupancyGrid gridOf(const Grid& g) const;
  hyselam::OccupancyGrid probabilitiesOf(const Grid& g) const;
  std::vector<MapChange> changesOf(const Grid& now) const;
  hyselam::OccupancyGrid emptyGrid(const Grid& g) const;

  hyselam::OccupancyMapperParams map_;
  PresentMapParams params_;
  hyselam::OccupancyMapper visit_;  // of the run that goes on
  Grid past_;                       // of the runs before it
  Grid before_;                     // of the sessions before this one
  std::size_t inserted_ = 0;
  std::uint32_t run_ = 0, session_ = 0;
  std::uint32_t settled_before_ = 0;  // the cells of earlier runs are in the map
  bool open_ = false, in_session_ = false;
  std::vector<bool> shown_;
  std::size_t settled_cells_ = 0;
  long revision_ = -1;
};

/// The cells of which the `kept` keyframes alone do not tell what all of them do together with what
/// was settled `before`, and those that have changed. `kept`: by keyframe; `map_of_run`: the map
/// that a run lies in, each is settled by itself; `map`: how it is drawn. Numbers of keyframes stay
/// as they are.
SettledMap settledMap(const std::vector<SlamKeyframe>& keyframes, const std::vector<bool>& kept,
                      const std::vector<std::uint32_t>& map_of_run, const SettledMap& before,
                      const hyselam::OccupancyMapperParams& map, const PresentMapParams& params);

}  // namespace ngram_slam
