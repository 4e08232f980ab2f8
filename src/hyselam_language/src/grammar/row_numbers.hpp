// Numbers for rows of numbers: equal rows get the same.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace hyselam_topo {
namespace language {

/// The rows stand behind one another in one vector; a table with open addressing finds them.
template <typename Number>
class RowNumbers {
 public:
  /// The number of a row, and whether it is new.
  std::pair<int, bool> of(const std::vector<Number>& row) {
    if (2 * (begins_.size() + 1) > table_.size()) grow();
    const std::uint64_t hash = hashOf(row.data(), row.size());
    std::size_t at = hash & (table_.size() - 1);
    for (; table_[at] >= 0; at = (at + 1) & (table_.size() - 1)) {
      if (isRow(table_[at], hash, row)) return {table_[at], false};
    }
    const int number = static_cast<int>(size());
    table_[at] = number;
    hashes_.push_back(hash);
    all_.insert(all_.end(), row.begin(), row.end());
    begins_.push_back(all_.size());
    return {number, true};
  }

  std::size_t size() const { return hashes_.size(); }
  const Number* begin(int row) const {
    return all_.data() + begins_[static_cast<std::size_t>(row)];
  }
  const Number* end(int row) const {
    return all_.data() + begins_[static_cast<std::size_t>(row) + 1];
  }

 private:
  static std::uint64_t hashOf(const Number* numbers, std::size_t count) {
    std::uint64_t hash = count;
    for (std::size_t i = 0; i < count; ++i) {
      hash = (hash ^ static_cast<std::uint64_t>(numbers[i])) * 0x9e3779b97f4a7c15ULL;
      hash ^= hash >> 29;
    }
    return hash;
  }

  bool isRow(int number, std::uint64_t hash, const std::vector<Number>& row) const {
    return hashes_[static_cast<std::size_t>(number)] == hash &&
           std::equal(row.begin(), row.end(), begin(number), end(number));
  }

  void grow() {
    constexpr std::size_t kFirst = 64;
    table_.assign(std::max(kFirst, 2 * table_.size()), -1);
    for (std::size_t i = 0; i < hashes_.size(); ++i) {
      std::size_t at = hashes_[i] & (table_.size() - 1);
      while (table_[at] >= 0) at = (at + 1) & (table_.size() - 1);
      table_[at] = static_cast<int>(i);
    }
  }

  std::vector<Number> all_;
  std::vector<std::size_t> begins_{0};
  std::vector<std::uint64_t> hashes_;
  std::vector<int> table_;  ///< numbers of rows; -1: free
};

}  // namespace language
}  // namespace hyselam_topo
