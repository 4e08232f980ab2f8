#include "ngram_slam/matching/ngram_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "matcher_parts.hpp"

namespace ngram_slam {

void NgramMatcherParams::validate() const {
  tolerance.validate();
  if (min_n.empty() || min_n.size() > static_cast<std::size_t>(WordLattice::kMaxLevels))
    throw hyselam::ParameterError("number of entries of min_n", min_n.size(), "1..16");
  for (int n : min_n)
    if (n < 1 || n > 65535) throw hyselam::ParameterError("min_n", n, "1..65535 [words]");
  if (index_gram < 1 || index_gram > 4)
    throw hyselam::ParameterError("index_gram", index_gram, "1..4 [words]");
  if (index_bits < 4 || index_bits > 28)
    throw hyselam::ParameterError("index_bits", index_bits, "4..28");
  if (max_followed < 1) throw hyselam::ParameterError("max_followed", max_followed, ">= 1");
}

NgramMatcher::NgramMatcher(const WordLattice& text, const NgramMatcherParams& params)
    : text_(text),
      params_(params),
      passes_(params.min_n.size()),
      gram_(gramOf(params)),
      index_(text, params.tolerance, gram_, params.index_bits),
      // An alternative word of the highest level L - 1 that ends at p starts after row p - L - 1.
      rows_(static_cast<std::size_t>(text.levels()) + 2),
      found_(static_cast<std::size_t>(text.levels()) + 1) {
  requirePassForEachLevel(passes_, text);
  alternatives_.push_back({});  // 0 means none
}

const std::vector<NgramMatch>& NgramMatcher::update() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) take(next_, true);
  return matches_;
}

void NgramMatcher::skip() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) take(next_, false);
}

void NgramMatcher::take(Position p, bool searching) {
  ++counters_.positions;
  if (p > 0) {
    // The text has completed the words that end at the position before: so do we.
    const WordRange before = text_.endingAt(p - 1);
    for (WordIndex w = before.begin + 1; w < before.end; ++w) {
      Begin alternative = beginOf(w, static_cast<std::uint32_t>(text_.level(w)));
      Begin& real = begins_[text_.first(w)];
      alternative.alternative = real.alternative;
      real.alternative = static_cast<std::uint32_t>(alternatives_.size());
      alternatives_.push_back(alternative);
      begins_[p - 1].tags |= Begin::kAlternativesEnd;
      if (searching) search(w, row(p - 1), false);
    }
    if (searching) complete(p - 1, row(p - 1));
    for (WordIndex w = before.begin; w < before.end; ++w) index_.insert(w);
  }
  const WordIndex newest = text_.realWord(p);
  begins_.push_back(beginOf(newest, text_.startsRun(p) ? Begin::kStartsRun : 0u));
  if (text_.startsRun(p)) run_starts_.set(p);
  Row& fresh = row(p);
  for (Position end : fresh.grams.ends) fresh.has.clear(end);
  fresh.grams.clear();
  if (searching) search(newest, fresh, true);
}

/// Finds all grams that end with `newer`.
void NgramMatcher::search(WordIndex newer, Row& target, bool report) {
  for (Grams& g : found_) g.clear();
  follow(newer, report);
  start(newer, report);
  for (Grams& g : found_) mergeInto(target, g);
  trim(target);
}

