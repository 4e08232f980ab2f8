// Alg. 3.1 and Alg. 6.1 as the thesis writes them, with a queue over cells. The oracles of
// FreeSpaceDensity; slow on purpose.
#pragma once

#include <cmath>
#include <optional>
#include <queue>
#include <vector>

#include "fsd_localization/density/kernel.hpp"

namespace transcription {

/// A grid of cells that are free, unknown or occupied; outside is occupied.
struct Cells {
  enum State : char { kFree, kUnknown, kOccupied };
  int width = 0;
  int height = 0;
  std::vector<State> state;
  State at(int x, int y) const {
    if (x < 0 || y < 0 || x >= width || y >= height) return kOccupied;
    return state[static_cast<std::size_t>(y * width + x)];
  }
};

struct Fsd {
  double soft = 0.0;
  std::optional<double> hard = 0.0;
};

struct Offset {
  int dx, dy;
};

inline bool inside(const Cells& m, int x, int y) {
  return x >= 0 && y >= 0 && x < m.width && y < m.height;
}

/// Of both algorithms: the neighbors that were not processed yet.
inline void pushNeighbors(const Cells& m, int x, int y, std::vector<char>* processed,
                          std::queue<std::pair<int, int>>* q) {
  for (const Offset n : {Offset{0, 1}, Offset{1, 0}, Offset{0, -1}, Offset{-1, 0}}) {
    const int nx = x + n.dx, ny = y + n.dy;
    if (!inside(m, nx, ny)) continue;
    char& mark = (*processed)[static_cast<std::size_t>(ny * m.width + nx)];
    if (mark != 0) continue;
    mark = 1;
    q->push({nx, ny});
  }
}

/// Alg. 3.1. `unknown_is_free` gives the upper bound.
inline Fsd freeSpaceDensity(const Cells& m, int x0, int y0, const fsd_localization::Kernel& kernel,
                            bool unknown_is_free = false) {
  Fsd result;
  const double h = kernel.radius();
  std::vector<char> processed(static_cast<std::size_t>(m.width * m.height), 0);
  std::queue<std::pair<int, int>> q;
  q.push({x0, y0});
  processed[static_cast<std::size_t>(y0 * m.width + x0)] = 1;
  bool undefined = false;
  while (!q.empty()) {
    const auto [x, y] = q.front();
    q.pop();
    const double d = std::sqrt(static_cast<double>((x - x0) * (x - x0) + (y - y0) * (y - y0)));
    if (!(d < h)) continue;
    const Cells::State s = m.at(x, y);
    if (s == Cells::kFree || (unknown_is_free && s == Cells::kUnknown)) {
      result.soft += kernel.weight(x - x0, y - y0);
      pushNeighbors(m, x, y, &processed, &q);
    } else if (s == Cells::kUnknown) {
      undefined = true;
    }
  }
  result.hard = undefined ? std::nullopt : std::optional<double>(result.soft);
  return result;
}

/// The same on a copy of the cells that the kernel can reach, so that a large map costs nothing
/// extra.
inline Fsd freeSpaceDensityNear(const Cells& m, int x0, int y0,
                                const fsd_localization::Kernel& kernel) {
  const int h = kernel.radius();
  Cells near;
  near.width = near.height = 2 * h + 1;
  near.state.reserve(static_cast<std::size_t>(near.width * near.height));
  for (int y = y0 - h; y <= y0 + h; ++y) {
    for (int x = x0 - h; x <= x0 + h; ++x) near.state.push_back(m.at(x, y));
  }
  return freeSpaceDensity(near, h, h, kernel);
}

/// Alg. 6.1, frontiers 8-connected, larger than `min_share` of the kernel's perimeter.
inline int frontiers(const Cells& m, int x0, int y0, int h, double min_share) {
  std::vector<char> processed(static_cast<std::size_t>(m.width * m.height), 0);
  std::vector<std::pair<int, int>> border;
  std::queue<std::pair<int, int>> q;
  q.push({x0, y0});
  processed[static_cast<std::size_t>(y0 * m.width + x0)] = 1;
  while (!q.empty()) {
    const auto [x, y] = q.front();
    q.pop();
    if (m.at(x, y) != Cells::kFree) continue;
    const double d = std::sqrt(static_cast<double>((x - x0) * (x - x0) + (y - y0) * (y - y0)));
    if (d < h) {
      pushNeighbors(m, x, y, &processed, &q);
    } else {
      border.push_back({x, y});
    }
  }
  int count = 0;
  const double min_size = min_share * 2.0 * 3.14159265358979323846 * h;
  while (!border.empty()) {
    std::vector<std::pair<int, int>> group, open{border.front()};
    border.erase(border.begin());
    while (!open.empty()) {
      const auto cell = open.back();
      open.pop_back();
      group.push_back(cell);
      for (std::size_t i = 0; i < border.size();) {
        if (std::abs(border[i].first - cell.first) <= 1 &&
            std::abs(border[i].second - cell.second) <= 1) {
          open.push_back(border[i]);
          border.erase(border.begin() + static_cast<std::ptrdiff_t>(i));
        } else {
          ++i;
        }
      }
    }
    if (static_cast<double>(group.size()) > min_size) ++count;
  }
  return count;
}

}  // namespace transcription
