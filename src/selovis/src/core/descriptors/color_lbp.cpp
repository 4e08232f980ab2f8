#include "selovis/descriptors/color_lbp.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>
#include <string>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/require.hpp"

namespace selovis {

using hyselam::InputError;

void requireColor(const cv::Mat& image, const char* descriptor) {
  if (image.empty()) throw InputError(descriptor, "", "the image is empty");
  if (image.type() == CV_8UC3) return;
  if (image.channels() == 1) {
    throw InputError(descriptor, "", "needs a colour image, but this one is grey (one channel)");
  }
  throw InputError(descriptor, "",
                   "needs 8-bit BGR, but the image has " + std::to_string(image.channels()) +
                       " channels of " + std::to_string(8 * image.elemSize1()) + " bits");
}

/// What one band of rows needs. Neighbouring pixels often fall into the same bin: two sets of
/// counters in turn keep an increment from waiting for the one before.
struct ColorLbp::Band {
  explicit Band(const LbpParams& params) : stream(params), ring(params.radius + 1) {}

  LbpStream<std::uint8_t> stream;
  int ring;  // rows of colours kept until their codes are there
  std::vector<std::uint8_t> colors;
  std::vector<std::uint16_t> patterns;
  std::vector<std::uint32_t> even, odd;
};

ColorLbp::ColorLbp(const LbpParams& lbp, const ColorParams& colors, int threads)
    : lbp_(lbp), colors_(colors) {
  lbp.validate();
  colors.validate();
  hyselam::require("threads", threads, threads >= 1 && threads <= 64, "1 to 64");
  for (int i = 0; i < threads; ++i) bands_.push_back(std::make_unique<Band>(lbp));
}

ColorLbp::~ColorLbp() = default;

namespace {

void countSpan(const std::uint16_t* p, const std::uint16_t* end, std::uint32_t* even,
               std::uint32_t* odd) {
  for (; p + 4 <= end; p += 4) {
    ++even[p[0]];
    ++odd[p[1]];
    ++even[p[2]];
    ++odd[p[3]];
  }
  for (; p < end; ++p) ++even[*p];
}

}  // namespace

void ColorLbp::computeBand(const cv::Mat& bgr, const RegionLayout& layout, int begin, int end,
                           Band& band, cv::Mat* patterns) {
  const int radius = lbp_.radius, cols = bgr.cols;
  const std::size_t pitch = static_cast<std::size_t>(cols) + 64;
  const std::size_t bins = static_cast<std::size_t>(colors_.colors) * kLbpCodes;
  band.colors.resize(pitch * static_cast<std::size_t>(band.ring));
  band.patterns.resize(pitch);
  band.even.assign(bins * static_cast<std::size_t>(layout.regions), 0);
  band.odd.assign(bins * static_cast<std::size_t>(layout.regions), 0);
  band.stream.begin(cols);
  for (int y = begin - radius; y < end + radius; ++y) {
    std::uint8_t* colors = band.colors.data() + static_cast<std::size_t>(y % band.ring) * pitch;
    classifyRow(bgr.ptr<std::uint8_t>(y), cols, colors_, band.stream.next(), colors);
    if (!band.stream.push()) continue;
    const int center = y - radius;
    const std::uint8_t* codes = band.stream.codes();
    colors = band.colors.data() + static_cast<std::size_t>(center % band.ring) * pitch;
    std::uint16_t* row = band.patterns.data();
    for (int x = 0; x < cols; x += 16) {  // colour * 256 + code
      cv::v_uint16x8 code0, code1, color0, color1;
      cv::v_expand(cv::v_load(codes + x), code0, code1);
      cv::v_expand(cv::v_load(colors + x), color0, color1);
      cv::v_store(row + x, code0 | (color0 << 8));
      cv::v_store(row + x + 8, code1 | (color1 << 8));
    }
    int x = radius;
    for (std::uint32_t s = layout.row_begin[center]; s < layout.row_begin[center + 1]; ++s) {
      const int stop = std::min(layout.spans[s].end, cols - radius);
      if (stop <= x) continue;
      const std::size_t first = bins * static_cast<std::size_t>(layout.spans[s].region);
      countSpan(row + x, row + stop, band.even.data() + first, band.odd.data() + first);
      x = stop;
    }
    if (patterns != nullptr) {
      std::copy(row + radius, row + cols - radius, patterns->ptr<std::uint16_t>(center) + radius);
    }
  }
}

void ColorLbp::compute(const cv::Mat& bgr, const RegionLayout& layout, cv::Mat* patterns) {
  requireColor(bgr, "LBPbyHSV");
  if (layout.rows != bgr.rows || layout.cols != bgr.cols) {
    throw InputError("LBPbyHSV", "", "the layout is for an image of another size");
  }
  const int radius = lbp_.radius, rows = bgr.rows - 2 * radius, cols = bgr.cols - 2 * radius;
  counts_.assign(static_cast<std::size_t>(layout.regions * colors_.colors) * kLbpCodes, 0);
  total_ = 0;
  if (patterns != nullptr) {
    patterns->create(bgr.size(), CV_16U);
    patterns->setTo(0);
  }
  if (rows <= 0 || cols <= 0) return;
  total_ = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  const int n = std::min(static_cast<int>(bands_.size()), rows);
  const auto work = [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      computeBand(bgr, layout, radius + i * rows / n, radius + (i + 1) * rows / n, *bands_[i],
                  patterns);
    }
  };
  if (n == 1) {
    work(cv::Range(0, 1));
  } else {
    cv::parallel_for_(cv::Range(0, n), work);
  }
  for (int i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < counts_.size(); ++k) {
      counts_[k] += bands_[i]->even[k] + bands_[i]->odd[k];
    }
  }
}

}  // namespace selovis
