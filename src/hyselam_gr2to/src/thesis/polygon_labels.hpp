// Last stage of the thesis' pipeline (section 4.2): from polygons to the place of each free cell.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_gr2to/thesis/thesis.hpp"

namespace hyselam_topo {

/// Labels the open cells (CV_8U, not 0), place k of circle and polygon k - 1; CV_16U, 0: none. Of
/// at most 65535 circles: runThesis() refuses maps that give more.
class PolygonLabels {
 public:
  PolygonLabels(const cv::Mat& open, const std::vector<Circle>& circles,
                const std::vector<PlacePolygon>& polygons);

  /// Gives all open cells that can be reached to the place from which the way is shortest; then the
  /// doors themselves.
  void fill(const cv::Mat& doors);

  const cv::Mat& labels() const { return labels_; }

 private:
  cv::Mat ownersOf(const std::vector<Circle>& circles,
                   const std::vector<PlacePolygon>& polygons) const;
  void restart();
  template <typename Allowed>
  void spread(Allowed allowed);

  cv::Mat open_;
  cv::Mat labels_;
  std::vector<hyselam::Cell> front_;
};

}  // namespace hyselam_topo
