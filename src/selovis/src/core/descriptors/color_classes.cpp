#include "selovis/descriptors/color_classes.hpp"

#include <cstring>
#include <opencv2/core/hal/intrin.hpp>

namespace selovis {
namespace {

using cv::v_int16x8;
using cv::v_uint16x8;
using cv::v_uint8x16;

/// Constants of one row.
struct Limits {
  explicit Limits(const ColorParams& p)
      : hues(p.colors - 2),
        value(cv::v_setall_u8(static_cast<std::uint8_t>(p.value_min))),
        saturation(cv::v_setall_u16(static_cast<std::uint16_t>(p.saturation_min))) {}
  int hues;
  v_uint8x16 value;
  v_uint16x8 saturation;
};

/// 8 pixels. With d = max - min, num / d is the hue in sixths of a turn, 0 <= num < 6 d; the class
/// is the number of k >= 1 with hues * num >= 6 d k.
inline v_uint16x8 hueClass(const v_uint16x8& b16, const v_uint16x8& g16, const v_uint16x8& r16,
                           const v_uint16x8& max16, const v_uint16x8& diff16, int hues) {
  const v_int16x8 b = cv::v_reinterpret_as_s16(b16), g = cv::v_reinterpret_as_s16(g16),
                  r = cv::v_reinterpret_as_s16(r16), max = cv::v_reinterpret_as_s16(max16),
                  d = cv::v_reinterpret_as_s16(diff16);
  const v_int16x8 zero = cv::v_setzero_s16();
  const v_int16x8 d2 = d + d, d4 = d2 + d2, d6 = d4 + d2;
  const v_int16x8 gb = g - b;
  const v_int16x8 red = gb + (d6 & (gb < zero));
  const v_int16x8 num =
      cv::v_select(r == max, red, cv::v_select(g == max, d2 + (b - r), d4 + (r - g)));
  const v_int16x8 scaled = cv::v_mul_wrap(num, cv::v_setall_s16(static_cast<short>(hues)));
  v_int16x8 hue = zero, bound = d6;
  for (int k = 1; k < hues; ++k) {
    hue = hue - (scaled >= bound);  // true is -1
    bound = bound + d6;
  }
  return cv::v_reinterpret_as_u16(hue & (d != zero));
}

/// The same for six hues, where the order of the channels gives the class: 16 pixels at once.
inline v_uint8x16 hueSextant(const v_uint8x16& b, const v_uint8x16& g, const v_uint8x16& r,
                             const v_uint8x16& max, const v_uint8x16& diff) {
  const v_uint8x16 one = cv::v_setall_u8(1), two = cv::v_setall_u8(2), three = cv::v_setall_u8(3),
                   four = cv::v_setall_u8(4), five = cv::v_setall_u8(5);
  const v_uint8x16 r_max = r == max, g_max = g == max, b_max = b == max;
  const v_uint8x16 red = cv::v_select(g >= b, g_max & one, five);
  const v_uint8x16 green = cv::v_select(b_max, three, cv::v_select(b >= r, two, one));
  const v_uint8x16 blue = cv::v_select(r >= g, four, three);
  const v_uint8x16 hue = cv::v_select(r_max, red, cv::v_select(g_max, green, blue));
  return hue & (diff > cv::v_setzero_u8());
}

/// Saturation, diff / max, below the limit.
inline v_uint16x8 isWhite(const v_uint16x8& max, const v_uint16x8& diff, const Limits& l) {
  return cv::v_mul_wrap(diff, cv::v_setall_u16(255)) < cv::v_mul_wrap(max, l.saturation);
}

inline v_uint16x8 brightness(const v_uint16x8& b, const v_uint16x8& g, const v_uint16x8& r) {
  const v_uint16x8 sum = cv::v_add_wrap(cv::v_mul_wrap(b, cv::v_setall_u16(29)),
                                        cv::v_mul_wrap(g, cv::v_setall_u16(150)));
  return cv::v_add_wrap(cv::v_add_wrap(sum, cv::v_mul_wrap(r, cv::v_setall_u16(77))),
                        cv::v_setall_u16(128)) >>
         8;
}

inline void classify16(const std::uint8_t* bgr, const Limits& l, std::uint8_t* gray,
                       std::uint8_t* colors) {
  v_uint8x16 b, g, r;
  cv::v_load_deinterleave(bgr, b, g, r);
  const v_uint8x16 max = cv::v_max(cv::v_max(b, g), r), min = cv::v_min(cv::v_min(b, g), r);
  const v_uint8x16 diff = max - min;
  v_uint16x8 b0, b1, g0, g1, r0, r1, max0, max1, diff0, diff1;
  cv::v_expand(b, b0, b1);
  cv::v_expand(g, g0, g1);
  cv::v_expand(r, r0, r1);
  cv::v_expand(max, max0, max1);
  cv::v_expand(diff, diff0, diff1);
  cv::v_store(gray, cv::v_pack(brightness(b0, g0, r0), brightness(b1, g1, r1)));
  const v_uint8x16 white = cv::v_pack(isWhite(max0, diff0, l) >> 8, isWhite(max1, diff1, l) >> 8);
  const v_uint8x16 hue = l.hues == 6 ? hueSextant(b, g, r, max, diff)
                                     : cv::v_pack(hueClass(b0, g0, r0, max0, diff0, l.hues),
                                                  hueClass(b1, g1, r1, max1, diff1, l.hues));
  const v_uint8x16 color = cv::v_select(white, cv::v_setall_u8(1), hue + cv::v_setall_u8(2));
  cv::v_store(colors, color & (max >= l.value));
}

}  // namespace

void ColorParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("colors", colors, Range::between(3, 16), "", "black, white and sectors of the hue");
  visit("value_min", value_min, Range::between(0, 255), "", "delta_v of Eq. 6.13");
  visit("saturation_min", saturation_min, Range::between(0, 255), "", "delta_s of Eq. 6.13");
}

void ColorParams::validate() const {
  hyselam::checkParameters(*this);
}

void classifyRow(const std::uint8_t* bgr, int cols, const ColorParams& params, std::uint8_t* gray,
                 std::uint8_t* colors) {
  const Limits limits(params);
  int x = 0;
  for (; x + 16 <= cols; x += 16) classify16(bgr + 3 * x, limits, gray + x, colors + x);
  if (x < cols) {  // the rest through a copy: nothing past the row is read
    std::uint8_t rest[48] = {};
    std::memcpy(rest, bgr + 3 * x, 3 * static_cast<std::size_t>(cols - x));
    classify16(rest, limits, gray + x, colors + x);
  }
}

}  // namespace selovis
