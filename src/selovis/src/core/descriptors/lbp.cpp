#include "selovis/descriptors/lbp.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>
#include <string>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr int kPadding = 64;  // whole vectors may be read and written past the last column

/// Ceiling of x / n for all x <= limit as (x + n - 1) * multiplier >> 16 >> shift, found by trying.
bool findReciprocal(std::uint32_t n, std::uint32_t limit, std::uint32_t& multiplier, int& shift) {
  for (shift = 0; shift <= 10; ++shift) {
    multiplier = ((1u << (16 + shift)) + n - 1) / n;
    if (multiplier > 0xffff) return false;
    bool exact = true;
    for (std::uint32_t x = 0; x <= limit + n - 1 && exact; ++x) {
      exact = (static_cast<std::uint64_t>(x) * multiplier >> 16 >> shift) == x / n;
    }
    if (exact) return true;
  }
  return false;
}

std::array<std::uint8_t, kLbpCodes> makeUniformLabels() {
  std::array<std::uint8_t, kLbpCodes> labels{};
  std::uint8_t next = 0;
  for (int code = 0; code < kLbpCodes; ++code) {
    int changes = 0;
    for (int p = 0; p < 8; ++p) changes += ((code >> p) & 1) != ((code >> ((p + 1) % 8)) & 1);
    labels[code] = changes <= 2 ? next++ : static_cast<std::uint8_t>(kUniformCodes);
  }
  return labels;
}

inline cv::v_uint8x16 narrow(const cv::v_uint16x8& low, const cv::v_uint16x8& high) {
  return cv::v_pack(low, high);
}

}  // namespace

void LbpParams::describe(hyselam::ParameterVisitor& visit) {
  visit("radius", radius, hyselam::Range::between(1, 9), "pixel", "of the circle of samples");
  visit("disc_mean", disc_mean, "compare with the mean of the disc, not with the center");
}

void LbpParams::validate() const {
  hyselam::checkParameters(*this);
}

std::array<Offset, 8> lbpOffsets(int radius) {
  std::array<Offset, 8> offsets;
  const int diagonal = static_cast<int>(std::lround(radius * std::sqrt(0.5)));
  const int x[8] = {radius, diagonal, 0, -diagonal, -radius, -diagonal, 0, diagonal};
  for (int p = 0; p < 8; ++p) offsets[p] = {x[p], -x[(p + 6) % 8]};
  return offsets;
}

std::vector<int> discHalfHeights(int radius) {
  std::vector<int> heights;
  for (int dx = 0; dx <= radius; ++dx) {
    int h = 0;
    while (dx * dx + (h + 1) * (h + 1) <= radius * radius) ++h;
    heights.push_back(h);
  }
  return heights;
}

const std::array<std::uint8_t, kLbpCodes>& uniformLabels() {
  static const std::array<std::uint8_t, kLbpCodes> labels = makeUniformLabels();
  return labels;
}

template <typename T>
LbpStream<T>::LbpStream(const LbpParams& params, int brightest)
    : params_(params), mean_(params.disc_mean && params.radius > 1) {
  params.validate();
  offsets_ = lbpOffsets(params.radius);
  half_heights_ = discHalfHeights(params.radius);
  disc_size_ = 0;
  for (int dx = 0; dx <= params.radius; ++dx) {
    disc_size_ += static_cast<std::uint32_t>((dx == 0 ? 1 : 2) * (2 * half_heights_[dx] + 1));
    const auto known =
        std::find(distinct_heights_.begin(), distinct_heights_.end(), half_heights_[dx]);
    sum_of_.push_back(static_cast<int>(known - distinct_heights_.begin()));
    if (known == distinct_heights_.end()) distinct_heights_.push_back(half_heights_[dx]);
  }
  const std::uint32_t largest = disc_size_ * static_cast<std::uint32_t>(brightest);
  if (mean_ && largest + disc_size_ > 0xffff) {
    throw hyselam::ParameterError("lbp_radius", params.radius,
                                  "smaller for " + std::to_string(brightest) + " gray levels");
  }
  if (!findReciprocal(disc_size_, largest, multiplier_, shift_)) multiplier_ = 0;  // divide
  ring_rows_ = 2 * params.radius + 2;
}

template <typename T>
void LbpStream<T>::begin(int cols) {
  pushed_ = 0;
  if (cols == cols_) return;
  cols_ = cols;
  pitch_ = static_cast<std::size_t>(cols) + kPadding;
  ring_.assign(pitch_ * ring_rows_, 0);
  thresholds_.assign(pitch_, 0);
  sums_.assign(pitch_ * distinct_heights_.size(), 0);
  codes_.assign(pitch_, 0);
}

template <typename T>
T* LbpStream<T>::next() {
  return row(pushed_);
}

template <typename T>
bool LbpStream<T>::push() {
  const int center = pushed_++ - params_.radius;
  if (center < params_.radius) return false;
  if (mean_) {
    updateSums(center);
    thresholds(center);
  }
  compare(center);
  return true;
}

