#include "hyselam_gr2to/segmentation/segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "agglomeration.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_gr2to/map_builder/doors.hpp"
#include "number_places.hpp"

namespace hyselam_topo {
namespace {

constexpr double kReach = 0.5;  // [m] labels grow so far into free cells that were cut off as leaks

void check(const hyselam::OccupancyGrid& grid, const SegmentationParams& params) {
  const hyselam::GridGeometry& g = grid.geometry;
  if (g.width <= 0 || g.height <= 0 || grid.cells.size() != g.cellCount())
    throw hyselam::InputError("map", "", "has no cells, or not as many as its size says");
  if (!(g.resolution > 0.0) || !std::isfinite(g.resolution))
    throw hyselam::InputError("map", "resolution", "is not a positive number");
  if (params.free_max < 0 || params.free_max > 99)
    throw hyselam::ParameterError("free_max", params.free_max, "within 0 .. 99");
  if (!(params.working_resolution >= 0.01 && params.working_resolution <= 0.25))
    throw hyselam::ParameterError("working_resolution", params.working_resolution,
                                  "within 0.01 .. 0.25 m");
  if (!(params.clutter >= 0.0 && params.clutter <= 5.0))
    throw hyselam::ParameterError("clutter", params.clutter, "within 0 .. 5 m");
  if (!(params.smallest_place >= 0.0 && params.smallest_place <= 100.0))
    throw hyselam::ParameterError("smallest_place", params.smallest_place, "within 0 .. 100 m^2");
}

/// What is too small for a place becomes part of the neighbour with the longest open border.
void absorbSmall(PlaceGraph& graph, double smallest) {
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
std::vector<int> rootsAround(const SolidPiece& piece, const PlaceGraph& graph,
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
void joinAroundDesks(PlaceGraph& graph, const cv::Mat& basins, const FreeSpace& space) {
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

}  // namespace

Segmentation segmentPlaces(const hyselam::OccupancyGrid& grid, const SegmentationParams& params) {
  check(grid, params);
  Segmentation result;
  result.labels = cv::Mat(grid.geometry.height, grid.geometry.width, CV_16U, cv::Scalar(0));
  const PreparedPlaces prepared = preparePlaces(grid, params);
  if (prepared.basins.count == 0) return result;

  const double resolution = prepared.space.resolution;
  PlaceGraph graph(prepared.clearance, prepared.basins, resolution);
  const BoostedTrees& model = borderModel();
  agglomerate(graph, [&model](const PlaceGraph& g, int a, int b) {
    return oddsOfOnePlace(model, describeBorder(g, a, b));
  });
  absorbSmall(graph, params.smallest_place);
  joinAroundDesks(graph, prepared.basins.labels, prepared.space);

  std::vector<int> names(static_cast<std::size_t>(graph.size()) + 1, 0);
  int used = 0;
  for (int i = 1; i <= graph.size(); ++i)
    if (graph.node(i).alive && graph.node(i).area >= params.smallest_place)
      names[static_cast<std::size_t>(i)] = ++used;
  if (used > std::numeric_limits<std::uint16_t>::max())
    throw hyselam::InputError("map", "", "has more than 65535 places");
  for (int i = 1; i <= graph.size(); ++i)
    names[static_cast<std::size_t>(i)] = names[static_cast<std::size_t>(graph.root(i))];
  cv::Mat labels = prepared.basins.labels;
  for (int y = 0; y < labels.rows; ++y)
    for (int *cell = labels.ptr<int>(y), *end = cell + labels.cols; cell != end; ++cell)
      *cell = names[static_cast<std::size_t>(*cell)];
  fillFurniture(labels, prepared.space);

  const int reach = static_cast<int>(std::ceil(kReach / grid.geometry.resolution));
  result.labels = toGrid(labels, prepared.space, grid, params.free_max, reach);
  result.places = numberPlaces(result.labels);
  return result;
}

void addDoors(const hyselam::OccupancyGrid& grid, Segmentation& places,
              const SegmentationParams& params) {
  DoorParams doors;
  doors.free_max = params.free_max;
  places.doors = refineDoors(grid, places.labels, doors);
}

Segmentation segment(const hyselam::OccupancyGrid& grid, const SegmentationParams& params) {
  Segmentation result = segmentPlaces(grid, params);
  addDoors(grid, result, params);
  return result;
}

}  // namespace hyselam_topo
