#include "ngram_slam/matching/reverse_ngram_matcher.hpp"

#include <algorithm>
#include <functional>
#include <iterator>

#include "matcher_parts.hpp"

namespace ngram_slam {

ReverseNgramMatcher::ReverseNgramMatcher(const WordLattice& text, const NgramMatcherParams& params)
    : text_(text),
      params_(params),
      passes_(params.min_n.size()),
      gram_(gramOf(params)),
      index_(text, params.tolerance, gram_, params.index_bits, true),
      rows_(static_cast<std::size_t>(text.levels()) + 2) {
  requirePassForEachLevel(passes_, text);
}

const std::vector<NgramMatch>& ReverseNgramMatcher::update() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) take(next_, true);
  return matches_;
}

void ReverseNgramMatcher::skip() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) take(next_, false);
}

void ReverseNgramMatcher::take(Position p, bool searching) {
  ++counters_.positions;
  if (p > 0) {
    // The text has completed the words that end at the position before: so do we.
    const WordRange before = text_.endingAt(p - 1);
    if (searching) {
      for (WordIndex w = before.begin + 1; w < before.end; ++w) search(w, row(p - 1), false);
      complete(p - 1, row(p - 1));
    }
    for (WordIndex w = before.begin; w < before.end; ++w) index_.insert(w);
  }
  Row& fresh = row(p);
  for (const Grams& g : fresh.grams) fresh.has.clear(g.begin);
  fresh.grams.clear();
  if (searching) search(text_.realWord(p), fresh, true);
}

void ReverseNgramMatcher::search(WordIndex newer, Row& target, bool report) {
  found_.clear();
  found_ends_.clear();
  follow(newer, report);
  started_from_ = found_.size();
  start(newer, report);
  merge(target);
}

/// Carries on the grams that ended just before `newer`: their older words begin just after its
/// partner.
void ReverseNgramMatcher::follow(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  if (text_.startsRun(first)) return;
  const Syllables wanted = reversed(text_.syllables(newer));
  const int newer_level = text_.level(newer);
  const std::vector<Grams>& before = row(first - 1).grams;
  for (std::size_t i = 0; i < before.size(); ++i) {
    // Old words lie far apart in memory: they are fetched ahead.
    if (i + 2 * kAhead < before.size()) text_.prefetchPosition(before[i + 2 * kAhead].begin - 1);
    if (i + kAhead < before.size()) text_.prefetchWords(before[i + kAhead].begin - 1);
    const Grams& g = before[i];
    if (text_.startsRun(g.begin)) continue;
    const WordRange older = text_.endingAt(g.begin - 1);
    for (WordIndex b = older.begin; b < older.end; ++b) {
      ++counters_.comparisons;
      if (!wordsMatch(wanted, text_.syllables(b), params_.tolerance)) continue;
      ++counters_.live;
      Lengths longer{};
      for (auto k = static_cast<std::size_t>(std::max(newer_level, text_.level(b))); k < passes_;
           ++k)
        longer[k] = oneMore(g.lengths[k]);
      enter(newer, b, longer, report);
      found_ends_.push_back(g.begin - 1);
    }
  }
}

/// Finds the grams that have just become `gram_` words long, newest first, until there are enough.
void ReverseNgramMatcher::start(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  const Row* before = text_.startsRun(first) ? nullptr : &row(first - 1);
  const auto most = static_cast<std::size_t>(params_.max_followed);
  // What is being followed already, in the order in which the older words end.
  std::size_t older_followed = found_ends_.size(), enough = 0, tried = 0;
  index_.ask(newer);
  while (enough < most && tried < kMostTried * most && index_.answer(part_)) {
    candidates_.clear();
    for (std::size_t i = 0; i < part_.size(); ++i) {
      if (i + 2 * kAhead < part_.size())
        text_.prefetchPosition(GramIndex::endOf(part_[i + 2 * kAhead]));
      if (i + kAhead < part_.size()) text_.prefetchWords(GramIndex::endOf(part_[i + kAhead]));
      const Position end = GramIndex::endOf(part_[i]);
      if (end >= first) continue;
      // Where a gram of enough words ended just before, it is being followed.
      if (before != nullptr && before->has.has(end + 1) && !text_.startsRun(end + 1)) continue;
      WordIndex older;
      if (text_.findEndingAt(end, GramIndex::levelOf(part_[i]), &older))
        candidates_.push_back(older);
    }
    std::sort(candidates_.begin(), candidates_.end(), std::greater<>());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
    tried += candidates_.size();
    for (WordIndex older : candidates_) {
      for (; older_followed > 0 && found_ends_[older_followed - 1] > text_.last(older);
           --older_followed)
        ++enough;
      if (enough >= most) break;
      const Lengths lengths = lengthsFromScratch(newer, older, gram_, text_.levels());
      if (lengths[passes_ - 1] < gram_) continue;
      ++counters_.started;
      ++enough;
      enter(newer, older, lengths, report);
    }
  }
}

