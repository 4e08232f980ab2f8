// A vector that grows without ever moving what it holds: no pause when it gets large.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace ngram_slam {

/// Elements are value-initialised. Access costs one more load than a vector's.
template <typename T, int Bits = 14>
class BlockVector {
 public:
  BlockVector() = default;
  BlockVector(BlockVector&&) noexcept = default;
  BlockVector& operator=(BlockVector&&) noexcept = default;
  ~BlockVector() = default;
  BlockVector(const BlockVector& other) { *this = other; }
  BlockVector& operator=(const BlockVector& other) {
    if (this == &other) return *this;
    blocks_.clear();
    size_ = 0;
    grow(other.size_);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      std::copy_n(other.blocks_[b].get(), kMask + 1, blocks_[b].get());
    }
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return blocks_[i >> Bits][i & kMask]; }
  const T& operator[](std::size_t i) const { return blocks_[i >> Bits][i & kMask]; }
  T& back() { return (*this)[size_ - 1]; }
  const T& back() const { return (*this)[size_ - 1]; }

  void push_back(const T& value) {
    grow(size_ + 1);
    (*this)[size_ - 1] = value;
  }
  /// At least `size` elements.
  void grow(std::size_t size) {
    while (blocks_.size() << Bits < size) blocks_.push_back(std::make_unique<T[]>(kMask + 1));
    if (size > size_) size_ = size;
  }
  std::size_t bytes() const {
    return blocks_.size() * ((kMask + 1) * sizeof(T) + sizeof(std::unique_ptr<T[]>));
  }

 private:
  static constexpr std::size_t kMask = (std::size_t{1} << Bits) - 1;
  std::vector<std::unique_ptr<T[]>> blocks_;
  std::size_t size_ = 0;
};

/// Fetches a value into the cache while something else is being done.
template <typename T>
void prefetch(const T& value) {
  __builtin_prefetch(&value);
}

}  // namespace ngram_slam
