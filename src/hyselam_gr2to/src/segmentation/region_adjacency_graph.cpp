#include "region_adjacency_graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "alongside.hpp"
#include "hyselam_common/pose2.hpp"
#include "row_marks.hpp"

namespace hyselam_topo {
namespace {

constexpr double kThinWall =
    0.45;  // [m] from either side: a thicker wall does not separate two rooms
constexpr double kWallProbe = 0.8;      // [m] behind the ends of a chord
constexpr int kChords = 36;             // tried directions
constexpr double kBeforePassage = 1.5;  // [m] on either side of a passage that may be wider

/// Solid cells near free ones get the label of the nearest, so that labels meet within thin walls.
cv::Mat reachIntoWalls(const cv::Mat& labels, int steps) {
  cv::Mat out = labels.clone();
  int* cells = out.ptr<int>();
  const int stride = labels.cols;
  std::vector<int> front, next;
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(stride), 0);
  for (int y = 1; y + 1 < labels.rows; ++y) {
    const int* row = cells + y * stride;
    for (int x = 1; x + 1 < stride; ++x)
      marks[static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(
          (row[x] != 0) & ((row[x - 1] == 0) | (row[x + 1] == 0) | (row[x - stride] == 0) |
                           (row[x + stride] == 0)));
    eachMarked(marks, [&](int x) { front.push_back(y * stride + x); });
  }
  for (int step = 0; step < steps; ++step) {
    next.clear();
    // Straight and slanting steps in turn: an octagon, near enough to a circle.
    const int slanting = step % 2;
    for (const int i : front) {
      const int y = i / stride, x = i - y * stride;
      if (y == 0 || x == 0 || y + 1 == labels.rows || x + 1 == stride) continue;
      const auto grow = [&](int j) {
        if (cells[j] != 0) return;
        cells[j] = cells[i];
        next.push_back(j);
      };
      for (const int j : {i - 1, i + 1, i - stride, i + stride}) grow(j);
      if (slanting != 0)
        for (const int j : {i - stride - 1, i - stride + 1, i + stride - 1, i + stride + 1})
          grow(j);
    }
    front.swap(next);
  }
  return out;
}

/// Looks from a point of the free space along a line.
class Probe {
 public:
  Probe(const cv::Mat& clearance, cv::Point from) : clearance_(clearance), from_(from) {}

  /// Cells to the first one that is not free, at most `limit`.
  double toWall(double angle, double limit) const {
    const double c = std::cos(angle), s = std::sin(angle);
    double t = 0.0;
    while (t < limit) {
      const float room = at(t * c, t * s);
      if (room <= 0.0f) return t;
      t += std::max(0.5, room - 1.0);  // no wall is nearer than that
    }
    return limit;
  }

  /// Whether a mask is set at the end of a line, or one cell on.
  bool meets(const cv::Mat& mask, double angle, double end) const {
    for (const double t : {end, end + 1.0}) {
      const cv::Point p(from_.x + static_cast<int>(std::lround(t * std::cos(angle))),
                        from_.y + static_cast<int>(std::lround(t * std::sin(angle))));
      if (cv::Rect({0, 0}, mask.size()).contains(p) && mask.at<std::uint8_t>(p) != 0) return true;
    }
    return false;
  }

  /// Share of solid cells, or of their direct neighbours, from `start` on.
  double wallShare(double angle, double start, int length) const {
    const double c = std::cos(angle), s = std::sin(angle);
    int solid = 0;
    for (int i = 1; i <= length; ++i)
      if (at((start + i) * c, (start + i) * s) <= 1.5f) ++solid;
    return static_cast<double>(solid) / length;
  }

