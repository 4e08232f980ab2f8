#include "hyselam_gr2to/segmentation/place_segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "agglomeration.hpp"
#include "describe_border.hpp"
#include "geometric_evidence.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_gr2to/map_builder/doors.hpp"
#include "hyselam_gr2to/segmentation/border_model.hpp"
#include "number_places.hpp"
#include "prepared_basins.hpp"
#include "ray_fans.hpp"

namespace hyselam_topo {
namespace {

constexpr double kReach = 0.5;  // [m] labels grow so far into free cells that were cut off as leaks

void checkGrid(const hyselam::OccupancyGrid& grid) {
  const hyselam::GridGeometry& g = grid.geometry;
  if (g.width <= 0 || g.height <= 0 || grid.cells.size() != g.cellCount())
    throw hyselam::InputError("map", "", "has no cells, or not as many as its size says");
  if (!(g.resolution > 0.0) || !std::isfinite(g.resolution))
    throw hyselam::InputError("map", "resolution", "is not a positive number");
}

/// What is too small for a place becomes part of the neighbour with the longest open border.
void absorbSmall(RegionAdjacencyGraph& graph, double smallest) {
  for (int i = 1; i <= graph.size(); ++i) {
    int current = i;
    while (graph.node(current).alive && graph.node(current).area < smallest) {
      int best = 0;
      double longest = 0.0;
      for (const auto& [other, border] : graph.node(current).borders)
        if (graph.border(border).open > longest) {
          longest = graph.border(border).open;
          best = other;
        }
      if (best == 0) break;
      const int kept = std::min(current, best);
      graph.merge(kept, std::max(current, best));
      current = kept;
    }
  }
}

// A desk across a room: [m] up to so wide, and [m^2] up to so much room behind it.
constexpr double kDesk = 3.0;
constexpr double kBehindDesk = 8.0;

/// The roots around a solid piece; empty if it is at the rim or was seen through.
std::vector<int> rootsAround(const SolidPiece& piece, const RegionAdjacencyGraph& graph,
                             const cv::Mat& basins, const FreeSpace& space) {
  std::vector<int> roots;
  const cv::Rect inner(1, 1, basins.cols - 2, basins.rows - 2);
  const CellRun& first = space.solid[piece.begin];
  if ((piece.box & inner) != piece.box || basins.at<int>(first.y, first.first) != 0) return roots;
  const auto look = [&](int basin) {
    if (basin == 0) return;
    const int root = graph.root(basin);
    if (std::find(roots.begin(), roots.end(), root) == roots.end()) roots.push_back(root);
  };
  for (std::size_t i = piece.begin; i < piece.end; ++i) {
    const CellRun& run = space.solid[i];
    const int* row = basins.ptr<int>(run.y);
    const int *below = basins.ptr<int>(run.y - 1), *above = basins.ptr<int>(run.y + 1);
    look(row[run.first - 1]);
    look(row[run.last + 1]);
    for (int x = run.first; x <= run.last; ++x) look(below[x]), look(above[x]);
  }
  return roots;
}

/// What lies behind a desk, with a way past it on either side, is part of the room before it.
void joinAroundDesks(RegionAdjacencyGraph& graph, const cv::Mat& basins, const FreeSpace& space) {
  for (const SolidPiece& piece : space.pieces) {
    if (std::max(piece.box.width, piece.box.height) * space.resolution > kDesk) continue;
    const std::vector<int> roots = rootsAround(piece, graph, basins, space);
    if (roots.size() != 2) continue;
    const auto [a, b] = std::minmax(roots[0], roots[1]);
    if (std::min(graph.node(a).area, graph.node(b).area) > kBehindDesk) continue;
    const auto border = graph.node(a).borders.find(b);
    if (border == graph.node(a).borders.end() || graph.border(border->second).open <= 0.0) continue;
    graph.merge(a, b);
  }
}

/// Solid pieces within one place - its furniture - up to this area belong to it [m^2].
constexpr double kFurniture = 2.0;

void fillFurniture(cv::Mat& labels, const FreeSpace& space) {
  const double most = kFurniture / (space.resolution * space.resolution);
  const cv::Rect inner(1, 1, labels.cols - 2, labels.rows - 2);
  for (const SolidPiece& piece : space.pieces) {
    if (piece.cells > most || (piece.box & inner) != piece.box) continue;
    int around = 0;
    bool one = true;
    const auto look = [&](int label) {
      if (label == 0 || label == around) return;
      one = one && around == 0;
      around = label;
    };
    for (std::size_t i = piece.begin; i < piece.end && one; ++i) {
      const CellRun& run = space.solid[i];
      const int* row = labels.ptr<int>(run.y);
      const int *below = labels.ptr<int>(run.y - 1), *above = labels.ptr<int>(run.y + 1);
      look(row[run.first - 1]);
      look(row[run.last + 1]);
      for (int x = run.first; x <= run.last; ++x) look(row[x]), look(below[x]), look(above[x]);
    }
    if (!one || around == 0) continue;
    for (std::size_t i = piece.begin; i < piece.end; ++i) {
      int* row = labels.ptr<int>(space.solid[i].y);
      std::fill(row + space.solid[i].first, row + space.solid[i].last + 1, around);
    }
  }
}

/// The places as labels of the basins' cells, CV_32S, and how many there are.
std::pair<cv::Mat, int> labelsOf(const RegionAdjacencyGraph& graph, const cv::Mat& basins,
                                 double min_area) {
  std::vector<int> label_of(static_cast<std::size_t>(graph.size()) + 1, 0);
  int used = 0;
  for (int i = 1; i <= graph.size(); ++i) {
    if (graph.node(i).alive && graph.node(i).area >= min_area) {
      label_of[static_cast<std::size_t>(i)] = ++used;
    }
  }
  if (used > std::numeric_limits<std::uint16_t>::max()) {
    throw hyselam::InputError("map", "", "has more than 65535 places");
  }
  for (int i = 1; i <= graph.size(); ++i) {
    label_of[static_cast<std::size_t>(i)] = label_of[static_cast<std::size_t>(graph.root(i))];
  }
  cv::Mat labels = basins;  // in their place
  for (int y = 0; y < labels.rows; ++y) {
    for (int *cell = labels.ptr<int>(y), *end = cell + labels.cols; cell != end; ++cell) {
      *cell = label_of[static_cast<std::size_t>(*cell)];
    }
  }
  return {labels, used};
}

/// What few rays saw from afar is no place.
void leaveOutside(cv::Mat& labels, int places, const FreeSpace& space) {
  const std::vector<char> outside = findOutside(labels, places, space.occupied, space.resolution);
  if (std::find(outside.begin(), outside.end(), 1) == outside.end()) return;
  for (int y = 0; y < labels.rows; ++y)
    for (int *cell = labels.ptr<int>(y), *end = cell + labels.cols; cell != end; ++cell)
      if (outside[static_cast<std::size_t>(*cell)] != 0) *cell = 0;
}

}  // namespace

void SegmentationParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("free_max", free_max, Range::between(0, 99), "", "cells of 0 .. this value are free");
  visit("working_resolution", working_resolution, Range::between(0.01, 0.25), "m",
        "finer cells are joined to about this size, coarser ones resampled to it");
  visit.renamed("clutter", "max_clutter_size");
  visit("max_clutter_size", max_clutter_size, Range::between(0.0, 5.0), "m",
        "free-standing obstacles whose box has a diagonal up to this do not separate places");
  visit.renamed("smallest_place", "min_place_area");
  visit("min_place_area", min_place_area, Range::between(0.0, 100.0), "m^2",
        "smaller places join a neighbor or are left out");
}

