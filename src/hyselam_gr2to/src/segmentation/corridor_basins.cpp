#include "corridor_basins.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "cell_runs.hpp"

namespace hyselam_topo {
namespace {

constexpr double kFurther = 4.0;     // [m] that a corridor goes on beyond its ends
constexpr double kAsWide = 1.6;      // clearance of a basin in which it may, in half widths
constexpr double kReachesOut = 1.0;  // [m^2] of a basin at the side of a corridor, at least
constexpr double kScrap = 0.5;       // [m^2] what is left of a basin beside a corridor, at least
constexpr double kNiche = 1.5;       // [m] deep at least: doorways in thick walls are no places

/// The largest clearance of each basin [cells].
std::vector<float> peaksOf(const Basins& basins, const cv::Mat& clearance) {
  std::vector<float> peaks(static_cast<std::size_t>(basins.count) + 1, 0.0f);
  for (int y = 0; y < clearance.rows; ++y) {
    const int* label = basins.labels.ptr<int>(y);
    const float* height = clearance.ptr<float>(y);
    for (int x = 0; x < clearance.cols; ++x) {
      float& peak = peaks[static_cast<std::size_t>(label[x])];
      peak = std::max(peak, height[x]);
    }
  }
  return peaks;
}

/// Marks the cells of each corridor that none before it has. At its ends a corridor goes on through
/// basins that it has a part of and that are about as wide, since a cut across would part what no
/// wall does.
class Painter {
 public:
  Painter(const Basins& basins, const cv::Mat& clearance, double resolution)
      : labels_(basins.labels),
        peaks_(peaksOf(basins, clearance)),
        further_(kFurther / resolution),
        of_cell_(basins.labels.size(), CV_16U, cv::Scalar(0)) {}

  void paint(const StraightCorridor& c, std::uint16_t name) {
    std::vector<char> own(peaks_.size(), 0);
    visit(c, 0.0, [&](int label, std::uint16_t& cell) {
      cell = name;
      const auto basin = static_cast<std::size_t>(label);
      own[basin] = peaks_[basin] <= kAsWide * c.halfWidth() ? 1 : 0;
    });
    visit(c, further_, [&](int label, std::uint16_t& cell) {
      if (own[static_cast<std::size_t>(label)] != 0) cell = name;
    });
  }
  const cv::Mat& ofCell() const { return of_cell_; }

 private:
  /// Free cells of no corridor between the lines, up to `beyond` the ends.
  template <typename Visit>
  void visit(const StraightCorridor& c, double beyond, Visit visit) {
    const double reach = c.halfWidth() + beyond + 1.0;
    const auto row = [this](double y) {
      return static_cast<int>(std::clamp(y, 0.0, static_cast<double>(labels_.rows)));
    };
    const int end = row(std::max(c.start().y, c.end().y) + reach + 1.0);
    for (int y = row(std::min(c.start().y, c.end().y) - reach); y < end; ++y) {
      const int* label = labels_.ptr<int>(y);
      std::uint16_t* out = of_cell_.ptr<std::uint16_t>(y);
      const auto [begin, last] = c.columns(y, beyond, labels_.cols);
      for (int x = begin; x < last; ++x) {
        if (label[x] == 0 || out[x] != 0) continue;
        const double far = c.beyond(cv::Point2d(x, y));
        if (far >= 0.0 && far <= beyond) visit(label[x], out[x]);
      }
    }
  }

