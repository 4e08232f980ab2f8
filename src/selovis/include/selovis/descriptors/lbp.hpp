// Local binary patterns (dos Santos 2014, 6.3.1.1 and 6.3.1.2): the table of uniform labels, the
// codes of an image that comes row by row.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "hyselam_common/parameters.hpp"

namespace selovis {

constexpr int kLbpCodes = 256;      ///< LBP with 8 samples
constexpr int kUniformLabels = 59;  ///< 58 uniform codes in ascending order, then all others
constexpr int kUniformCodes = 58;

/// Samples: 8 on a circle of `radius` pixels, the nearest pixel to each, bit p at the angle 2 pi p
/// / 8 counter-clockwise from the right (Eq. 6.4 to 6.6). A bit is 1 where the sample is at least
/// as bright as the centre (Eq. 6.3).
struct LbpParams {
  int radius = 3;         ///< [pixels] 1 to 9
  bool disc_mean = true;  ///< for radius > 1 the centre is the mean of the pixels within the radius

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

struct Offset {
  int dx, dy;
};
std::array<Offset, 8> lbpOffsets(int radius);

/// Pixels (dx, dy) with dx^2 + dy^2 <= radius^2: half height of the column at |dx|.
std::vector<int> discHalfHeights(int radius);

/// Label 0 .. 58 of each code (Eq. 6.9: at most two changes around the circle).
const std::array<std::uint8_t, kLbpCodes>& uniformLabels();

/// Codes of an image that comes row by row; T is uint8_t or uint16_t.
/// Buffers are made once; nothing is allocated per row.
template <typename T>
class LbpStream {
 public:
  /// @param brightest largest value of a pixel.
  /// @throws hyselam::ParameterError where the sum over a disc of such values exceeds 16 bits.
  explicit LbpStream(const LbpParams& params, int brightest = 255);

  /// Starts an image of `cols` columns.
  void begin(int cols);
  /// Where to put the next row: cols values; up to 32 more may be overwritten.
  T* next();
  /// Takes the row. True if codes of the row `radius` rows earlier are ready.
  bool push();
  /// One code per column; those of columns [radius, cols - radius) count.
  const std::uint8_t* codes() const { return codes_.data(); }

 private:
  T* row(int index) { return ring_.data() + static_cast<std::size_t>(index % ring_rows_) * pitch_; }
  void updateSums(int center);
  void thresholds(int center);
  void compare(int center);

  LbpParams params_;
  bool mean_;
  std::array<Offset, 8> offsets_;
  std::vector<int> half_heights_;      // of the disc's column at |dx|
  std::vector<int> sum_of_;            // which vertical sum that column uses
  std::vector<int> distinct_heights_;  // one vertical sum each
  std::uint32_t disc_size_ = 1, multiplier_ = 0;
  int shift_ = 0;
  int cols_ = 0, ring_rows_, pushed_ = 0;
  std::size_t pitch_ = 0;
  std::vector<T> ring_, thresholds_;
  std::vector<std::uint16_t> sums_;
  std::vector<std::uint8_t> codes_;
};

extern template class LbpStream<std::uint8_t>;
extern template class LbpStream<std::uint16_t>;

}  // namespace selovis