void SegmentationParams::validate() const {
  hyselam::checkParameters(*this);
}

PlaceSegmentation segmentPlaces(const hyselam::OccupancyGrid& grid,
                                const SegmentationParams& params) {
  checkGrid(grid);
  params.validate();
  PlaceSegmentation result;
  result.labels = cv::Mat(grid.geometry.height, grid.geometry.width, CV_16U, cv::Scalar(0));
  const PreparedBasins prepared = prepareBasins(grid, params, Preparation::kFull);
  if (prepared.basins.count == 0) return result;

  RegionAdjacencyGraph graph(prepared.clearance, prepared.basins, prepared.space.resolution,
                             prepared.context);
  const BorderModel& model = params.border_model ? *params.border_model : BorderModel::shipped();
  agglomerate(graph, [&model](const RegionAdjacencyGraph& g, int a, int b) {
    return model.oddsOfOnePlace(describeBorder(g, a, b)) + geometricEvidence(g, a, b);
  });
  absorbSmall(graph, params.min_place_area);
  joinAroundDesks(graph, prepared.basins.labels, prepared.space);

  auto [labels, places] = labelsOf(graph, prepared.basins.labels, params.min_place_area);
  leaveOutside(labels, places, prepared.space);
  fillFurniture(labels, prepared.space);
  const int reach = static_cast<int>(std::ceil(kReach / grid.geometry.resolution));
  result.labels = toGrid(labels, prepared.space, grid, params.free_max, reach);
  result.places = numberPlaces(result.labels);
  return result;
}

void addDoors(const hyselam::OccupancyGrid& grid, PlaceSegmentation& places,
              const SegmentationParams& params) {
  DoorParams doors;
  doors.free_max = params.free_max;
  places.doors = refineDoors(grid, places.labels, doors);
}

PlaceSegmentation segment(const hyselam::OccupancyGrid& grid, const SegmentationParams& params) {
  PlaceSegmentation result = segmentPlaces(grid, params);
  addDoors(grid, result, params);
  return result;
}

}  // namespace hyselam_topo