 private:
  float at(double dx, double dy) const {
    const int x = from_.x + static_cast<int>(std::lround(dx));
    const int y = from_.y + static_cast<int>(std::lround(dy));
    if (x < 0 || y < 0 || x >= clearance_.cols || y >= clearance_.rows) return 0.0f;
    return clearance_.at<float>(y, x);
  }
  const cv::Mat& clearance_;
  cv::Point from_;
};

/// The clearance of a passage by the largest near it in either basin, the lower of the two.
double evennessOf(const Passage& passage, double own, const cv::Mat& clearance,
                  const cv::Mat& labels, int a, int b, double resolution) {
  const int reach = static_cast<int>(std::lround(kBeforePassage / resolution));
  const cv::Point at = passage.at;
  float one = 0.0f, two = 0.0f;
  for (int y = std::max(0, at.y - reach); y <= std::min(labels.rows - 1, at.y + reach); ++y) {
    const int* label = labels.ptr<int>(y);
    const float* height = clearance.ptr<float>(y);
    const int up = y - at.y;
    const int side = static_cast<int>(std::sqrt(static_cast<double>(reach * reach - up * up)));
    const int end = std::min(labels.cols - 1, at.x + side);
    for (int x = std::max(0, at.x - side); x <= end; ++x) {  // without branches
      one = std::max(one, label[x] == a ? height[x] : 0.0f);
      two = std::max(two, label[x] == b ? height[x] : 0.0f);
    }
  }
  return own / (std::max(1.0f, std::min(one, two)) * resolution);
}

void measurePassage(const cv::Mat& clearance, const cv::Mat& furniture, double resolution,
                    double clearance_at_border, Passage& passage) {
  const Probe probe(clearance, passage.at);
  const double limit = 8.0 * clearance_at_border / resolution + 4.0;
  double angle = 0.0, ahead = 0.0, behind = limit, width = 1e9;
  for (int k = 0; k < kChords; ++k) {
    const double tried = k * hyselam::kPi / kChords;
    const double there = probe.toWall(tried, limit);
    if (there >= width) continue;
    const double back = probe.toWall(tried + hyselam::kPi, limit);
    if (there + back >= width) continue;
    width = there + back;
    angle = tried, ahead = there, behind = back;
  }
  passage.width = width * resolution;
  if (!furniture.empty())
    passage.furniture = (probe.meets(furniture, angle, ahead) ? 1 : 0) +
                        (probe.meets(furniture, angle + hyselam::kPi, behind) ? 1 : 0);
  const int length = std::max(1, static_cast<int>(std::ceil(kWallProbe / resolution)));
  double first = 0.0, second = 0.0;
  for (int k = -2; k <= 2; ++k) {
    const double turn = angle + k * hyselam::kPi / kChords;
    first = std::max(first, probe.wallShare(turn, ahead, length));
    second = std::max(second, probe.wallShare(turn + hyselam::kPi, behind, length));
  }
  passage.weaker_wall = std::min(first, second);
  passage.stronger_wall = std::max(first, second);
}

}  // namespace

RegionAdjacencyGraph::RegionAdjacencyGraph(const cv::Mat& clearance, const Basins& basins,
                                           double resolution, const BorderContext& context)
    : resolution_(resolution),
      nodes_(static_cast<std::size_t>(basins.count) + 1),
      merged_into_(static_cast<std::size_t>(basins.count) + 1) {
  CV_Assert(basins.labels.size() == clearance.size() && basins.labels.isContinuous());
  for (std::size_t i = 0; i < merged_into_.size(); ++i) merged_into_[i] = static_cast<int>(i);
  std::future<cv::Mat> reach = alongside([&labels = basins.labels, resolution] {
    return reachIntoWalls(labels, static_cast<int>(std::lround(kThinWall / resolution)));
  });
  measureNodes(clearance, basins.labels);
  measureCorridors(context.corridors, basins.labels);
  measureBorders(clearance, basins.labels, reach.get(), context.corridors);
  for (int a = 1; a <= size(); ++a)
    for (const auto& [b, index] : node(a).borders) {
      RegionBorder& border = borders_[static_cast<std::size_t>(index)];
      if (b < a || border.open <= 0.0) continue;
      Passage& passage = border.passage;
      measurePassage(clearance, context.furniture, resolution, border.clearance, passage);
      passage.evenness =
          evennessOf(passage, border.clearance, clearance, basins.labels, a, b, resolution);
    }
}

void RegionAdjacencyGraph::measureNodes(const cv::Mat& clearance, const cv::Mat& labels) {
  const double cell = resolution_ * resolution_;
  for (int y = 0; y < labels.rows; ++y) {
    const int* row = labels.ptr<int>(y);
    const float* heights = clearance.ptr<float>(y);
    for (int x = 0; x < labels.cols;) {
      const int label = row[x];
      const int start = x;
      if (label == 0) {
        while (x < labels.cols && row[x] == 0) ++x;
        continue;
      }
      double sum = 0.0;
      float peak = 0.0f;
      for (; x < labels.cols && row[x] == label; ++x) {
        sum += heights[x];
        peak = std::max(peak, heights[x]);
      }
      RegionNode& node = at(label);
      node.area += (x - start) * cell;
      node.clearances += sum * resolution_ * cell;
      node.peak = std::max(node.peak, peak * resolution_);
      node.hull.emplace_back(start, y);
      if (x - start > 1) node.hull.emplace_back(x - 1, y);
    }
  }
  for (int i = 1; i <= size(); ++i) setHull(at(i));
}

void RegionAdjacencyGraph::measureCorridors(const CorridorBasins& corridors,
                                            const cv::Mat& labels) {
  if (corridors.corridors.empty()) return;
  for (int y = 0; y < labels.rows; ++y) {
    const int* row = labels.ptr<int>(y);
    const std::uint16_t* corridor = corridors.of_cell.ptr<std::uint16_t>(y);
    for (int x = 0; x < labels.cols; ++x)
      if (corridor[x] != 0) at(row[x]).corridor += resolution_ * resolution_;
  }
}

void RegionAdjacencyGraph::measureBorders(const cv::Mat& clearance, const cv::Mat& labels,
                                          const cv::Mat& reach, const CorridorBasins& corridors) {
  const int stride = labels.cols;
  const int* cells = labels.ptr<int>();
  const int* near = reach.ptr<int>();
  const float* heights = clearance.ptr<float>();
  const bool cut = !corridors.corridors.empty();
  const std::uint16_t* of_cell = cut ? corridors.of_cell.ptr<std::uint16_t>() : nullptr;
  const std::uint16_t* before = cut ? corridors.before.ptr<std::uint16_t>() : nullptr;
  /// Adds a piece of border where it leaves a corridor.
  const auto leaveCorridor = [&](int i, int j, RegionBorder& border) {
    if (of_cell[i] != 0 && of_cell[i] == of_cell[j]) border.within += resolution_;
    if ((of_cell[i] == 0) == (of_cell[j] == 0)) {
      // Two corridors that share a basin meet with nothing between them.
      if (of_cell[i] != of_cell[j] && before[i] == before[j]) border.ending += resolution_;
      return;
    }
    const int outside = of_cell[i] == 0 ? i : j;
    const StraightCorridor& corridor = corridors.corridors[of_cell[outside == i ? j : i] - 1u];
    if (corridor.beside(cv::Point2d(outside % stride, outside / stride)))
      border.beside += resolution_;
    else if (before[i] == before[j])
      border.ending += resolution_;
  };
  const auto meet = [&](int i, int j) {
    const int a = cells[i], b = cells[j];
    if (a != b) {
      if (a != 0) at(a).perimeter += resolution_;
      if (b != 0) at(b).perimeter += resolution_;
      if (a != 0 && b != 0) {
        RegionBorder& border = between(a, b);
        border.open += resolution_;
        if (cut) leaveCorridor(i, j, border);
        const double height = std::min(heights[i], heights[j]) * resolution_;
        if (height > border.clearance) {
          border.clearance = height;
          border.passage.at = {i % stride, i / stride};
        }
        return;
      }
    }
    if (near[i] != near[j] && near[i] != 0 && near[j] != 0)
      between(near[i], near[j]).wall += resolution_;
  };
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(stride), 0);
  for (int y = 0; y + 1 < labels.rows; ++y) {
    const int* own = cells + y * stride;
    const int* reached = near + y * stride;
    for (int x = 0; x + 1 < stride; ++x)
      marks[static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(
          (own[x] != own[x + 1]) | (own[x] != own[x + stride]) | (reached[x] != reached[x + 1]) |
          (reached[x] != reached[x + stride]));
    eachMarked(marks, [&](int x) {
      const int i = y * stride + x;
      if (near[i] != near[i + 1] || cells[i] != cells[i + 1]) meet(i, i + 1);
      if (near[i] != near[i + stride] || cells[i] != cells[i + stride]) meet(i, i + stride);
    });
  }
}

RegionBorder& RegionAdjacencyGraph::between(int a, int b) {
  const auto [found, fresh] = at(a).borders.emplace(b, static_cast<int>(borders_.size()));
  if (fresh) {
    at(b).borders.emplace(a, found->second);
    borders_.emplace_back();
  }
  return borders_[static_cast<std::size_t>(found->second)];
}

void RegionAdjacencyGraph::setHull(RegionNode& node) const {
  std::vector<cv::Point> hull;
  cv::convexHull(node.hull, hull);
  node.hull.swap(hull);
  node.hull_area =
      node.hull.size() < 3 ? 0.0 : cv::contourArea(node.hull) * resolution_ * resolution_;
}

void RegionAdjacencyGraph::merge(int kept, int gone) {
  RegionNode& to = at(kept);
  RegionNode& from = at(gone);
  const int own = to.borders.at(gone);
  to.area += from.area;
  to.clearances += from.clearances;
  to.corridor += from.corridor;
  to.peak = std::max(to.peak, from.peak);
  to.perimeter += from.perimeter - 2.0 * border(own).open;
  to.hull.insert(to.hull.end(), from.hull.begin(), from.hull.end());
  setHull(to);
  to.borders.erase(gone);
  for (const auto& [neighbour, index] : from.borders) {
    if (neighbour == kept) continue;
    RegionNode& other = at(neighbour);
    other.borders.erase(gone);
    const auto [found, fresh] = to.borders.emplace(neighbour, index);
    if (fresh) {
      other.borders[kept] = index;
      continue;
    }
    RegionBorder& joined = borders_[static_cast<std::size_t>(found->second)];
    const RegionBorder& added = border(index);
    joined.open += added.open;
    joined.beside += added.beside;
    joined.ending += added.ending;
    joined.within += added.within;
    joined.wall += added.wall;
    if (added.clearance > joined.clearance) {
      joined.clearance = added.clearance;
      joined.passage = added.passage;
    }
  }
  from = RegionNode();
  from.alive = false;
  merged_into_[static_cast<std::size_t>(gone)] = kept;
}

int RegionAdjacencyGraph::root(int basin) const {
  while (merged_into_[static_cast<std::size_t>(basin)] != basin)
    basin = merged_into_[static_cast<std::size_t>(basin)];
  return basin;
}

}  // namespace hyselam_topo
