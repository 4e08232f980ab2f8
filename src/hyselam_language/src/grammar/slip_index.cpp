#include "slip_index.hpp"

#include <algorithm>
#include <string_view>

#include "hyselam_common/edit_distance.hpp"

namespace hyselam_topo {
namespace language {
namespace {

std::size_t hashOf(std::string_view text) {
  return std::hash<std::string_view>()(text);
}

/// Of the word, and of what is left of it without each of its letters.
std::vector<std::size_t> hashesOf(const std::string& word) {
  std::vector<std::size_t> hashes{hashOf(word)};
  if (word.empty()) return hashes;
  std::string rest = word.substr(1);  // without the first letter, then without the next one
  for (std::size_t at = 0;; ++at) {
    const std::size_t hash = hashOf(rest);
    if (std::find(hashes.begin(), hashes.end(), hash) == hashes.end()) hashes.push_back(hash);
    if (at == rest.size()) return hashes;
    rest[at] = word[at];
  }
}

}  // namespace

void SlipIndex::add(const std::string& word, int number) {
  entries_.push_back({word, number});
  for (const std::size_t hash : hashesOf(word)) by_rest_.emplace(hash, entries_.size() - 1);
}

bool SlipIndex::find(const std::string& said, const std::function<bool(const Entry&)>& f) const {
  for (const std::size_t hash : hashesOf(said)) {
    const auto [begin, end] = by_rest_.equal_range(hash);
    for (auto each = begin; each != end; ++each) {
      const Entry& entry = entries_[each->second];
      if (hyselam::isOneEditApart(said, entry.word) && f(entry)) return true;
    }
  }
  return false;
}

std::vector<int> SlipIndex::near(const std::string& said) const {
  std::vector<int> found;
  find(said, [&](const Entry& entry) {
    found.push_back(entry.number);
    return false;
  });
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

bool SlipIndex::hasNear(const std::string& said) const {
  return find(said, [](const Entry&) { return true; });
}

}  // namespace language
}  // namespace hyselam_topo
