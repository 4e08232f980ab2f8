#include "ngram_slam/matching/ngram_matcher.hpp"

#include <algorithm>
#include <utility>

namespace ngram_slam {

NgramMatcher::NgramMatcher(const WordLattice& text, const NgramMatcherParams& params)
    : NgramSearch(text, params, Direction::kSame),
      // An alternative word of the highest level L - 1 that ends at p starts after row p - L - 1.
      rows_(static_cast<std::size_t>(text.levels()) + 2),
      found_(static_cast<std::size_t>(text.levels()) + 1) {
  alternatives_.push_back({});  // 0 means none
}

void NgramMatcher::GramList::reverse(std::size_t passes) {
  std::reverse(ends.begin(), ends.end());
  for (std::size_t i = 0, j = ends.size(); i + 1 < j--; ++i) {
    std::swap_ranges(lengths.begin() + static_cast<std::ptrdiff_t>(i * passes),
                     lengths.begin() + static_cast<std::ptrdiff_t>((i + 1) * passes),
                     lengths.begin() + static_cast<std::ptrdiff_t>(j * passes));
  }
}

void NgramMatcher::addPosition(Position p, bool searching) {
  ++counters_.positions;
  if (p > 0) addAlternatives(p - 1, searching);
  const WordIndex newest = text_.realWord(p);
  real_words_.push_back(packWord(newest, text_.startsRun(p) ? PackedWord::kStartsRun : 0u));
  if (text_.startsRun(p)) run_starts_.set(p);
  GramRow& row = rowOf(p);
  for (const Position end : row.grams.ends) row.ends.clear(end);
  row.grams.clear();
  if (searching) findGrams(newest, row, true);
}

/// The text writes the alternative words that end at a position once the next word is known; from
/// then on all words that end there can be found as old ones.
void NgramMatcher::addAlternatives(Position end, bool searching) {
  const WordRange words = text_.endingAt(end);
  for (WordIndex w = words.begin + 1; w < words.end; ++w) {
    PackedWord alternative = packWord(w, static_cast<std::uint32_t>(text_.level(w)));
    PackedWord& real = real_words_[text_.first(w)];
    alternative.next_alternative = real.next_alternative;
    real.next_alternative = static_cast<std::uint32_t>(alternatives_.size());
    alternatives_.push_back(alternative);
    real_words_[end].attributes |= PackedWord::kAlternativesEnd;
    if (searching) findGrams(w, rowOf(end), false);
  }
  if (searching) completeLengths(end, rowOf(end));
  for (WordIndex w = words.begin; w < words.end; ++w) index_.insert(w);
}

/// Finds all grams that end with `newer`.
void NgramMatcher::findGrams(WordIndex newer, GramRow& row, bool report) {
  for (GramList& list : found_) list.clear();
  continueGrams(newer, report);
  startNewGrams(newer, report);
  for (GramList& list : found_) mergeGrams(row, list);
  dropOldestGrams(row);
}

/// Continues the grams that ended just before `newer` with the words that follow their older words.
///
/// This is what a word costs, up to 8192 comparisons (max_followed) with words all over memory.
/// Two things keep it fast. The words are prefetched: a cache miss is over before its word is
/// compared, and many misses overlap. And the first loop writes every candidate into the next free
/// entry and moves on by 0 or 1, so that it has no branch on whether the words match: which of them
/// do is as good as random, and every second branch would be mispredicted.
void NgramMatcher::continueGrams(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  if (text_.startsRun(first)) return;
  const GramList& before = rowOf(first - 1).grams;
  const MatchBounds bounds = boundsOf(text_.syllables(newer));
  // They are in order: those that reach the newer word are the last ones.
  const auto count = static_cast<std::size_t>(
      std::lower_bound(before.ends.begin(), before.ends.end(), first - 1) - before.ends.begin());
  continued_.resize(count);
  with_alternatives_.resize(count);
  std::size_t continued = 0, with_alternatives = 0;
  for (std::size_t i = 0; i < count; ++i) {
    prefetch(real_words_[before.ends[std::min(i + kPrefetchDistance, count - 1)] + 1]);
    const PackedWord& older = real_words_[before.ends[i] + 1];
    const bool in_run = (older.attributes & PackedWord::kStartsRun) == 0;
    continued_[continued] = {static_cast<std::uint32_t>(i), older.word};
    continued += in_run & isWithin(bounds, older);
    with_alternatives_[with_alternatives] = {static_cast<std::uint32_t>(i), older.next_alternative};
    with_alternatives += in_run & (older.next_alternative != 0);
  }
  counters_.comparisons += count;
  counters_.live += continued;
  continueWithRealWords(newer, before, continued, report);
  continueWithAlternatives(newer, bounds, before, with_alternatives, report);
}

/// Adds the first `count` of continued_, whose real words match.
void NgramMatcher::continueWithRealWords(WordIndex newer, const GramList& before, std::size_t count,
                                         bool report) {
  const auto newer_level = static_cast<std::size_t>(text_.level(newer));
  GramList& real = found_[0];
  real.ends.resize(count);
  real.lengths.resize(count * passes_);
  for (std::size_t i = 0; i < count; ++i) {
    const Continuation& c = continued_[i];
    const std::uint16_t* lengths = &before.lengths[c.gram * passes_];
    std::uint16_t* longer = &real.lengths[i * passes_];
    real.ends[i] = before.ends[c.gram] + 1;
    for (std::size_t k = 0; k < passes_; ++k) {
      longer[k] = k < newer_level ? std::uint16_t{0} : oneMore(lengths[k]);
    }
    if (report) reportMatch(newer, c.word, longer);
  }
}

/// Compares the alternative words of the first `count` of with_alternatives_, and adds what
/// matches.
void NgramMatcher::continueWithAlternatives(WordIndex newer, const MatchBounds& bounds,
                                            const GramList& before, std::size_t count,
                                            bool report) {
  const Position first = text_.first(newer);
  const auto newer_level = static_cast<std::size_t>(text_.level(newer));
  for (std::size_t i = 0; i < count; ++i) {
    prefetch(alternatives_[with_alternatives_[std::min(i + kPrefetchDistance, count - 1)].word]);
    const std::size_t gram = with_alternatives_[i].gram;
    const std::uint16_t* lengths = &before.lengths[gram * passes_];
    for (std::uint32_t next = with_alternatives_[i].word; next != 0;) {
      const PackedWord& alternative = alternatives_[next];
      next = alternative.next_alternative;
      const std::size_t level = alternative.attributes & 15u;
      const Position end = before.ends[gram] + static_cast<Position>(level) + 2;
      if (end >= first) continue;
      ++counters_.comparisons;
      if (!isWithin(bounds, alternative)) continue;
      ++counters_.live;
      Lengths longer{};
      for (std::size_t k = std::max(level, newer_level); k < passes_; ++k) {
        longer[k] = oneMore(lengths[k]);
      }
      found_[level].add(end, longer.data(), passes_);
      if (report) reportMatch(newer, alternative.word, longer.data());
    }
  }
}

void NgramMatcher::startNewGrams(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  const GramRow* before = text_.startsRun(first) ? nullptr : &rowOf(first - 1);
  std::vector<std::size_t> uncounted;  // pairs of each list in found_
  for (const GramList& list : found_) uncounted.push_back(list.ends.size());
  GramList& started = found_.back();
  startGrams(
      newer,
      [&](GramIndex::Entry entry) {
        const Position begin = GramIndex::firstOf(entry);
        return before != nullptr && begin > 0 && before->ends.has(begin - 1) &&
               !run_starts_.has(begin);
      },
      [&](Position end) {
        std::size_t newer_pairs = 0;
        for (std::size_t l = 0; l + 1 < found_.size(); ++l) {
          for (std::size_t& n = uncounted[l]; n > 0 && found_[l].ends[n - 1] > end; --n) {
            ++newer_pairs;
          }
        }
        return newer_pairs;
      },
      [&](WordIndex older, const Lengths& lengths) {
        started.add(text_.last(older), lengths.data(), passes_);
        if (report) reportMatch(newer, older, lengths.data());
      });
  started.reverse(passes_);
}

/// Where more than max_followed grams are followed, the oldest are dropped.
void NgramMatcher::dropOldestGrams(GramRow& row) {
  GramList& grams = row.grams;
  const auto max_followed = static_cast<std::size_t>(params_.max_followed);
  if (grams.ends.size() <= max_followed) return;
  const auto dropped = static_cast<std::ptrdiff_t>(grams.ends.size() - max_followed);
  for (auto end = grams.ends.begin(); end != grams.ends.begin() + dropped; ++end) {
    row.ends.clear(*end);
  }
  grams.ends.erase(grams.ends.begin(), grams.ends.begin() + dropped);
  grams.lengths.erase(grams.lengths.begin(),
                      grams.lengths.begin() + dropped * static_cast<std::ptrdiff_t>(passes_));
}

/// The sizes that match are found by wordsMatch itself, so that rounding cannot make a difference.
NgramMatcher::MatchBounds NgramMatcher::boundsOf(const Syllables& s) const {
  Syllables other = s;
  const auto fits = [&](std::uint32_t size) {
    other.size = size;
    return size >= 1 && wordsMatch(s, other, params_.tolerance);
  };
  const double share = 1.0 - params_.tolerance.size;
  auto smallest = std::min(s.size, static_cast<std::uint32_t>(s.size * share) + 1);
  while (fits(smallest - 1)) --smallest;
  while (!fits(smallest)) ++smallest;
  auto largest = std::max(s.size, static_cast<std::uint32_t>(s.size / share) - 1);
  while (fits(largest + 1)) ++largest;
  while (!fits(largest)) --largest;
  return {static_cast<std::uint32_t>(s.density_class), smallest, largest - smallest, s.angle};
}

/// Raises the lengths of the passes of low levels where grams too short to be followed are longer:
/// an alternative word may carry a long gram to where two real words end a short one.
void NgramMatcher::completeLengths(Position newer_end, GramRow& row) {
  const WordRange newer = text_.endingAt(newer_end);
  const MatchBounds bounds = boundsOf(text_.syllables(newer.begin));
  GramList& grams = row.grams;
  for (std::size_t i = 0; i < grams.ends.size(); ++i) {
    prefetch(real_words_[grams.ends[std::min(i + kPrefetchDistance, grams.ends.size() - 1)]]);
    std::uint16_t* lengths = &grams.lengths[i * passes_];
    const int passes = incompletePasses(lengths);
    if (passes == 0) continue;
    const PackedWord& end = real_words_[grams.ends[i]];
    if (newer.size() == 1 && (end.attributes & PackedWord::kAlternativesEnd) == 0) continue;
    if (passes == 1 && !isWithin(bounds, end)) continue;
    const WordRange older = text_.endingAt(grams.ends[i]);
    for (WordIndex a = newer.begin; a < newer.end; ++a) {
      for (WordIndex b = older.begin; b < older.end; ++b) {
        const Lengths l = lengthsFromScratch(a, b, index_gram_, passes);
        for (std::size_t k = 0; k < static_cast<std::size_t>(passes); ++k) {
          lengths[k] = std::max(lengths[k], l[k]);
        }
      }
    }
  }
}

NgramMatcher::PackedWord NgramMatcher::packWord(WordIndex word, std::uint32_t flags) const {
  const Syllables s = text_.syllables(word);
  return {s.angle, static_cast<std::uint32_t>(s.density_class) << 24 | s.size << 4 | flags, word,
          0};
}

/// Both lists are in order; of grams that end at the same positions the longest in each pass
/// counts. `more` is used up: what it holds afterwards is unspecified.
void NgramMatcher::mergeGrams(GramRow& row, GramList& more) {
  if (more.ends.empty()) return;
  for (const Position end : more.ends) row.ends.set(end);
  if (row.grams.ends.empty() && &more != &found_.back()) {  // no position twice
    std::swap(row.grams, more);
    return;
  }
  const GramList& old = row.grams;
  merged_.clear();
  merged_.ends.reserve(old.ends.size() + more.ends.size());
  merged_.lengths.reserve(old.lengths.size() + more.lengths.size());
  const auto append = [&](const GramList& from, std::size_t i) {
    const std::uint16_t* lengths = &from.lengths[i * passes_];
    if (!merged_.ends.empty() && merged_.ends.back() == from.ends[i]) {
      std::uint16_t* best = &merged_.lengths[merged_.lengths.size() - passes_];
      for (std::size_t k = 0; k < passes_; ++k) best[k] = std::max(best[k], lengths[k]);
    } else {
      merged_.add(from.ends[i], lengths, passes_);
    }
  };
  std::size_t a = 0, b = 0;
  while (a < old.ends.size() && b < more.ends.size()) {
    if (old.ends[a] <= more.ends[b]) {
      append(old, a++);
    } else {
      append(more, b++);
    }
  }
  while (a < old.ends.size()) append(old, a++);
  while (b < more.ends.size()) append(more, b++);
  std::swap(row.grams, merged_);
}

std::size_t NgramMatcher::bytes() const {
  const auto of = [](const GramList& list) {
    return list.ends.capacity() * sizeof(Position) +
           list.lengths.capacity() * sizeof(std::uint16_t);
  };
  std::size_t sum = index_.bytes() + real_words_.bytes() + alternatives_.bytes() +
                    run_starts_.bytes() + of(merged_);
  for (const GramList& list : found_) sum += of(list);
  for (const GramRow& row : rows_) sum += of(row.grams) + row.ends.bytes();
  return sum;
}

}  // namespace ngram_slam