/// Carries on the grams that ended just before `newer`. Old words lie far apart in memory: they are
/// fetched ahead, and what fits is noted without a branch, which nobody could foretell.
void NgramMatcher::follow(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  if (text_.startsRun(first)) return;
  const Grams& before = row(first - 1).grams;
  const Probe newer_probe = probe(text_.syllables(newer));
  const auto newer_level = static_cast<std::size_t>(text_.level(newer));
  // They are in order: those that reach the newer word are the last ones.
  const auto count = static_cast<std::size_t>(
      std::lower_bound(before.ends.begin(), before.ends.end(), first - 1) - before.ends.begin());
  hits_.resize(count);
  branches_.resize(count);
  std::size_t hits = 0, branches = 0;
  for (std::size_t i = 0; i < count; ++i) {
    prefetch(begins_[before.ends[std::min(i + kAhead, count - 1)] + 1]);
    const Begin& older = begins_[before.ends[i] + 1];
    const bool inside = (older.tags & Begin::kStartsRun) == 0;
    hits_[hits] = {static_cast<std::uint32_t>(i), older.word};
    hits += inside & matches(newer_probe, older);
    branches_[branches] = {static_cast<std::uint32_t>(i), older.alternative};
    branches += inside & (older.alternative != 0);
  }
  counters_.comparisons += count;
  counters_.live += hits;

  Grams& real = found_[0];
  real.ends.resize(hits);
  real.lengths.resize(hits * passes_);
  for (std::size_t h = 0; h < hits; ++h) {
    const std::uint16_t* lengths = &before.lengths[hits_[h].gram * passes_];
    std::uint16_t* longer = &real.lengths[h * passes_];
    real.ends[h] = before.ends[hits_[h].gram] + 1;
    for (std::size_t k = 0; k < passes_; ++k)
      longer[k] = k < newer_level ? std::uint16_t{0} : oneMore(lengths[k]);
    if (report) tell(newer, hits_[h].word, longer);
  }
  for (std::size_t b = 0; b < branches; ++b) {
    prefetch(alternatives_[branches_[std::min(b + kAhead, branches - 1)].word]);
    const std::size_t i = branches_[b].gram;
    const std::uint16_t* lengths = &before.lengths[i * passes_];
    for (std::uint32_t next = branches_[b].word; next != 0;) {
      const Begin& alternative = alternatives_[next];
      next = alternative.alternative;
      const std::size_t level = alternative.tags & 15u;
      const Position end = before.ends[i] + static_cast<Position>(level) + 2;
      if (end >= first) continue;
      ++counters_.comparisons;
      if (!matches(newer_probe, alternative)) continue;
      ++counters_.live;
      Lengths through{};
      for (std::size_t k = std::max(level, newer_level); k < passes_; ++k)
        through[k] = oneMore(lengths[k]);
      found_[level].add(end, through.data(), passes_);
      if (report) tell(newer, alternative.word, through.data());
    }
  }
}

/// Finds the grams that have just become `gram_` words long, newest first, until there are enough.
void NgramMatcher::start(WordIndex newer, bool report) {
  const Position first = text_.first(newer);
  const Row* before = text_.startsRun(first) ? nullptr : &row(first - 1);
  const auto most = static_cast<std::size_t>(params_.max_followed);
  std::vector<std::size_t> older_followed;  // of each list in found_, those not yet passed
  for (const Grams& g : found_) older_followed.push_back(g.ends.size());
  std::size_t enough = 0;  // pairs newer than the candidate
  const auto passed = [&](Position end) {
    for (std::size_t l = 0; l + 1 < found_.size(); ++l)
      for (std::size_t& n = older_followed[l]; n > 0 && found_[l].ends[n - 1] > end; --n) ++enough;
  };
  std::size_t tried = 0;
  Grams& started = found_.back();
  index_.ask(newer);
  while (enough < most && tried < kMostTried * most && index_.answer(part_)) {
    candidates_.clear();
    for (std::size_t i = 0; i < part_.size(); ++i) {
      const GramIndex::Entry e = part_[i];
      if (i + 2 * kAhead < part_.size())
        text_.prefetchPosition(GramIndex::endOf(part_[i + 2 * kAhead]));
      if (i + kAhead < part_.size()) text_.prefetchWords(GramIndex::endOf(part_[i + kAhead]));
      const Position begin = GramIndex::firstOf(e), end = GramIndex::endOf(e);
      if (end >= first) continue;
      // Where a gram of enough words ended just before, it is being followed.
      if (before != nullptr && begin > 0 && before->has.has(begin - 1) && !run_starts_.has(begin))
        continue;
      WordIndex older;
      if (text_.findEndingAt(end, GramIndex::levelOf(e), &older)) candidates_.push_back(older);
    }
    std::sort(candidates_.begin(), candidates_.end(), std::greater<>());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
    tried += candidates_.size();
    for (WordIndex older : candidates_) {
      const Position end = text_.last(older);
      passed(end);
      if (enough >= most) break;
      const Lengths lengths = lengthsFromScratch(newer, older, gram_, text_.levels());
      if (lengths[passes_ - 1] < gram_) continue;
      ++counters_.started;
      ++enough;
      started.add(end, lengths.data(), passes_);
      if (report) tell(newer, older, lengths.data());
    }
  }
  started.reverse(passes_);
}

/// Forgets the oldest grams of too many.
void NgramMatcher::trim(Row& target) {
  Grams& grams = target.grams;
  const auto most = static_cast<std::size_t>(params_.max_followed);
  if (grams.ends.size() <= most) return;
  const auto many = static_cast<std::ptrdiff_t>(grams.ends.size() - most);
  for (auto end = grams.ends.begin(); end != grams.ends.begin() + many; ++end)
    target.has.clear(*end);
  grams.ends.erase(grams.ends.begin(), grams.ends.begin() + many);
  grams.lengths.erase(grams.lengths.begin(),
                      grams.lengths.begin() + many * static_cast<std::ptrdiff_t>(passes_));
}

