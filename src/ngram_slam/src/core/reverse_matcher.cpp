#include "ngram_slam/reverse_matcher.hpp"

#include <algorithm>
#include <string>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {
namespace {
std::uint16_t oneMore(std::uint16_t n) {
  return static_cast<std::uint16_t>(n == 65535 ? n : n + 1);
}
int gramOf(const MatcherParams& p) {
  p.validate();
  return std::min(p.index_gram, *std::min_element(p.min_n.begin(), p.min_n.end()));
}
}  // namespace

ReverseMatcher::ReverseMatcher(const Text& text, const MatcherParams& params)
    : text_(text),
      params_(params),
      passes_(params.min_n.size()),
      gram_(gramOf(params)),
      index_(text, params.tolerance, gram_, params.index_bits, true),
      rows_(static_cast<std::size_t>(text.levels()) + 2) {
  if (passes_ != static_cast<std::size_t>(text.levels()))
    throw hyselam::ParameterError(
        "number of entries of min_n", passes_,
        "the number of levels of the text, " + std::to_string(text.levels()));
}

const std::vector<Match>& ReverseMatcher::update() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) take(next_, true);
  return matches_;
}

void ReverseMatcher::skip() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) take(next_, false);
}

void ReverseMatcher::take(Position p, bool searching) {
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
  fresh.clear();
  if (searching) search(text_.realWord(p), fresh, true);
}

void ReverseMatcher::search(WordIndex newer, Row& target, bool report) {
  found_.clear();
  follow(newer, report);
  start(newer, report);
  merge(target);
}

/// Carries on the grams that ended just before `newer`: their older words begin just after its
/// partner.
void ReverseMatcher::follow(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  if (text_.startsRun(first)) return;
  const Syllables wanted = reversed(text_.syllables(newer));
  const int newer_level = text_.level(newer);
  for (const Grams& g : row(first - 1)) {
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
    }
  }
}

/// Finds the grams that have just become `gram_` words long.
void ReverseMatcher::start(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  const Row* before = text_.startsRun(first) ? nullptr : &row(first - 1);
  candidates_.clear();
  index_.ask(newer);
  while (index_.answer(part_))
    for (GramIndex::Entry e : part_) {
      const Position end = GramIndex::endOf(e);
      if (end >= first) continue;
      // Where a gram of enough words ended just before, it is being followed.
      if (before != nullptr && !text_.startsRun(end + 1) && contains(*before, end + 1)) continue;
      WordIndex older;
      if (text_.findEndingAt(end, GramIndex::levelOf(e), &older)) candidates_.push_back(older);
    }
  std::sort(candidates_.begin(), candidates_.end());
  candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  for (WordIndex older : candidates_) {
    const Lengths lengths = lengthsFromScratch(newer, older, gram_, text_.levels());
    if (lengths[passes_ - 1] < gram_) continue;
    ++counters_.started;
    enter(newer, older, lengths, report);
  }
}

/// Lengths of the longest grams that end with this pair, up to `depth` words of the levels below
/// `levels`.
ReverseMatcher::Lengths ReverseMatcher::lengthsFromScratch(WordIndex newer, WordIndex older,
                                                           int depth, int levels) {
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
/// Matcher::complete does.
void ReverseMatcher::complete(Position newer_end, Row& target) {
  const WordRange newer = text_.endingAt(newer_end);
  for (Grams& g : target) {
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

void ReverseMatcher::enter(WordIndex newer, WordIndex older, const Lengths& lengths, bool report) {
  found_.push_back({text_.first(older), lengths});
  if (!report) return;
  for (std::size_t k = 0; k < passes_; ++k) {
    if (lengths[k] < params_.min_n[k]) continue;
    Match m;
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
void ReverseMatcher::merge(Row& target) {
  target.insert(target.end(), found_.begin(), found_.end());
  std::sort(target.begin(), target.end(),
            [](const Grams& a, const Grams& b) { return a.begin < b.begin; });
  std::size_t kept = 0;
  for (const Grams& g : target) {
    if (kept > 0 && target[kept - 1].begin == g.begin) {
      Lengths& best = target[kept - 1].lengths;
      for (std::size_t k = 0; k < passes_; ++k) best[k] = std::max(best[k], g.lengths[k]);
    } else {
      target[kept++] = g;
    }
  }
  target.resize(kept);
  const auto most = static_cast<std::size_t>(params_.max_followed);
  if (kept > most) target.erase(target.begin(), target.end() - static_cast<std::ptrdiff_t>(most));
}

bool ReverseMatcher::contains(const Row& row, Position begin) {
  const auto at = std::lower_bound(row.begin(), row.end(), begin,
                                   [](const Grams& g, Position p) { return g.begin < p; });
  return at != row.end() && at->begin == begin;
}

std::size_t ReverseMatcher::bytes() const {
  std::size_t sum = index_.bytes() + found_.capacity() * sizeof(Grams);
  for (const Row& r : rows_) sum += r.capacity() * sizeof(Grams);
  return sum;
}

}  // namespace ngram_slam
