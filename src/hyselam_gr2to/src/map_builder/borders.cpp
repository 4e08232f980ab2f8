#include "hyselam_gr2to/map_builder/borders.hpp"

#include <algorithm>
#include <cstdint>
#include <tuple>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/union_find.hpp"

namespace hyselam_topo {
namespace {

// One side of a cell with different labels on it.
struct Side {
  std::uint16_t a, b;
  cv::Point from, to;
};

bool before(const cv::Point& p, const cv::Point& q) {
  return p.y != q.y ? p.y < q.y : p.x < q.x;
}

std::vector<Side> sidesBetween(const cv::Mat& labels) {
  std::vector<Side> sides;
  const auto add = [&](std::uint16_t p, std::uint16_t q, cv::Point from, cv::Point to) {
    if (p != q && p != 0 && q != 0) sides.push_back({std::min(p, q), std::max(p, q), from, to});
  };
  for (int y = 0; y < labels.rows; ++y) {
    const auto* row = labels.ptr<std::uint16_t>(y);
    const auto* above = y + 1 < labels.rows ? labels.ptr<std::uint16_t>(y + 1) : nullptr;
    for (int x = 0; x < labels.cols; ++x) {
      if (row[x] == 0) continue;
      if (x + 1 < labels.cols) add(row[x], row[x + 1], {x + 1, y}, {x + 1, y + 1});
      if (above != nullptr) add(row[x], above[x], {x, y + 1}, {x + 1, y + 1});
    }
  }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return std::tie(s.a, s.b) < std::tie(t.a, t.b);
  });
  return sides;
}

/// A corner of cells, and a side between two labels that ends in it.
struct Corner {
  cv::Point at;
  int side;
};

/// The corners of sides, those at one point one after another, sorted by y, then x.
std::vector<Corner> cornersOf(const std::vector<Side>& sides) {
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    corners.push_back({sides[i].from, static_cast<int>(i)});
    corners.push_back({sides[i].to, static_cast<int>(i)});
  }
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& p, const Corner& q) { return before(p.at, q.at); });
  return corners;
}

/// Sides that meet in a corner belong to one line.
hyselam::UnionFind connectedSides(const std::vector<Corner>& corners, std::size_t sides) {
  hyselam::UnionFind lines(sides);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (corners[i].at == corners[i - 1].at) lines.unite(corners[i].side, corners[i - 1].side);
  }
  return lines;
}

/// Sets the ends of a border to the two points that are farthest apart.
void setEnds(const std::vector<cv::Point>& points, Border& border) {
  std::int64_t best = -1;
  // Long closed lines are thinned: their ends need not be exact.
  const std::size_t step = points.size() / 512 + 1;
  for (std::size_t i = 0; i < points.size(); i += step) {
    for (std::size_t j = i; j < points.size(); j += step) {
      const std::int64_t dx = points[i].x - points[j].x, dy = points[i].y - points[j].y;
      if (dx * dx + dy * dy <= best) continue;
      best = dx * dx + dy * dy;
      border.first = points[i];
      border.last = points[j];
    }
  }
}

/// The connected lines of the sides between two labels, in the order of their lowest points.
std::vector<Border> bordersAlong(const std::vector<Side>& sides) {
  const std::vector<Corner> corners = cornersOf(sides);
  hyselam::UnionFind lines = connectedSides(corners, sides.size());
  std::vector<int> border_of_line(sides.size(), -1);
  std::vector<Border> borders;
  std::vector<std::vector<cv::Point>> ends;  // corners in which an odd number of sides meet
  for (std::size_t i = 0; i < corners.size();) {
    std::size_t next = i;
    while (next < corners.size() && corners[next].at == corners[i].at) ++next;
    int& index = border_of_line[static_cast<std::size_t>(lines.find(corners[i].side))];
    if (index < 0) {
      index = static_cast<int>(borders.size());
      borders.emplace_back();
      borders.back().a = sides.front().a;
      borders.back().b = sides.front().b;
      ends.emplace_back();
    }
    Border& border = borders[static_cast<std::size_t>(index)];
    border.points.push_back(corners[i].at);
    border.length += static_cast<int>(next - i);  // each side twice, in both of its corners
    if ((next - i) % 2 == 1) ends[static_cast<std::size_t>(index)].push_back(corners[i].at);
    i = next;
  }
  for (std::size_t k = 0; k < borders.size(); ++k) {
    borders[k].length /= 2;
    borders[k].closed = ends[k].empty();
    setEnds(borders[k].closed ? borders[k].points : ends[k], borders[k]);
  }
  return borders;
}

}  // namespace

std::vector<Border> findBorders(const cv::Mat& labels) {
  if (labels.type() != CV_16UC1) throw hyselam::InputError("labels", "", "they are not 16 bit");
  const std::vector<Side> sides = sidesBetween(labels);
  std::vector<Border> borders;
  for (auto begin = sides.begin(); begin != sides.end();) {
    const auto end = std::find_if(begin, sides.end(), [&](const Side& side) {
      return side.a != begin->a || side.b != begin->b;
    });
    for (Border& border : bordersAlong({begin, end})) borders.push_back(std::move(border));
    begin = end;
  }
  return borders;
}

}  // namespace hyselam_topo