/// The sizes that match are found by the rule itself, so that rounding cannot tell them apart.
NgramMatcher::Probe NgramMatcher::probe(const Syllables& s) const {
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

/// Lengths of the longest grams that end with this pair, up to `depth` words of the levels below
/// `levels`.
NgramMatcher::Lengths NgramMatcher::lengthsFromScratch(WordIndex newer, WordIndex older, int depth,
                                                       int levels) {
  Lengths best{};
  if (text_.level(newer) >= levels || text_.level(older) >= levels) return best;
  if (!match(newer, older)) return best;
  if (depth > 1) {
    const WordRange before_newer = text_.predecessors(newer);
    const WordRange before_older = text_.predecessors(older);
    for (WordIndex a = before_newer.begin; a < before_newer.end; ++a)
      for (WordIndex b = before_older.begin; b < before_older.end; ++b) {
        if (text_.last(b) >= text_.first(a)) continue;
        const Lengths l = lengthsFromScratch(a, b, depth - 1, levels);
        for (std::size_t k = 0; k < passes_; ++k) best[k] = std::max(best[k], l[k]);
      }
  }
  const auto from = static_cast<std::size_t>(std::max(text_.level(newer), text_.level(older)));
  for (std::size_t k = 0; k < passes_; ++k)
    best[k] = k < from ? std::uint16_t{0} : oneMore(best[k]);
  return best;
}

/// Adds what pairs with grams too short to be followed say about the passes of low levels: an
/// alternative word may carry a long gram to where two real words end a short one.
void NgramMatcher::complete(Position newer_end, Row& target) {
  const WordRange newer = text_.endingAt(newer_end);
  const Probe real = probe(text_.syllables(newer.begin));
  Grams& grams = target.grams;
  for (std::size_t i = 0; i < grams.ends.size(); ++i) {
    prefetch(begins_[grams.ends[std::min(i + kAhead, grams.ends.size() - 1)]]);
    std::uint16_t* lengths = &grams.lengths[i * passes_];
    int levels = 0;  // passes whose lengths may be too short; the higher ones have longer grams
    while (static_cast<std::size_t>(levels) < passes_ && lengths[levels] < gram_) ++levels;
    if (levels == 0) continue;
    const Begin& end = begins_[grams.ends[i]];
    if (newer.size() == 1 && (end.tags & Begin::kAlternativesEnd) == 0) continue;
    if (levels == 1 && !matches(real, end)) continue;
    const WordRange older = text_.endingAt(grams.ends[i]);
    for (WordIndex a = newer.begin; a < newer.end; ++a)
      for (WordIndex b = older.begin; b < older.end; ++b) {
        if (text_.last(b) >= text_.first(a)) continue;
        const Lengths l = lengthsFromScratch(a, b, gram_, levels);
        for (int k = 0; k < levels; ++k) {
          const auto at = static_cast<std::size_t>(k);
          lengths[at] = std::max(lengths[at], l[at]);
        }
      }
  }
}

void NgramMatcher::tell(WordIndex newer, WordIndex older, const std::uint16_t* lengths) {
  for (std::size_t k = 0; k < passes_; ++k) {
    if (lengths[k] < params_.min_n[k]) continue;
    matches_.push_back({newer, older, static_cast<int>(k) + 1, lengths[k]});
    return;
  }
}

NgramMatcher::Begin NgramMatcher::beginOf(WordIndex word, std::uint32_t flags) const {
  const Syllables s = text_.syllables(word);
  return {s.angle, static_cast<std::uint32_t>(s.density_class) << 24 | s.size << 4 | flags, word,
          0};
}

/// Both are in order; of grams that end at the same positions the longest in each pass counts.
/// Leaves something or other in `more`.
void NgramMatcher::mergeInto(Row& target, Grams& more) {
  if (more.ends.empty()) return;
  for (Position end : more.ends) target.has.set(end);
  if (target.grams.ends.empty() && &more != &found_.back()) {  // no position twice
    std::swap(target.grams, more);
    return;
  }
  const Grams& old = target.grams;
  merged_.clear();
  merged_.ends.reserve(old.ends.size() + more.ends.size());
  merged_.lengths.reserve(old.lengths.size() + more.lengths.size());
  const auto append = [&](const Grams& from, std::size_t i) {
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
  std::swap(target.grams, merged_);
}

std::size_t NgramMatcher::bytes() const {
  const auto of = [](const Grams& g) {
    return g.ends.capacity() * sizeof(Position) + g.lengths.capacity() * sizeof(std::uint16_t);
  };
  std::size_t sum =
      index_.bytes() + begins_.bytes() + alternatives_.bytes() + run_starts_.bytes() + of(merged_);
  for (const Grams& g : found_) sum += of(g);
  for (const Row& r : rows_) sum += of(r.grams) + r.has.bytes();
  return sum;
}

}  // namespace ngram_slam
