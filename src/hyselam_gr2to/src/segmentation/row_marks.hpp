// Cells of a row that a pass over a map has to look at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace hyselam_topo {

/// Calls `found(x)` for every x of a row that is marked with 1: few, and the marks are made in
/// loops without branches.
template <typename Found>
void eachMarked(const std::vector<std::uint8_t>& marks, Found found) {
  const std::uint8_t* const begin = marks.data();
  const std::uint8_t* const end = begin + marks.size();
  const auto next = [&](const std::uint8_t* from) {
    return static_cast<const std::uint8_t*>(
        std::memchr(from, 1, static_cast<std::size_t>(end - from)));
  };
  for (const std::uint8_t* at = next(begin); at != nullptr; at = next(at + 1))
    found(static_cast<int>(at - begin));
}

}  // namespace hyselam_topo