namespace {

/// sums += add - drop over n columns (rounded up to whole vectors).
void slide(std::uint16_t* sums, const std::uint8_t* add, const std::uint8_t* drop, int n) {
  for (int x = 0; x < n; x += 16) {
    cv::v_uint16x8 a0, a1, d0, d1;
    cv::v_expand(cv::v_load(add + x), a0, a1);
    cv::v_expand(cv::v_load(drop + x), d0, d1);
    cv::v_store(sums + x, cv::v_sub_wrap(cv::v_add_wrap(cv::v_load(sums + x), a0), d0));
    cv::v_store(sums + x + 8, cv::v_sub_wrap(cv::v_add_wrap(cv::v_load(sums + x + 8), a1), d1));
  }
}
void slide(std::uint16_t* sums, const std::uint16_t* add, const std::uint16_t* drop, int n) {
  for (int x = 0; x < n; x += 8) {
    cv::v_store(sums + x, cv::v_sub_wrap(cv::v_add_wrap(cv::v_load(sums + x), cv::v_load(add + x)),
                                         cv::v_load(drop + x)));
  }
}

void storeThreshold(std::uint8_t* out, const cv::v_uint16x8& low, const cv::v_uint16x8& high) {
  cv::v_store(out, narrow(low, high));
}
void storeThreshold(std::uint16_t* out, const cv::v_uint16x8& low, const cv::v_uint16x8& high) {
  cv::v_store(out, low);
  cv::v_store(out + 8, high);
}

}  // namespace

template <typename T>
void LbpStream<T>::updateSums(int center) {
  for (std::size_t k = 0; k < distinct_heights_.size(); ++k) {
    const int h = distinct_heights_[k];
    std::uint16_t* sums = sums_.data() + k * pitch_;
    if (center == params_.radius) {  // the first row with codes
      std::fill(sums, sums + pitch_, std::uint16_t{0});
      for (int y = center - h; y <= center + h; ++y) {
        const T* values = row(y);
        for (int x = 0; x < cols_; ++x) sums[x] = static_cast<std::uint16_t>(sums[x] + values[x]);
      }
    } else {
      slide(sums, row(center + h), row(center - h - 1), cols_);
    }
  }
}

template <typename T>
void LbpStream<T>::thresholds(int center) {
  (void)center;
  const int radius = params_.radius;
  const cv::v_uint16x8 multiplier = cv::v_setall_u16(static_cast<std::uint16_t>(multiplier_));
  const cv::v_uint16x8 round = cv::v_setall_u16(static_cast<std::uint16_t>(disc_size_ - 1));
  for (int x = radius; x < cols_ - radius; x += 16) {
    cv::v_uint16x8 low = round, high = round;
    for (int dx = -radius; dx <= radius; ++dx) {
      const std::uint16_t* sums =
          sums_.data() + static_cast<std::size_t>(sum_of_[dx < 0 ? -dx : dx]) * pitch_ + x + dx;
      low = cv::v_add_wrap(low, cv::v_load(sums));
      high = cv::v_add_wrap(high, cv::v_load(sums + 8));
    }
    if (multiplier_ == 0) {
      std::uint16_t sum[16];
      cv::v_store(sum, low);
      cv::v_store(sum + 8, high);
      for (int i = 0; i < 16; ++i) thresholds_[x + i] = static_cast<T>(sum[i] / disc_size_);
      continue;
    }
    storeThreshold(thresholds_.data() + x, cv::v_mul_hi(low, multiplier) >> shift_,
                   cv::v_mul_hi(high, multiplier) >> shift_);
  }
}

namespace {

void compareRow(std::uint8_t* codes, const std::uint8_t* const samples[8],
                const std::uint8_t* thresholds, int begin, int end) {
  for (int x = begin; x < end; x += 16) {
    const cv::v_uint8x16 threshold = cv::v_load(thresholds + x);
    cv::v_uint8x16 code = cv::v_setzero_u8();
    for (int p = 0; p < 8; ++p) {
      const cv::v_uint8x16 bit = cv::v_setall_u8(static_cast<std::uint8_t>(1 << p));
      code = code | ((cv::v_load(samples[p] + x) >= threshold) & bit);
    }
    cv::v_store(codes + x, code);
  }
}
void compareRow(std::uint8_t* codes, const std::uint16_t* const samples[8],
                const std::uint16_t* thresholds, int begin, int end) {
  for (int x = begin; x < end; x += 16) {
    const cv::v_uint16x8 t0 = cv::v_load(thresholds + x), t1 = cv::v_load(thresholds + x + 8);
    cv::v_uint16x8 c0 = cv::v_setzero_u16(), c1 = cv::v_setzero_u16();
    for (int p = 0; p < 8; ++p) {
      const cv::v_uint16x8 bit = cv::v_setall_u16(static_cast<std::uint16_t>(1 << p));
      c0 = c0 | ((cv::v_load(samples[p] + x) >= t0) & bit);
      c1 = c1 | ((cv::v_load(samples[p] + x + 8) >= t1) & bit);
    }
    cv::v_store(codes + x, narrow(c0, c1));
  }
}

}  // namespace

template <typename T>
void LbpStream<T>::compare(int center) {
  const T* samples[8];
  for (int p = 0; p < 8; ++p) samples[p] = row(center + offsets_[p].dy) + offsets_[p].dx;
  compareRow(codes_.data(), samples, mean_ ? thresholds_.data() : row(center), params_.radius,
             cols_ - params_.radius);
}

template class LbpStream<std::uint8_t>;
template class LbpStream<std::uint16_t>;

}  // namespace selovis
