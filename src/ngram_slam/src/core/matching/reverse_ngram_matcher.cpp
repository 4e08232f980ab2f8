#include "ngram_slam/matching/reverse_ngram_matcher.hpp"

#include <algorithm>
#include <iterator>

namespace ngram_slam {

ReverseNgramMatcher::ReverseNgramMatcher(const WordLattice& text, const NgramMatcherParams& params)
    : NgramSearch(text, params, Direction::kReverse),
      rows_(static_cast<std::size_t>(text.levels()) + 2) {}

void ReverseNgramMatcher::addPosition(Position p, bool searching) {
  ++counters_.positions;
  if (p > 0) {
    // The text has completed the words that end at the position before: so do we.
    const WordRange before = text_.endingAt(p - 1);
    if (searching) {
      for (WordIndex w = before.begin + 1; w < before.end; ++w) findGrams(w, rowOf(p - 1), false);
      completeLengths(p - 1, rowOf(p - 1));
    }
    for (WordIndex w = before.begin; w < before.end; ++w) index_.insert(w);
  }
  GramRow& row = rowOf(p);
  for (const Gram& g : row.grams) row.begins.clear(g.begin);
  row.grams.clear();
  if (searching) findGrams(text_.realWord(p), row, true);
}

/// Finds all grams that end with `newer`.
void ReverseNgramMatcher::findGrams(WordIndex newer, GramRow& row, bool report) {
  found_.clear();
  found_ends_.clear();
  continueGrams(newer, report);
  started_from_ = found_.size();
  startNewGrams(newer, report);
  sortFound();
  mergeFound(row);
  dropOldestGrams(row);
}

/// Continues the grams that ended just before `newer`: their next older words end just before the
/// ones they have.
void ReverseNgramMatcher::continueGrams(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  if (text_.startsRun(first)) return;
  const Syllables wanted = reversed(text_.syllables(newer));
  const int newer_level = text_.level(newer);
  const std::vector<Gram>& before = rowOf(first - 1).grams;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (i + 2 * kPrefetchDistance < before.size()) {
      text_.prefetchPosition(before[i + 2 * kPrefetchDistance].begin - 1);
    }
    if (i + kPrefetchDistance < before.size()) {
      text_.prefetchWords(before[i + kPrefetchDistance].begin - 1);
    }
    const Gram& g = before[i];
    if (text_.startsRun(g.begin)) continue;
    const WordRange older = text_.endingAt(g.begin - 1);
    for (WordIndex b = older.begin; b < older.end; ++b) {
      ++counters_.comparisons;
      if (!wordsMatch(wanted, text_.syllables(b), params_.tolerance)) continue;
      ++counters_.live;
      Lengths longer{};
      for (auto k = static_cast<std::size_t>(std::max(newer_level, text_.level(b))); k < passes_;
           ++k) {
        longer[k] = oneMore(g.lengths[k]);
      }
      addGram(newer, b, longer, report);
      found_ends_.push_back(g.begin - 1);
    }
  }
}

void ReverseNgramMatcher::startNewGrams(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  const GramRow* before = text_.startsRun(first) ? nullptr : &rowOf(first - 1);
  // What was continued, in the order in which the older words end.
  std::size_t uncounted = found_ends_.size();
  startGrams(
      newer,
      [&](GramIndex::Entry entry) {
        const Position next = GramIndex::endOf(entry) + 1;
        return before != nullptr && before->begins.has(next) && !text_.startsRun(next);
      },
      [&](Position end) {
        const std::size_t from = uncounted;
        while (uncounted > 0 && found_ends_[uncounted - 1] > end) --uncounted;
        return from - uncounted;
      },
      [&](WordIndex older, const Lengths& lengths) { addGram(newer, older, lengths, report); });
}

/// As NgramMatcher::completeLengths().
void ReverseNgramMatcher::completeLengths(Position newer_end, GramRow& row) {
  const WordRange newer = text_.endingAt(newer_end);
  for (Gram& g : row.grams) {
    const int passes = incompletePasses(g.lengths.data());
    if (passes == 0) continue;
    for (WordIndex a = newer.begin; a < newer.end; ++a) {
      text_.forEachBeginningAt(g.begin, passes, [&](WordIndex b) {
        const Lengths l = lengthsFromScratch(a, b, index_gram_, passes);
        for (std::size_t k = 0; k < static_cast<std::size_t>(passes); ++k) {
          g.lengths[k] = std::max(g.lengths[k], l[k]);
        }
      });
    }
  }
}

void ReverseNgramMatcher::addGram(WordIndex newer, WordIndex older, const Lengths& lengths,
                                  bool report) {
  found_.push_back({text_.first(older), lengths});
  if (report) reportMatch(newer, older, lengths.data());
}

/// Sorts found_ by `begin`. What was continued is nearly in order already, what was started nearly
/// in the opposite one, so insertion sort moves little.
void ReverseNgramMatcher::sortFound() {
  const auto earlier = [](const Gram& a, const Gram& b) { return a.begin < b.begin; };
  const auto started = found_.begin() + static_cast<std::ptrdiff_t>(started_from_);
  std::reverse(started, found_.end());
  const auto insertionSort = [&](std::vector<Gram>::iterator from, std::vector<Gram>::iterator to) {
    for (auto g = from; g != to; ++g) {
      for (auto h = g; h != from && earlier(*h, *(h - 1)); --h) std::iter_swap(h, h - 1);
    }
  };
  insertionSort(found_.begin(), started);
  insertionSort(started, found_.end());
  std::inplace_merge(found_.begin(), started, found_.end(), earlier);
}

/// Adds found_; of grams that begin and end at the same positions the longest in each pass counts.
void ReverseNgramMatcher::mergeFound(GramRow& row) {
  merged_.clear();
  merged_.reserve(row.grams.size() + found_.size());
  std::merge(row.grams.begin(), row.grams.end(), found_.begin(), found_.end(),
             std::back_inserter(merged_),
             [](const Gram& a, const Gram& b) { return a.begin < b.begin; });
  std::swap(row.grams, merged_);

  std::vector<Gram>& grams = row.grams;
  std::size_t kept = 0;
  for (const Gram& g : grams) {
    if (kept > 0 && grams[kept - 1].begin == g.begin) {
      Lengths& best = grams[kept - 1].lengths;
      for (std::size_t k = 0; k < passes_; ++k) best[k] = std::max(best[k], g.lengths[k]);
    } else {
      row.begins.set(g.begin);
      grams[kept++] = g;
    }
  }
  grams.resize(kept);
}

/// Where more than max_followed grams are followed, the oldest are dropped.
void ReverseNgramMatcher::dropOldestGrams(GramRow& row) {
  const auto max_followed = static_cast<std::size_t>(params_.max_followed);
  if (row.grams.size() <= max_followed) return;
  const auto dropped = static_cast<std::ptrdiff_t>(row.grams.size() - max_followed);
  for (auto g = row.grams.begin(); g != row.grams.begin() + dropped; ++g) {
    row.begins.clear(g->begin);
  }
  row.grams.erase(row.grams.begin(), row.grams.begin() + dropped);
}

std::size_t ReverseNgramMatcher::bytes() const {
  std::size_t sum = index_.bytes() + (found_.capacity() + merged_.capacity()) * sizeof(Gram);
  for (const GramRow& row : rows_) sum += row.grams.capacity() * sizeof(Gram) + row.begins.bytes();
  return sum;
}

}  // namespace ngram_slam
