#include "hyselam_topo/segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "agglomeration.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_topo/doors.hpp"

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

/// Solid pieces within one place - its furniture - up to this area belong to it [m^2].
constexpr double kFurniture = 2.0;

void fillFurniture(cv::Mat& labels, const FreeSpace& space) {
  const double most = kFurniture / (space.resolution * space.resolution);
  const cv::Rect inner(1, 1, labels.cols - 2, labels.rows - 2);
  for (int i = 1; i < space.boxes.rows; ++i) {
    const cv::Rect box = space.boxOf(i);
    if (space.boxes.at<int>(i, cv::CC_STAT_AREA) > most || (box & inner) != box) continue;
    int around = 0;
    bool one = true;
    for (int y = box.y; y < box.br().y && one; ++y)
      for (int x = box.x; x < box.br().x && one; ++x) {
        if (space.pieces.at<int>(y, x) != i) continue;
        for (const cv::Point d :
             {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
          const int label = labels.at<int>(y + d.y, x + d.x);
          if (label == 0 || label == around) continue;
          one = around == 0;
          around = label;
        }
      }
    if (one && around != 0) labels(box).setTo(around, space.pieces(box) == i);
  }
}

struct Run {
  int first, last;  // columns, both in it
  int label;
  int piece;
};

/// Each label keeps its largest 4-connected piece; other pieces get the label of a neighbour they
/// touch, or none. Then the places are numbered 1 .. n in the order of their first cells.
int number(cv::Mat& labels) {
  std::vector<std::vector<Run>> rows(static_cast<std::size_t>(labels.rows));
  std::vector<int> parents;
  const auto find = [&](int i) {
    while (parents[static_cast<std::size_t>(i)] != i) {
      int& p = parents[static_cast<std::size_t>(i)];
      p = parents[static_cast<std::size_t>(p)];
      i = p;
    }
    return i;
  };
  for (int y = 0; y < labels.rows; ++y) {
    const std::uint16_t* cells = labels.ptr<std::uint16_t>(y);
    std::vector<Run>& runs = rows[static_cast<std::size_t>(y)];
    for (int x = 0; x < labels.cols;) {
      const int start = x, label = cells[x];
      while (x < labels.cols && cells[x] == label) ++x;
      if (label == 0) continue;
      runs.push_back({start, x - 1, label, static_cast<int>(parents.size())});
      parents.push_back(static_cast<int>(parents.size()));
    }
    if (y == 0) continue;
    const std::vector<Run>& before = rows[static_cast<std::size_t>(y) - 1];
    std::size_t k = 0;
    for (const Run& run : runs) {
      while (k < before.size() && before[k].last < run.first) ++k;
      for (std::size_t j = k; j < before.size() && before[j].first <= run.last; ++j) {
        if (before[j].label != run.label) continue;
        const int a = find(before[j].piece), b = find(run.piece);
        parents[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
    }
  }
  std::vector<int> sizes(parents.size(), 0);
  for (const auto& runs : rows)
    for (const Run& run : runs)
      sizes[static_cast<std::size_t>(find(run.piece))] += run.last - run.first + 1;
  std::vector<int> largest(std::numeric_limits<std::uint16_t>::max() + std::size_t{1}, -1);
  for (const auto& runs : rows)
    for (const Run& run : runs) {
      const int piece = find(run.piece);
      int& best = largest[static_cast<std::size_t>(run.label)];
      if (best < 0 ||
          sizes[static_cast<std::size_t>(piece)] > sizes[static_cast<std::size_t>(best)])
        best = piece;
    }
  // What is not a largest piece looks for a neighbour that is, until nothing changes: such pieces
  // are few and small.
  std::vector<int> becomes(parents.size(), 0);
  bool torn = false;
  for (const auto& runs : rows)
    for (const Run& run : runs) {
      const int piece = find(run.piece);
      const bool kept = largest[static_cast<std::size_t>(run.label)] == piece;
      becomes[static_cast<std::size_t>(piece)] = kept ? run.label : 0;
      torn = torn || !kept;
    }
  for (bool changed = torn; changed;) {
    changed = false;
    const auto touch = [&](const Run& run, const Run& other) {
      int& own = becomes[static_cast<std::size_t>(find(run.piece))];
      const int theirs = becomes[static_cast<std::size_t>(find(other.piece))];
      if (own == 0 && theirs != 0) own = theirs, changed = true;
    };
    for (std::size_t y = 0; y < rows.size(); ++y)
      for (std::size_t i = 0; i < rows[y].size(); ++i) {
        const Run& run = rows[y][i];
        if (i > 0 && rows[y][i - 1].last + 1 == run.first) {
          touch(run, rows[y][i - 1]);
          touch(rows[y][i - 1], run);
        }
        if (y == 0) continue;
        for (const Run& other : rows[y - 1]) {
          if (other.last < run.first || other.first > run.last) continue;
          touch(run, other);
          touch(other, run);
        }
      }
  }
  std::vector<int> names(largest.size(), 0);
  int count = 0;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    std::uint16_t* cells = labels.ptr<std::uint16_t>(static_cast<int>(y));
    for (const Run& run : rows[y]) {
      const int label = becomes[static_cast<std::size_t>(find(run.piece))];
      int name = 0;
      if (label != 0) {
        int& slot = names[static_cast<std::size_t>(label)];
        if (slot == 0) slot = ++count;
        name = slot;
      }
      std::fill(cells + run.first, cells + run.last + 1, static_cast<std::uint16_t>(name));
    }
  }
  return count;
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
    const BorderFeatures features = describeBorder(g, a, b);
    return model(features.data());
  });
  absorbSmall(graph, params.smallest_place);

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
  result.places = number(result.labels);
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
