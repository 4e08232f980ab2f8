// Alg. 5.3 as the thesis writes it, on plain lists of words, and a matcher that fills the table of
// all pairs of words. The oracles of NgramMatcher; slow on purpose.
#pragma once

#include <algorithm>
#include <list>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "ngram_slam/words/word_lattice.hpp"

namespace transcription {

/// A text as a list of words with their predecessor lists, copied out of the compact one.
struct PlainWord {
  ngram_slam::Syllables s;
  int level = 0;
  std::size_t first = 0, last = 0;
  std::vector<std::size_t> P;
};

inline std::vector<PlainWord> plainWords(const ngram_slam::WordLattice& text) {
  std::vector<PlainWord> out;
  for (ngram_slam::WordIndex i = 0; i < text.words(); ++i) {
    const auto w = text.word(i);
    PlainWord p{w.syllables, w.level, w.first, w.last, {}};
    const auto before = text.predecessors(i);
    for (auto k = before.begin; k < before.end; ++k) p.P.push_back(k);
    out.push_back(p);
  }
  return out;
}

/// 4.2.3 with Eq. 4.4; the older word ends before the newer one begins.
inline bool equal(const PlainWord& a, const PlainWord& b, const ngram_slam::WordTolerance& t) {
  if (a.s.density_class != b.s.density_class) return false;
  const double sa = a.s.size, sb = b.s.size;
  if (!(std::abs(sa - sb) / std::max(sa, sb) < t.size)) return false;
  const double turn = hyselam::normalizeAngle(static_cast<double>(a.s.angle) - b.s.angle);
  return std::abs(turn) < t.angle;
}

using Gram = std::list<std::pair<std::size_t, std::size_t>>;  // <W_i, W_u>, oldest first

/// Alg. 5.3 for the words below `levels`; each expansion works on its own copy, and a match is
/// maximal when nothing was expanded (errata). The occurrences are looked for among all words.
inline std::set<std::vector<std::pair<std::size_t, std::size_t>>> findMatches(
    const std::vector<PlainWord>& words, std::size_t w_last, int levels, std::size_t min_n,
    const ngram_slam::WordTolerance& tolerance) {
  const auto pairable = [&](std::size_t a, std::size_t b) {
    return words[a].level < levels && words[b].level < levels && words[b].last < words[a].first &&
           equal(words[a], words[b], tolerance);
  };
  std::set<std::vector<std::pair<std::size_t, std::size_t>>> M;
  std::list<Gram> M_temp;
  for (std::size_t matched = 0; matched < words.size(); ++matched) {
    if (pairable(w_last, matched)) M_temp.push_front({{w_last, matched}});
  }
  while (!M_temp.empty()) {
    const Gram g = M_temp.front();
    M_temp.pop_front();
    bool expanded = false;
    for (std::size_t prev_i : words[g.front().first].P) {
      for (std::size_t prev_ii : words[g.front().second].P) {
        if (pairable(prev_i, prev_ii)) {
          Gram longer = g;
          longer.push_front({prev_i, prev_ii});
          M_temp.push_front(longer);
          expanded = true;
        }
      }
    }
    if (!expanded && g.size() >= min_n) M.insert({g.begin(), g.end()});
  }
  return M;
}

/// The longest n-gram of every pair of words, by filling the whole table in the order of the words.
class AllPairs {
 public:
  AllPairs(const std::vector<PlainWord>& words, int levels,
           const ngram_slam::WordTolerance& tolerance)
      : n_(words.size()), length_(n_ * n_, 0) {
    for (std::size_t a = 0; a < n_; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (words[a].level >= levels || words[b].level >= levels) continue;
        if (words[b].last >= words[a].first || !equal(words[a], words[b], tolerance)) continue;
        int longest = 0;
        for (std::size_t p : words[a].P) {
          for (std::size_t q : words[b].P) longest = std::max(longest, at(p, q));
        }
        length_[a * n_ + b] = longest + 1;
      }
    }
  }
  int at(std::size_t newer, std::size_t older) const { return length_[newer * n_ + older]; }

 private:
  std::size_t n_;
  std::vector<int> length_;
};

}  // namespace transcription
