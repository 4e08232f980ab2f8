#include "number_places.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "cell_runs.hpp"

namespace hyselam_topo {
namespace {

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

/// The label that each piece is to have: 0 for all but the largest of a label.
std::vector<int> largestPieces(const CellRuns& cells) {
  std::vector<int> sizes(index(cells.pieces), 0), labels(index(cells.pieces), 0);
  for (const CellRun& run : cells.runs) {
    sizes[index(run.piece)] += run.last - run.first + 1;
    labels[index(run.piece)] = run.value;
  }
  std::vector<int> largest(std::numeric_limits<std::uint16_t>::max() + std::size_t{1}, -1);
  for (int piece = 0; piece < cells.pieces; ++piece) {
    int& best = largest[index(labels[index(piece)])];
    if (best < 0 || sizes[index(piece)] > sizes[index(best)]) best = piece;
  }
  for (int piece = 0; piece < cells.pieces; ++piece) {
    if (largest[index(labels[index(piece)])] == piece) continue;
    labels[index(piece)] = 0;
  }
  return labels;
}

/// Pieces without a label get that of a neighbor, until nothing changes: they are few and small.
void joinNeighbors(const CellRuns& cells, std::vector<int>& labels) {
  bool changed = true;
  const auto touch = [&](const CellRun& run, const CellRun& other) {
    int& own = labels[index(run.piece)];
    const int theirs = labels[index(other.piece)];
    if (own == 0 && theirs != 0) own = theirs, changed = true;
  };
  while (changed) {
    changed = false;
    for (std::size_t y = 0; y + 1 < cells.rows.size(); ++y) {
      std::size_t below = y > 0 ? cells.rows[y - 1] : cells.rows[y];
      for (std::size_t i = cells.rows[y]; i < cells.rows[y + 1]; ++i) {
        const CellRun& run = cells.runs[i];
        if (i > cells.rows[y] && cells.runs[i - 1].last + 1 == run.first) {
          touch(run, cells.runs[i - 1]);
          touch(cells.runs[i - 1], run);
        }
        while (below < cells.rows[y] && cells.runs[below].last < run.first) ++below;
        for (std::size_t j = below; j < cells.rows[y] && cells.runs[j].first <= run.last; ++j) {
          touch(run, cells.runs[j]);
          touch(cells.runs[j], run);
        }
      }
    }
  }
}

}  // namespace

int numberPlaces(cv::Mat& labels) {
  const CellRuns cells = connectedRuns(labels, 0, false);
  std::vector<int> becomes = largestPieces(cells);
  if (std::count(becomes.begin(), becomes.end(), 0) > 0) joinNeighbors(cells, becomes);
  std::vector<int> names(std::numeric_limits<std::uint16_t>::max() + std::size_t{1}, 0);
  int count = 0;
  for (const CellRun& run : cells.runs) {
    const int label = becomes[index(run.piece)];
    int name = 0;
    if (label != 0) {
      int& slot = names[index(label)];
      if (slot == 0) slot = ++count;
      name = slot;
    }
    if (name == run.value) continue;
    std::uint16_t* row = labels.ptr<std::uint16_t>(run.y);
    std::fill(row + run.first, row + run.last + 1, static_cast<std::uint16_t>(name));
  }
  return count;
}

}  // namespace hyselam_topo
