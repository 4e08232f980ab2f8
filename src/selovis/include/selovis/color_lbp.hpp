// Histograms of local binary patterns by basic colour and image region, in one pass over the rows.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "selovis/color_classes.hpp"
#include "selovis/layout.hpp"
#include "selovis/lbp.hpp"

namespace selovis {

/// Refuses what is no 8-bit image of three channels: std::invalid_argument that says what came and
/// what `who` needs.
void requireColor(const cv::Mat& image, const char* who);

/// Eq. 6.11 for all regions of a layout. One object serves one stream of frames; not thread safe.
class ColorLbp {
 public:
  /// `threads`: bands of rows worked on at once; the counts do not depend on it.
  ColorLbp(const LbpParams& lbp, const ColorParams& colors, int threads = 1);
  ~ColorLbp();

  const LbpParams& lbpParams() const { return lbp_; }

  /// Pixels nearer than the radius to the border have no pattern and are not counted. Any size, any
  /// stride (also a region of interest). `layout` must have the image's size. Throws
  /// std::invalid_argument (requireColor).
  /// `patterns`, if given, gets colour * 256 + code of each pixel (CV_16U, 0 where there is none).
  void compute(const cv::Mat& bgr, const Layout& layout, cv::Mat* patterns = nullptr);

  /// Counts of region r and colour c: 256 values from (r * colors + c) * 256 on.
  const std::vector<std::uint32_t>& counts() const { return counts_; }
  /// Number of counted pixels.
  std::size_t total() const { return total_; }

 private:
  struct Band;
  void computeBand(const cv::Mat& bgr, const Layout& layout, int begin, int end, Band& band,
                   cv::Mat* patterns);

  LbpParams lbp_;
  ColorParams colors_;
  std::vector<std::unique_ptr<Band>> bands_;
  std::vector<std::uint32_t> counts_;
  std::size_t total_ = 0;
};

}  // namespace selovis
