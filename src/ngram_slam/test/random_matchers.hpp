// Parameters of matchers for tests on random texts.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "hyselam_common/rng.hpp"
#include "ngram_slam/matching/ngram_matcher.hpp"
#include "transcription/matching.hpp"

namespace random_texts {

/// Of a matcher of either direction.
inline ngram_slam::NgramMatcherParams randomParams(hyselam::Rng& rng, int levels) {
  ngram_slam::NgramMatcherParams p;
  p.tolerance.size = 0.1003 + 0.1 * rng.below(4);  // no ratio of small numbers: no ties
  p.tolerance.angle = hyselam::radians(15.0 + 15.0 * rng.below(4));
  p.min_n.clear();
  int n = 1 + static_cast<int>(rng.below(5));
  for (int l = 0; l < levels; ++l) {
    p.min_n.push_back(n);
    n += static_cast<int>(rng.below(4));
  }
  p.index_gram = 1 + static_cast<int>(rng.below(4));
  p.index_bits = 4 + static_cast<int>(rng.below(8));
  return p;
}

/// Reads a whole text into `text`, word by word or several at once; what the matcher tells.
template <typename Matcher>
std::vector<ngram_slam::NgramMatch> matchesOf(const ngram_slam::WordLattice& whole, bool one_by_one,
                                              hyselam::Rng& rng, ngram_slam::WordLattice& text,
                                              Matcher& matcher) {
  std::vector<ngram_slam::NgramMatch> found;
  for (ngram_slam::Position p = 0; p < whole.positions(); ++p) {
    if (whole.startsRun(p)) text.startRun();
    text.push(whole.syllables(whole.realWord(p)));
    if (!one_by_one && p + 1 < whole.positions() && rng.below(5) != 0) continue;
    const auto& m = matcher.update();
    found.insert(found.end(), m.begin(), m.end());
  }
  return found;
}

/// Pairs of words (newer, older), each with the lowest pass that accepts it and its longest n-gram
/// there.
using MatchedPairs =
    std::map<std::pair<ngram_slam::WordIndex, ngram_slam::WordIndex>, std::pair<int, int>>;

/// By a table of all pairs of each pass.
template <typename Table>
MatchedPairs matchedPairs(const std::vector<transcription::PlainWord>& words, int levels,
                          const ngram_slam::NgramMatcherParams& params) {
  using ngram_slam::WordIndex;
  MatchedPairs expected;
  for (int k = 1; k <= levels; ++k) {
    const Table table(words, k, params.tolerance);
    for (WordIndex a = 0; a < words.size(); ++a) {
      if (words[a].level != 0) continue;
      for (WordIndex b = 0; b < a; ++b) {
        if (table.at(a, b) >= params.min_n[static_cast<std::size_t>(k - 1)]) {
          expected.emplace(std::make_pair(a, b), std::make_pair(k, table.at(a, b)));
        }
      }
    }
  }
  return expected;
}

}  // namespace random_texts
