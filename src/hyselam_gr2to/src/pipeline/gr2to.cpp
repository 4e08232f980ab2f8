#include "hyselam_gr2to/gr2to.hpp"

#include <chrono>

#include "hyselam_gr2to/map_builder/map_builder.hpp"
#include "hyselam_gr2to/thesis/thesis.hpp"

namespace hyselam_topo {
namespace {

/// Adds the time since the last call to the list.
class StageClock {
 public:
  explicit StageClock(std::vector<std::pair<std::string, double>>& seconds) : seconds_(seconds) {}
  void done(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    seconds_.emplace_back(stage, std::chrono::duration<double>(now - last_).count());
    last_ = now;
  }

 private:
  std::vector<std::pair<std::string, double>>& seconds_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

Gr2ToResult gr2to(const hyselam::OccupancyGrid& grid, const Gr2ToParams& params) {
  Gr2ToResult result;
  StageClock clock(result.seconds);
  Segmentation places;
  if (params.mode == Gr2ToParams::Mode::kThesis) {
    places = segmentThesis(grid);
    clock.done("places and doors");
  } else {
    places = segmentPlaces(grid, params.segmentation);
    clock.done("places");
    addDoors(grid, places, params.segmentation);
    clock.done("doors");
  }
  result.map = buildTopologicalMap(grid, places);
  clock.done("walls and map");
  result.labels = places.labels;
  result.doors = std::move(places.doors);
  return result;
}

}  // namespace hyselam_topo
