// Words that can be found although a letter of them is wrong (isOneEditApart()), without looking at
// all of them: two such words have one in common of what is left of them without one letter.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

namespace hyselam_topo {
namespace language {

class SlipIndex {
 public:
  void add(const std::string& word, int number);

  /// The numbers of all words that are one edit apart from what was said, ascending.
  std::vector<int> near(const std::string& said) const;
  /// Whether there is one.
  bool hasNear(const std::string& said) const;

 private:
  struct Entry {
    std::string word;
    int number = 0;
  };
  /// Calls f(entry) for those one edit apart, some of them more than once, until it returns true.
  bool find(const std::string& said, const std::function<bool(const Entry&)>& f) const;

  std::vector<Entry> entries_;
  /// Hash of a word, or of what is left of it without one letter, to its entry.
  std::unordered_multimap<std::size_t, std::size_t> by_rest_;
};

}  // namespace language
}  // namespace hyselam_topo
