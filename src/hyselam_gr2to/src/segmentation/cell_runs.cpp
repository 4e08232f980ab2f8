#include "cell_runs.hpp"

#include <algorithm>
#include <cstdint>

namespace hyselam_topo {
namespace {

template <typename Cell>
void addRuns(const cv::Mat& cells, int y, int none, std::vector<CellRun>& runs) {
  const Cell* row = cells.ptr<Cell>(y);
  const Cell* const end = row + cells.cols;
  for (const Cell* cell = row; cell != end;) {
    const Cell value = *cell;
    const Cell* const first = cell;
    while (cell != end && *cell == value) ++cell;
    if (value != none)
      runs.push_back(
          {y, static_cast<int>(first - row), static_cast<int>(cell - row) - 1, value, 0});
  }
}

}  // namespace

CellRuns connectedRuns(const cv::Mat& cells, int none, bool corners) {
  CV_Assert(cells.type() == CV_8U || cells.type() == CV_16U);
  CellRuns out;
  std::vector<int> parents;
  const auto find = [&parents](int i) {
    while (parents[static_cast<std::size_t>(i)] != i) {
      int& p = parents[static_cast<std::size_t>(i)];
      p = parents[static_cast<std::size_t>(p)];
      i = p;
    }
    return i;
  };
  const int reach = corners ? 1 : 0;
  std::size_t before = 0;
  for (int y = 0; y < cells.rows; ++y) {
    const std::size_t begin = out.runs.size();
    out.rows.push_back(begin);
    if (cells.type() == CV_8U)
      addRuns<std::uint8_t>(cells, y, none, out.runs);
    else
      addRuns<std::uint16_t>(cells, y, none, out.runs);
    std::size_t k = before;
    for (std::size_t i = begin; i < out.runs.size(); ++i) {
      CellRun& run = out.runs[i];
      run.piece = static_cast<int>(i);
      parents.push_back(run.piece);
      while (k < begin && out.runs[k].last + reach < run.first) ++k;
      for (std::size_t j = k; j < begin && out.runs[j].first <= run.last + reach; ++j) {
        if (out.runs[j].value != run.value) continue;
        const int a = find(static_cast<int>(j)), b = find(run.piece);
        parents[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
    }
    before = begin;
  }
  out.rows.push_back(out.runs.size());
  // A piece is named after its first run, which comes before all its others.
  for (CellRun& run : out.runs) {
    const int root = find(run.piece);
    run.piece = root == run.piece ? out.pieces++ : out.runs[static_cast<std::size_t>(root)].piece;
  }
  return out;
}

}  // namespace hyselam_topo
