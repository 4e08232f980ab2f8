// A set of places of a map by their number in it: a row of bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace hyselam_topo {

/// Up to kCapacity numbers from 0. All operations take the same few steps.
class PlaceSet {
 public:
  static constexpr std::size_t kCapacity = 256;

  void insert(std::size_t i) { words_[i >> 6] |= std::uint64_t{1} << (i & 63); }
  void erase(std::size_t i) { words_[i >> 6] &= ~(std::uint64_t{1} << (i & 63)); }
  bool contains(std::size_t i) const { return (words_[i >> 6] >> (i & 63) & 1u) != 0; }
  bool empty() const { return (words_[0] | words_[1] | words_[2] | words_[3]) == 0; }
  bool intersects(const PlaceSet& o) const {
    return ((words_[0] & o.words_[0]) | (words_[1] & o.words_[1]) | (words_[2] & o.words_[2]) |
            (words_[3] & o.words_[3])) != 0;
  }
  bool containsAll(const PlaceSet& o) const { return (o - *this).empty(); }
  std::size_t size() const {
    std::size_t n = 0;
    for (const std::uint64_t word : words_) n += bitCount(word);
    return n;
  }
  PlaceSet& operator|=(const PlaceSet& o) {
    for (std::size_t w = 0; w < words_.size(); ++w) words_[w] |= o.words_[w];
    return *this;
  }
  PlaceSet& operator&=(const PlaceSet& o) {
    for (std::size_t w = 0; w < words_.size(); ++w) words_[w] &= o.words_[w];
    return *this;
  }
  PlaceSet& operator-=(const PlaceSet& o) {
    for (std::size_t w = 0; w < words_.size(); ++w) words_[w] &= ~o.words_[w];
    return *this;
  }
  friend PlaceSet operator|(PlaceSet a, const PlaceSet& b) { return a |= b; }
  friend PlaceSet operator&(PlaceSet a, const PlaceSet& b) { return a &= b; }
  friend PlaceSet operator-(PlaceSet a, const PlaceSet& b) { return a -= b; }
  friend bool operator==(const PlaceSet& a, const PlaceSet& b) { return a.words_ == b.words_; }
  friend bool operator!=(const PlaceSet& a, const PlaceSet& b) { return !(a == b); }

  /// The smallest number; kCapacity if it is empty.
  std::size_t first() const {
    for (std::size_t w = 0; w < words_.size(); ++w)
      if (words_[w] != 0) return w * 64 + lowestBit(words_[w]);
    return kCapacity;
  }
  /// All numbers in their order.
  template <typename Visit>
  void forEach(Visit&& visit) const {
    for (std::size_t w = 0; w < words_.size(); ++w)
      for (std::uint64_t rest = words_[w]; rest != 0; rest &= rest - 1)
        visit(w * 64 + lowestBit(rest));
  }

 private:
  /// The builtin is a call where the processor's instruction may not be assumed.
  static std::size_t bitCount(std::uint64_t word) {
    word -= word >> 1 & 0x5555555555555555u;
    word = (word & 0x3333333333333333u) + (word >> 2 & 0x3333333333333333u);
    word = (word + (word >> 4)) & 0x0F0F0F0F0F0F0F0Fu;
    return static_cast<std::size_t>(word * 0x0101010101010101u >> 56);
  }
  static std::size_t lowestBit(std::uint64_t word) {
    return static_cast<std::size_t>(__builtin_ctzll(word));
  }

  std::array<std::uint64_t, kCapacity / 64> words_{};
};

}  // namespace hyselam_topo
