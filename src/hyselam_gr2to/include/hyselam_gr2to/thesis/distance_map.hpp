// Exact Euclidean distances to the nearest obstacle cell, kept up to date where a map changes
// (dos Santos 2014, section 4.2, second stage).
//
// Distances are between the centres of cells. The nearest obstacle ("site") of a cell is unique: of
// several equally near ones it is the one with the smallest x, then the smallest y. So a map that
// was updated in any order of edits is the same, site by site, as one that was built from scratch.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"

namespace hyselam_topo {

/// Cells first .. last of a row.
struct RowSpan {
  int y = 0;
  int first = 0;
  int last = 0;
};

class DistanceMap {
 public:
  static constexpr int kMaxSide = 32767;            ///< of a map, in cells
  static constexpr std::int32_t kFar = 0x7fffffff;  ///< squared distance without any obstacle
  static constexpr hyselam::Cell kNoSite{-1, -1};

  DistanceMap() = default;
  /// From scratch. `obstacles`: CV_8U, not 0 at obstacles, row 0 = lowest y.
  /// @throws hyselam::InputError for another type, an empty map or one with too long sides.
  explicit DistanceMap(const cv::Mat& obstacles);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Puts an obstacle or takes it away; cells outside are ignored. update() makes it effective.
  void setObstacle(hyselam::Cell c, bool obstacle);

  /// Brings distances and sites up to date and returns the cells whose site may have changed
  /// (every one that did, and few others), in the order of rows. Costs about what has changed.
  std::vector<RowSpan> update();

  /// Makes the obstacles those of another map of the same size, then updates.
  std::vector<RowSpan> update(const cv::Mat& obstacles);

  /// Squared distance to the nearest obstacle [cells^2]; 0 on obstacles, kFar if there is none.
  std::int32_t squared(hyselam::Cell c) const { return squared_[index(c)]; }
  /// [cells]; infinite if there is no obstacle.
  double distance(hyselam::Cell c) const;
  /// The nearest obstacle; kNoSite if there is none.
  hyselam::Cell site(hyselam::Cell c) const {
    const std::int16_t x = nearest_column_[index(c)];
    return x < 0 ? kNoSite : hyselam::Cell{x, nearest_row_[index({x, c.y})]};
  }
  /// All squared distances, CV_32S; shares memory with the map.
  cv::Mat squaredView() const;

 private:
  std::size_t index(hyselam::Cell c) const {
    return static_cast<std::size_t>(c.y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(c.x);
  }
  void rebuild();
  void scanColumn(int x, int from, int to);
  void envelope(int y, int first, int last, int low, int high);
  RowSpan affected(int y, int first, int last) const;

  struct Part {
    std::int32_t column;
    std::int32_t from;
    std::int32_t gap_squared;
  };

  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> obstacle_;
  std::vector<std::int16_t> nearest_row_;     // of the nearest obstacle in the own column, -1 none
  std::vector<std::int16_t> nearest_column_;  // in which the nearest obstacle lies, -1 none
  std::vector<std::int32_t> squared_;
  std::vector<hyselam::Cell> edited_;
  std::vector<std::vector<int>> changed_;  // per row: columns whose nearest row has changed
  std::vector<Part> parts_;
};

}  // namespace hyselam_topo
