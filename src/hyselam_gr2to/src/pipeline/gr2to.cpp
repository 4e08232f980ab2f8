#include "hyselam_gr2to/gr2to.hpp"

#include <algorithm>
#include <chrono>

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

/// Those of mode thesis as gr2to() uses them.
ThesisParams thesisParams(const Gr2ToParams& params) {
  ThesisParams thesis = params.thesis;
  thesis.free_max = params.segmentation.free_max;
  return thesis;
}

const std::vector<std::pair<std::string, Gr2ToParams::Mode>> kModes = {
    {"default", Gr2ToParams::Mode::kDefault}, {"thesis", Gr2ToParams::Mode::kThesis}};

}  // namespace

void Gr2ToParams::describe(hyselam::ParameterVisitor& visit) {
  visit("mode", mode, kModes,
        "default: merged places, clutter does not separate them; thesis: the pipeline of the "
        "thesis");
  visit.group("", segmentation);
  visit.group("thesis_", thesis, {{"free_max", hyselam::ParameterVisitor::kNotOffered}});
}

void Gr2ToParams::validate() const {
  segmentation.validate();
  if (mode == Mode::kThesis) thesisParams(*this).validate();
}

const char* toString(Gr2ToParams::Mode mode) {
  for (const auto& [word, value] : kModes) {
    if (value == mode) return word.c_str();
  }
  return "";
}

MapBuilderParams mapBuilderParams(const Gr2ToParams& params) {
  MapBuilderParams builder;
  builder.walls.free_max = params.segmentation.free_max;
  builder.walls.occupied_min = std::max(builder.walls.occupied_min, builder.walls.free_max + 1);
  return builder;
}

Gr2ToResult gr2to(const hyselam::OccupancyGrid& grid, const Gr2ToParams& params) {
  Gr2ToResult result;
  StageClock clock(result.seconds);
  PlaceSegmentation places;
  if (params.mode == Gr2ToParams::Mode::kThesis) {
    places = segmentThesis(grid, thesisParams(params));
    clock.done("places and doors");
  } else {
    places = segmentPlaces(grid, params.segmentation);
    clock.done("places");
    addDoors(grid, places, params.segmentation);
    clock.done("doors");
  }
  result.map = buildTopologicalMap(grid, places, mapBuilderParams(params));
  clock.done("walls and map");
  result.labels = places.labels;
  result.doors = std::move(places.doors);
  return result;
}

}  // namespace hyselam_topo
