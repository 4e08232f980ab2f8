// Gr2To in a thread of its own: the newest grid map is segmented, and its topological map gets the
// ids and names of the previous one (carry_over.hpp).
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_topological_map/carry_over.hpp"

namespace hyselam_topo {

/// Safe to call from any thread.
class BackgroundGr2To {
 public:
  using Pipeline = std::function<Gr2ToResult(const hyselam::OccupancyGrid&, const Gr2ToParams&)>;
  using MapPtr = std::shared_ptr<const AugmentedTopologicalMap>;

  struct Input {
    /// Makes the grid in the thread; what it throws becomes Outcome::error.
    std::function<hyselam::OccupancyGrid()> grid;
    std::string frame_id = "map";
    double stamp = 0.0;  ///< [s]
    Gr2ToParams params;
    int params_version = 0;  ///< changes with the parameters
  };

  struct Outcome {
    MapPtr map;         ///< null if the input could not be used: the previous map stays valid
    std::string error;  ///< why the input could not be used; empty: it was used
    /// Why the ids and names of the previous map could not be carried over; empty: they were.
    std::string warning;
    bool unchanged = false;  ///< same grid and parameters as for the previous map
    std::shared_ptr<const hyselam::OccupancyGrid> grid;
    CarryOverReport report;
    std::vector<std::pair<std::string, double>> seconds;  ///< (stage, wall time [s])
    double total_seconds = 0.0;
  };

  /// `done` is called in the thread after each input.
  BackgroundGr2To(std::function<void(const Outcome&)> done, Pipeline pipeline);

  /// Gr2To that segments only the places around a change (Gr2ToUpdater), and after
  /// `max_partial_updates` of them the whole map, because places far from the changes were not
  /// segmented again. 0: always the whole map.
  static Pipeline updating(int max_partial_updates = 50);
  /// Waits for the segmentation in progress.
  ~BackgroundGr2To();
  BackgroundGr2To(const BackgroundGr2To&) = delete;
  BackgroundGr2To& operator=(const BackgroundGr2To&) = delete;

  /// An input that waits is replaced; a segmentation in progress is finished, and its map is
  /// carried over to the next one.
  void start(Input input);

  /// The newest map; null before the first.
  MapPtr current() const;

  /// Replaces the newest map by another one, which later inputs carry over. It must have a grid.
  /// @throws hyselam::InputError, as checkMap().
  void replace(const AugmentedTopologicalMap& map, const std::string& source);

  /// Whether an input waits or is being segmented.
  bool busy() const;

 private:
  void run();
  Outcome work(const Input& input);
  /// Fits the fresh map to the newest one and puts it in its place.
  void adopt(const AugmentedTopologicalMap& fresh, Outcome& outcome);

  std::function<void(const Outcome&)> on_done_;
  Pipeline pipeline_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Input> next_;
  MapPtr current_;
  bool working_ = false;
  bool stop_ = false;
  /// Of the thread: what the newest map was made of; empty after replace().
  std::shared_ptr<const hyselam::OccupancyGrid> last_grid_;
  std::string last_frame_;
  int last_params_version_ = 0;
  std::thread thread_;
};

}  // namespace hyselam_topo
