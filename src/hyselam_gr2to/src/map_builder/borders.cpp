#include "hyselam_gr2to/map_builder/borders.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <tuple>

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

void farthest(const std::vector<cv::Point>& from, Border* border) {
  std::int64_t best = -1;
  // Long closed lines are thinned: their ends need not be exact.
  const std::size_t step = from.size() / 512 + 1;
  for (std::size_t i = 0; i < from.size(); i += step) {
    for (std::size_t j = i; j < from.size(); j += step) {
      const std::int64_t dx = from[i].x - from[j].x, dy = from[i].y - from[j].y;
      if (dx * dx + dy * dy <= best) continue;
      best = dx * dx + dy * dy;
      border->first = from[i];
      border->last = from[j];
    }
  }
}

}  // namespace

std::vector<Border> findBorders(const cv::Mat& labels) {
  if (labels.type() != CV_16UC1) throw std::invalid_argument("labels must be 16 bit");
  const std::vector<Side> sides = sidesBetween(labels);
  std::vector<Border> out;
  for (std::size_t begin = 0; begin < sides.size();) {
    std::size_t end = begin;
    while (end < sides.size() && sides[end].a == sides[begin].a && sides[end].b == sides[begin].b) {
      ++end;
    }
    // Corners with the sides that meet in them.
    std::vector<std::pair<cv::Point, std::size_t>> corners;
    for (std::size_t i = begin; i < end; ++i) {
      corners.push_back({sides[i].from, i});
      corners.push_back({sides[i].to, i});
    }
    std::stable_sort(corners.begin(), corners.end(),
                     [](const auto& p, const auto& q) { return before(p.first, q.first); });
    std::vector<std::size_t> parent(end - begin);
    for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = i;
    const auto root = [&](std::size_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    for (std::size_t i = 1; i < corners.size(); ++i) {
      if (corners[i].first != corners[i - 1].first) continue;
      const std::size_t p = root(corners[i].second - begin),
                        q = root(corners[i - 1].second - begin);
      parent[std::max(p, q)] = std::min(p, q);
    }
    std::vector<std::size_t> number(parent.size(), parent.size());
    const std::size_t offset = out.size();
    std::vector<std::vector<cv::Point>> ends;
    for (std::size_t i = 0; i < corners.size();) {
      std::size_t next = i;
      while (next < corners.size() && corners[next].first == corners[i].first) ++next;
      const std::size_t r = root(corners[i].second - begin);
      if (number[r] == parent.size()) {
        number[r] = out.size() - offset;
        Border border;
        border.a = sides[begin].a;
        border.b = sides[begin].b;
        out.push_back(border);
        ends.emplace_back();
      }
      Border& border = out[offset + number[r]];
      border.points.push_back(corners[i].first);
      border.length += static_cast<int>(next - i);  // twice
      if ((next - i) % 2 == 1) ends[number[r]].push_back(corners[i].first);
      i = next;
    }
    for (std::size_t k = 0; k < ends.size(); ++k) {
      Border& border = out[offset + k];
      border.length /= 2;
      border.closed = ends[k].empty();
      farthest(border.closed ? border.points : ends[k], &border);
    }
    begin = end;
  }
  return out;
}

}  // namespace hyselam_topo
