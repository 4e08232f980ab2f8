// Histograms of local binary patterns by basic color and image region (LBPbyHSV, Eq. 6.11), in one
// pass over the rows.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "selovis/descriptors/color_classes.hpp"
#include "selovis/descriptors/lbp.hpp"
#include "selovis/descriptors/region_layout.hpp"

namespace selovis {

/// @throws hyselam::InputError, with the name of the descriptor and what came instead, unless the
///   image has three channels of 8 bits.
void requireColor(const cv::Mat& image, const char* descriptor);

/// Eq. 6.11 for all regions of a layout. One object serves one stream of frames; not thread safe.
class ColorLbp {
 public:
  /// `threads`: bands of rows worked on at once; the counts do not depend on it.
  ColorLbp(const LbpParams& lbp, const ColorParams& colors, int threads = 1);
  ~ColorLbp();

  const LbpParams& lbpParams() const { return lbp_; }

  /// Pixels nearer than the radius to the border have no pattern and are not counted. Any size, any
  /// stride (also a region of interest). `layout` must have the image's size.
  /// `patterns`, if given, gets color * 256 + code of each pixel (CV_16U, 0 where there is none).
  /// @throws hyselam::InputError.
  void compute(const cv::Mat& bgr, const RegionLayout& layout, cv::Mat* patterns = nullptr);

  /// Counts of region r and color c: 256 values from (r * colors + c) * 256 on.
  const std::vector<std::uint32_t>& counts() const { return counts_; }
  /// Number of counted pixels.
  std::size_t total() const { return total_; }

 private:
  struct Band;
  void computeBand(const cv::Mat& bgr, const RegionLayout& layout, int begin, int end, Band& band,
                   cv::Mat* patterns);

  LbpParams lbp_;
  ColorParams colors_;
  std::vector<std::unique_ptr<Band>> bands_;
  std::vector<std::uint32_t> counts_;
  std::size_t total_ = 0;
};

}  // namespace selovis