/// Lengths of the longest grams that end with this pair, up to `depth` words of the levels below
/// `levels`.
ReverseNgramMatcher::Lengths ReverseNgramMatcher::lengthsFromScratch(WordIndex newer,
                                                                     WordIndex older, int depth,
                                                                     int levels) {
  Lengths best{};
  if (text_.level(newer) >= levels || text_.level(older) >= levels) return best;
  if (text_.last(older) >= text_.first(newer)) return best;
  ++counters_.comparisons;
  if (!wordsMatch(text_.syllables(newer), reversed(text_.syllables(older)), params_.tolerance))
    return best;
  if (depth > 1) {
    const WordRange before = text_.predecessors(newer);
    for (WordIndex a = before.begin; a < before.end; ++a)
      text_.forEachSuccessor(older, levels, [&](WordIndex b) {
        const Lengths l = lengthsFromScratch(a, b, depth - 1, levels);
        for (std::size_t k = 0; k < passes_; ++k) best[k] = std::max(best[k], l[k]);
      });
  }
  const auto from = static_cast<std::size_t>(std::max(text_.level(newer), text_.level(older)));
  for (std::size_t k = 0; k < passes_; ++k)
    best[k] = k < from ? std::uint16_t{0} : oneMore(best[k]);
  return best;
}

/// Adds what pairs with grams too short to be followed say about the passes of low levels, as
/// NgramMatcher::complete does.
void ReverseNgramMatcher::complete(Position newer_end, Row& target) {
  const WordRange newer = text_.endingAt(newer_end);
  for (Grams& g : target.grams) {
    int levels = 0;  // passes whose lengths may be too short; the higher ones have longer grams
    while (static_cast<std::size_t>(levels) < passes_ &&
           g.lengths[static_cast<std::size_t>(levels)] < gram_)
      ++levels;
    if (levels == 0) continue;
    for (WordIndex a = newer.begin; a < newer.end; ++a)
      text_.forEachBeginningAt(g.begin, levels, [&](WordIndex b) {
        const Lengths l = lengthsFromScratch(a, b, gram_, levels);
        for (std::size_t k = 0; k < static_cast<std::size_t>(levels); ++k)
          g.lengths[k] = std::max(g.lengths[k], l[k]);
      });
  }
}

void ReverseNgramMatcher::enter(WordIndex newer, WordIndex older, const Lengths& lengths,
                                bool report) {
  found_.push_back({text_.first(older), lengths});
  if (!report) return;
  for (std::size_t k = 0; k < passes_; ++k) {
    if (lengths[k] < params_.min_n[k]) continue;
    NgramMatch m;
    m.newer = newer;
    m.older = older;
    m.levels = static_cast<int>(k) + 1;
    m.n = lengths[k];
    m.direction = Direction::kReverse;
    matches_.push_back(m);
    return;
  }
}

/// Adds what was found; of grams that meet the longest in each pass counts, of too many the newest.
void ReverseNgramMatcher::merge(Row& target) {
  const auto earlier = [](const Grams& a, const Grams& b) { return a.begin < b.begin; };
  // Both parts of what was found are nearly in order, the second from the newest on.
  const auto started = found_.begin() + static_cast<std::ptrdiff_t>(started_from_);
  std::reverse(started, found_.end());
  const auto arrange = [&](std::vector<Grams>::iterator from, std::vector<Grams>::iterator to) {
    for (auto g = from; g != to; ++g)
      for (auto h = g; h != from && earlier(*h, *(h - 1)); --h) std::iter_swap(h, h - 1);
  };
  arrange(found_.begin(), started);
  arrange(started, found_.end());
  std::inplace_merge(found_.begin(), started, found_.end(), earlier);
  merged_.clear();
  merged_.reserve(target.grams.size() + found_.size());
  std::merge(target.grams.begin(), target.grams.end(), found_.begin(), found_.end(),
             std::back_inserter(merged_), earlier);
  std::swap(target.grams, merged_);

  std::vector<Grams>& grams = target.grams;
  std::size_t kept = 0;
  for (const Grams& g : grams) {
    if (kept > 0 && grams[kept - 1].begin == g.begin) {
      Lengths& best = grams[kept - 1].lengths;
      for (std::size_t k = 0; k < passes_; ++k) best[k] = std::max(best[k], g.lengths[k]);
    } else {
      target.has.set(g.begin);
      grams[kept++] = g;
    }
  }
  grams.resize(kept);
  const auto most = static_cast<std::size_t>(params_.max_followed);
  if (kept <= most) return;
  const auto many = static_cast<std::ptrdiff_t>(kept - most);
  for (auto g = grams.begin(); g != grams.begin() + many; ++g) target.has.clear(g->begin);
  grams.erase(grams.begin(), grams.begin() + many);
}

std::size_t ReverseNgramMatcher::bytes() const {
  std::size_t sum = index_.bytes() + (found_.capacity() + merged_.capacity()) * sizeof(Grams);
  for (const Row& r : rows_) sum += r.grams.capacity() * sizeof(Grams) + r.has.bytes();
  return sum;
}

}  // namespace ngram_slam
