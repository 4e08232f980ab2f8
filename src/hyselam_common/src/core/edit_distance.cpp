#include "hyselam_common/edit_distance.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace hyselam {

std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, change});
    }
  }
  return row.back();
}

bool isOneEditApart(std::string_view a, std::string_view b) {
  if (a.size() > b.size()) return isOneEditApart(b, a);
  if (b.size() - a.size() > 1 || a == b) return false;
  std::size_t i = 0;
  while (i < a.size() && a[i] == b[i]) ++i;
  const auto restIsSame = [&](std::size_t from_a, std::size_t from_b) {
    return a.compare(from_a, std::string_view::npos, b, from_b, std::string_view::npos) == 0;
  };
  if (a.size() < b.size()) return restIsSame(i, i + 1);
  if (restIsSame(i + 1, i + 1)) return true;
  return i + 1 < a.size() && a[i] == b[i + 1] && a[i + 1] == b[i] && restIsSame(i + 2, i + 2);
}

}  // namespace hyselam
