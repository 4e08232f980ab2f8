// A yes/no grid with one bit a cell, and rows of bits cut out of it: what makes floods fast.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fsd_localization {

/// W * 64 neighbouring cells of one grid row; bit 0 is the leftmost cell.
template <int W>
struct BitRow {
  std::array<std::uint64_t, W> words;

  bool any() const {
    std::uint64_t all = 0;
    for (std::uint64_t w : words) all |= w;
    return all != 0;
  }
  friend BitRow operator&(BitRow a, const BitRow& b) {
    for (int i = 0; i < W; ++i) a.words[i] &= b.words[i];
    return a;
  }
  friend BitRow operator|(BitRow a, const BitRow& b) {
    for (int i = 0; i < W; ++i) a.words[i] |= b.words[i];
    return a;
  }
  friend BitRow operator^(BitRow a, const BitRow& b) {
    for (int i = 0; i < W; ++i) a.words[i] ^= b.words[i];
    return a;
  }
  friend BitRow operator~(BitRow a) {
    for (std::uint64_t& w : a.words) w = ~w;
    return a;
  }
  friend bool operator==(const BitRow& a, const BitRow& b) { return a.words == b.words; }

  /// Every cell moved K cells to the right (towards higher bits).
  template <int K>
  BitRow right() const {
    static_assert(K > 0 && K < 64 * W, "moves within the row");
    constexpr int kWhole = K / 64, kPart = K % 64;
    BitRow out{};
    for (int i = W - 1; i >= kWhole; --i) {
      out.words[i] = words[i - kWhole] << kPart;
      if (kPart != 0 && i > kWhole) out.words[i] |= words[i - kWhole - 1] >> ((64 - kPart) % 64);
    }
    return out;
  }
  /// Every cell moved K cells to the left.
  template <int K>
  BitRow left() const {
    static_assert(K > 0 && K < 64 * W, "moves within the row");
    constexpr int kWhole = K / 64, kPart = K % 64;
    BitRow out{};
    for (int i = 0; i + kWhole < W; ++i) {
      out.words[i] = words[i + kWhole] >> kPart;
      if (kPart != 0 && i + kWhole + 1 < W) {
        out.words[i] |= words[i + kWhole + 1] << ((64 - kPart) % 64);
      }
    }
    return out;
  }
  /// Sum as one long number: a carry runs up through a row of ones, which is what floods a run.
  friend BitRow operator+(const BitRow& a, const BitRow& b) {
    BitRow out;
    std::uint64_t carry = 0;
    for (int i = 0; i < W; ++i) {
      const std::uint64_t sum = a.words[i] + b.words[i];
      out.words[i] = sum + carry;
      carry = static_cast<std::uint64_t>(sum < a.words[i]) |
              static_cast<std::uint64_t>(out.words[i] < sum);
    }
    return out;
  }
};

/// Width x height bits with a margin of zeros all around, so that a window may hang over the edge.
class BitPlane {
 public:
  static constexpr int kMargin = 192;  ///< [cells] readable outside on every side

  BitPlane() = default;
  BitPlane(int width, int height)
      : width_(width),
        height_(height),
        stride_((width + 63) / 64 + 2 * kMargin / 64 + 1),
        words_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height + 2 * kMargin)) {
  }

  int width() const { return width_; }
  int height() const { return height_; }
  bool get(int x, int y) const { return (*word(x, y) >> ((x + kMargin) % 64) & 1U) != 0; }
  void set(int x, int y, bool value) {
    std::uint64_t& w = *word(x, y);
    const std::uint64_t bit = std::uint64_t{1} << ((x + kMargin) % 64);
    w = value ? w | bit : w & ~bit;
  }
  /// The cells x0 .. x0 + 64 W - 1 of row y.
  template <int W>
  BitRow<W> row(int x0, int y) const {
    const std::uint64_t* p = word(x0, y);
    const int shift = (x0 + kMargin) % 64;
    BitRow<W> out;
    for (int i = 0; i < W; ++i) {  // the second shift is split so that it is defined for shift == 0
      out.words[i] = p[i] >> shift | p[i + 1] << 1 << (63 - shift);
    }
    return out;
  }
  /// 64 cells from x0 (a multiple of 64) on, overwritten at once.
  void setWord(int x0, int y, std::uint64_t bits) { *word(x0, y) = bits; }

 private:
  const std::uint64_t* word(int x, int y) const {
    return words_.data() + static_cast<std::ptrdiff_t>(y + kMargin) * stride_ + (x + kMargin) / 64;
  }
  std::uint64_t* word(int x, int y) {
    return words_.data() + static_cast<std::ptrdiff_t>(y + kMargin) * stride_ + (x + kMargin) / 64;
  }

  int width_ = 0;
  int height_ = 0;
  int stride_ = 0;
  std::vector<std::uint64_t> words_;
};

/// Which cells of a grid are free and which are unknown; the rest is occupied.
struct FreeSpaceGrid {
  BitPlane free;
  BitPlane unknown;

  FreeSpaceGrid() = default;
  FreeSpaceGrid(int width, int height) : free(width, height), unknown(width, height) {}
};

}  // namespace fsd_localization
