#include "basins.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

namespace hyselam_topo {
namespace {

/// Sets with the index of one of their members as name.
class Sets {
 public:
  int add() {
    parents_.push_back(static_cast<int>(parents_.size()));
    return parents_.back();
  }
  int find(int i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  void join(int into, int other) { parent(other) = into; }

 private:
  int& parent(int i) { return parents_[static_cast<std::size_t>(i)]; }
  std::vector<int> parents_;
};

/// The first from `i` on that is not 0, or `end`: most of many maps is not free.
int nextFree(const int* cells, int i, int end) {
  constexpr int kBlock = 8;
  static constexpr int kZeros[kBlock] = {};
  if (i < end && cells[i] != 0) return i;
  while (i + kBlock <= end && std::memcmp(cells + i, kZeros, sizeof(kZeros)) == 0) i += kBlock;
  while (i < end && cells[i] == 0) ++i;
  return i;
}

/// A cell that is free first has 1 + the cell to climb to, then -1 - its peak.
int peakOf(int cell) {
  return -1 - cell;
}

/// For each free cell 1 + the highest of itself and its neighbours; of equal ones the first in
/// memory, which makes a strict order of all cells, so that no way up runs in a circle. 0: not
/// free.
cv::Mat waysUp(const cv::Mat& clearance) {
  cv::Mat up(clearance.size(), CV_32S, cv::Scalar(0));
  const int stride = clearance.cols;
  for (int y = 1; y + 1 < clearance.rows; ++y) {
    const float* row = clearance.ptr<float>(y);
    int* out = up.ptr<int>(y);
    for (int x = 1; x + 1 < stride; ++x) {
      const float* c = row + x;
      const float own = *c;
      if (own <= 0.0f) continue;
      const bool left = c[-1] > 0, right = c[1] > 0, below = c[-stride] > 0, above = c[stride] > 0;
      float best = own;
      int offset = 0;
      // In the order of memory: before the cell equal is enough, behind it only more.
      if ((left || below) && c[-stride - 1] >= best) best = c[-stride - 1], offset = -stride - 1;
      if (c[-stride] > best || (c[-stride] == best && offset == 0))
        best = c[-stride], offset = -stride;
      if ((right || below) && (c[-stride + 1] > best || (c[-stride + 1] == best && offset == 0)))
        best = c[-stride + 1], offset = -stride + 1;
      if (c[-1] > best || (c[-1] == best && offset == 0)) best = c[-1], offset = -1;
      if (c[1] > best) best = c[1], offset = 1;
      if ((left || above) && c[stride - 1] > best) best = c[stride - 1], offset = stride - 1;
      if (c[stride] > best) best = c[stride], offset = stride;
      if ((right || above) && c[stride + 1] > best) offset = stride + 1;
      out[x] = 1 + y * stride + x + offset;
    }
  }
  return up;
}

struct Saddle {
  float height;
  int a, b;  // peaks
};

/// The peaks of the clearance, joined where they are one basin or connected at all.
struct Peaks {
  Sets basins, parts;
  std::vector<float> heights;
  std::vector<double> sizes;  // of the basin of each peak, later of its part [cells]
};

/// Climbs from each cell to its peak, which it has from then on.
Peaks findPeaks(int* cells, const float* heights, int total) {
  Peaks peaks;
  std::vector<int> path;
  for (int i = nextFree(cells, 0, total); i < total; i = nextFree(cells, i + 1, total)) {
    if (cells[i] < 0) continue;
    int top = i;
    while (cells[top] > 0 && cells[top] - 1 != top) {
      path.push_back(top);
      top = cells[top] - 1;
    }
    if (cells[top] > 0) {
      cells[top] = -1 - peaks.basins.add();
      peaks.parts.add();
      peaks.heights.push_back(heights[top]);
      peaks.sizes.push_back(0.0);
    }
    peaks.sizes[static_cast<std::size_t>(peakOf(cells[top]))] +=
        1.0 + static_cast<double>(path.size());
    for (const int cell : path) cells[cell] = cells[top];
    path.clear();
  }
  return peaks;
}

/// Where cells of two peaks touch, the highest first.
std::vector<Saddle> findSaddles(const int* cells, const float* heights, int total, int stride) {
  std::vector<Saddle> saddles;
  const int end = total - stride;
  for (int i = nextFree(cells, 0, end); i < end; i = nextFree(cells, i + 1, end)) {
    for (const int j : {i + 1, i + stride}) {
      if (cells[j] == 0 || cells[j] == cells[i]) continue;
      const auto [a, b] = std::minmax({peakOf(cells[i]), peakOf(cells[j])});
      const float height = std::min(heights[i], heights[j]);
      // Borders are followed along rows: the last saddle is often of the same pair.
      if (!saddles.empty() && saddles.back().a == a && saddles.back().b == b)
        saddles.back().height = std::max(saddles.back().height, height);
      else
        saddles.push_back({height, a, b});
    }
  }
  std::stable_sort(saddles.begin(), saddles.end(),
                   [](const Saddle& s, const Saddle& t) { return s.height > t.height; });
  return saddles;
}

/// Joins basins over saddles that are shallow or nearly as high as the lower peak.
void joinBasins(const std::vector<Saddle>& saddles, double resolution, const BasinParams& params,
                Peaks& peaks) {
  const auto peak = [&](int set) { return peaks.heights[static_cast<std::size_t>(set)]; };
  for (const Saddle& saddle : saddles) {
    const int p = peaks.parts.find(saddle.a), q = peaks.parts.find(saddle.b);
    if (p != q) {
      peaks.parts.join(p, q);
      peaks.sizes[static_cast<std::size_t>(p)] += peaks.sizes[static_cast<std::size_t>(q)];
    }
    int a = peaks.basins.find(saddle.a), b = peaks.basins.find(saddle.b);
    if (a == b) continue;
    if (peak(a) < peak(b)) std::swap(a, b);
    if ((peak(b) - saddle.height) * resolution < params.shallow ||
        saddle.height > params.level * peak(b)) {
      peaks.basins.join(a, b);
    }
  }
}

}  // namespace

Basins findBasins(cv::Mat& clearance, double resolution, const BasinParams& params) {
  CV_Assert(clearance.type() == CV_32F && clearance.isContinuous());
  cv::Mat labels = waysUp(clearance);  // then peaks, then basins
  int* cells = labels.ptr<int>();
  float* heights = clearance.ptr<float>();
  const int total = static_cast<int>(labels.total());
  Peaks peaks = findPeaks(cells, heights, total);
  joinBasins(findSaddles(cells, heights, total, labels.cols), resolution, params, peaks);

  Basins basins;
  std::vector<int> names(peaks.heights.size(), -1), of_peak(peaks.heights.size(), -1);
  const double smallest = params.smallest / (resolution * resolution);
  for (int i = nextFree(cells, 0, total); i < total; i = nextFree(cells, i + 1, total)) {
    const int peak_index = peakOf(cells[i]);
    int& known = of_peak[static_cast<std::size_t>(peak_index)];
    if (known < 0) {
      int& name = names[static_cast<std::size_t>(peaks.basins.find(peak_index))];
      if (name < 0) {
        const double size = peaks.sizes[static_cast<std::size_t>(peaks.parts.find(peak_index))];
        name = size < smallest ? 0 : ++basins.count;
      }
      known = name;
    }
    cells[i] = known;
    if (known == 0) heights[i] = 0.0f;
  }
  basins.labels = labels;
  return basins;
}

}  // namespace hyselam_topo