  const cv::Mat& labels_;
  std::vector<float> peaks_;
  double further_;
  cv::Mat of_cell_;
};

/// The corridors that each basin has a part in.
std::vector<std::vector<std::uint16_t>> corridorsOf(const cv::Mat& of_cell, const Basins& basins,
                                                    std::vector<int>& inside) {
  std::vector<std::vector<std::uint16_t>> of_basin(inside.size());
  for (int y = 0; y < basins.labels.rows; ++y) {
    const int* label = basins.labels.ptr<int>(y);
    const std::uint16_t* corridor = of_cell.ptr<std::uint16_t>(y);
    for (int x = 0; x < basins.labels.cols; ++x) {
      if (corridor[x] == 0) continue;
      const auto basin = static_cast<std::size_t>(label[x]);
      ++inside[basin];
      auto& known = of_basin[basin];
      const auto own = static_cast<std::uint16_t>(corridor[x] - 1);
      if (std::find(known.begin(), known.end(), own) == known.end()) known.push_back(own);
    }
  }
  return of_basin;
}

/// How far a cell lies out of the side of the nearest of some corridors [cells]; -1: beside none.
double asideOf(const std::vector<StraightCorridor>& corridors,
               const std::vector<std::uint16_t>& some, cv::Point2d cell) {
  double nearest = -1.0;
  for (const std::uint16_t k : some) {
    const double far = corridors[k].aside(cell);
    if (far >= 0.0 && (nearest < 0.0 || far < nearest)) nearest = far;
  }
  return nearest;
}

/// What reaches out of the sides of corridors.
struct Reach {
  std::vector<std::vector<std::uint16_t>> corridors;  ///< that a basin has a part in
  std::vector<char> to_cut;                           ///< of each basin
};

/// Basins that reach out of the side of a corridor. Where all are within, or beyond the ends, there
/// is nothing to cut.
Reach reachOut(const CorridorBasins& cut, const Basins& basins, double resolution) {
  const auto size = static_cast<std::size_t>(basins.count) + 1;
  std::vector<int> inside(size, 0), beside(size, 0);
  Reach reach{corridorsOf(cut.of_cell, basins, inside), std::vector<char>(size, 0)};
  const double least = kReachesOut / (resolution * resolution);
  for (int y = 0; y < basins.labels.rows; ++y) {
    const int* label = basins.labels.ptr<int>(y);
    const std::uint16_t* corridor = cut.of_cell.ptr<std::uint16_t>(y);
    for (int x = 0; x < basins.labels.cols; ++x) {
      const auto basin = static_cast<std::size_t>(label[x]);
      if (corridor[x] != 0 || inside[basin] < 0.5 * least || beside[basin] >= least) continue;
      if (asideOf(cut.corridors, reach.corridors[basin], cv::Point2d(x, y)) >= 0.0) ++beside[basin];
    }
  }
  for (std::size_t i = 1; i < size; ++i)
    reach.to_cut[i] = inside[i] >= 0.5 * least && beside[i] >= least ? 1 : 0;
  return reach;
}

}  // namespace

CorridorBasins cutAlongCorridors(std::vector<StraightCorridor> corridors, const cv::Mat& clearance,
                                 double resolution, Basins& basins) {
  CorridorBasins cut;
  cut.corridors = std::move(corridors);
  if (cut.corridors.empty() || basins.count > std::numeric_limits<std::uint16_t>::max()) return {};
  Painter painter(basins, clearance, resolution);
  for (std::size_t k = 0; k < cut.corridors.size(); ++k)
    painter.paint(cut.corridors[k], static_cast<std::uint16_t>(k + 1));
  cut.of_cell = painter.ofCell();

  const Reach reach = reachOut(cut, basins, resolution);
  const std::vector<char>& to_cut = reach.to_cut;
  // A basin that is cut: its parts in corridors have a value of their own, for each corridor.
  std::map<std::pair<int, int>, int> values;
  std::pair<int, int> last(0, 0);  // most cells are of the same as the one before
  int* part = nullptr;
  cv::Mat values_of_cells(basins.labels.size(), CV_16U);
  cut.before = cv::Mat(basins.labels.size(), CV_16U);
  int last_value = basins.count;
  for (int y = 0; y < basins.labels.rows; ++y) {
    const int* label = basins.labels.ptr<int>(y);
    const std::uint16_t* corridor = cut.of_cell.ptr<std::uint16_t>(y);
    std::uint16_t* out = values_of_cells.ptr<std::uint16_t>(y);
    std::uint16_t* before = cut.before.ptr<std::uint16_t>(y);
    for (int x = 0; x < basins.labels.cols; ++x) {
      before[x] = out[x] = static_cast<std::uint16_t>(label[x]);
      if (corridor[x] == 0 || to_cut[static_cast<std::size_t>(label[x])] == 0) continue;
      if (const std::pair<int, int> key(label[x], corridor[x]); part == nullptr || key != last) {
        last = key;
        part = &values[key];
        if (*part == 0) *part = ++last_value;
      }
      out[x] = static_cast<std::uint16_t>(*part);
    }
  }
  if (last_value > std::numeric_limits<std::uint16_t>::max()) return {};
  const auto value_count = static_cast<std::size_t>(last_value) + 1;
  const CellRuns runs = connectedRuns(values_of_cells, 0, false);
  std::vector<int> sizes(static_cast<std::size_t>(runs.pieces), 0), value_of(sizes), becomes(sizes);
  std::vector<double> depths(static_cast<std::size_t>(runs.pieces), 0.0);
  std::vector<int> largest(value_count, -1);
  for (const CellRun& run : runs.runs) {
    sizes[static_cast<std::size_t>(run.piece)] += run.last - run.first + 1;
    value_of[static_cast<std::size_t>(run.piece)] = run.value;
    if (run.value > basins.count || to_cut[static_cast<std::size_t>(run.value)] == 0) continue;
    const auto& corridors_of_basin = reach.corridors[static_cast<std::size_t>(run.value)];
    double& depth = depths[static_cast<std::size_t>(run.piece)];
    for (int x = run.first; x <= run.last; ++x)
      depth = std::max(depth, asideOf(cut.corridors, corridors_of_basin, cv::Point2d(x, run.y)));
  }
  for (int piece = 0; piece < runs.pieces; ++piece) {
    int& best = largest[static_cast<std::size_t>(value_of[static_cast<std::size_t>(piece)])];
    if (best < 0 || sizes[static_cast<std::size_t>(piece)] > sizes[static_cast<std::size_t>(best)])
      best = piece;
  }
  const double scrap = kScrap / (resolution * resolution);
  int count = 0;
  std::vector<int> name_of_value(value_count, 0);
  for (int piece = 0; piece < runs.pieces; ++piece) {
    const auto p = static_cast<std::size_t>(piece);
    const auto value = static_cast<std::size_t>(value_of[p]);
    const bool corridor = value_of[p] > basins.count;
    if (!corridor && to_cut[value] == 0) {  // basins may hang together at corners only
      if (name_of_value[value] == 0) name_of_value[value] = ++count;
      becomes[p] = name_of_value[value];
    } else if (corridor ? sizes[p] >= scrap || largest[value] == piece
                        : sizes[p] >= scrap && depths[p] >= kNiche / resolution) {
      becomes[p] = ++count;
    }
  }
  // Scraps go to what they touch, a corridor first.
  const auto isCorridor = [&](const CellRun& run) { return run.value > basins.count; };
  for (int pass = 0; pass < 4; ++pass) {
    bool changed = false;
    const auto touch = [&](const CellRun& run, const CellRun& other) {
      int& own = becomes[static_cast<std::size_t>(run.piece)];
      const int theirs = becomes[static_cast<std::size_t>(other.piece)];
      if (own != 0 || theirs == 0 || (pass < 2 && !isCorridor(other))) return;
      own = theirs;
      changed = true;
    };
    for (std::size_t y = 0; y + 1 < runs.rows.size(); ++y) {
      std::size_t below = y > 0 ? runs.rows[y - 1] : runs.rows[y];
      for (std::size_t i = runs.rows[y]; i < runs.rows[y + 1]; ++i) {
        const CellRun& run = runs.runs[i];
        if (i > runs.rows[y] && runs.runs[i - 1].last + 1 == run.first)
          touch(run, runs.runs[i - 1]), touch(runs.runs[i - 1], run);
        while (below < runs.rows[y] && runs.runs[below].last < run.first) ++below;
        for (std::size_t j = below; j < runs.rows[y] && runs.runs[j].first <= run.last; ++j)
          touch(run, runs.runs[j]), touch(runs.runs[j], run);
      }
    }
    if (!changed && pass >= 2) break;
  }
  for (int& name : becomes)
    if (name == 0) name = ++count;  // alone
  for (const CellRun& run : runs.runs) {
    int* row = basins.labels.ptr<int>(run.y);
    std::fill(row + run.first, row + run.last + 1, becomes[static_cast<std::size_t>(run.piece)]);
  }
  basins.count = count;
  return cut;
}

}  // namespace hyselam_topo
