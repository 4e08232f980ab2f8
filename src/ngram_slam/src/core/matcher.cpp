#include "ngram_slam/matcher.hpp"

#include <algorithm>

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

void MatcherParams::validate() const {
  tolerance.validate();
  if (min_n.empty() || min_n.size() > static_cast<std::size_t>(Text::kMaxLevels))
    throw hyselam::ParameterError("number of entries of min_n", min_n.size(), "1..16");
  for (int n : min_n)
    if (n < 1 || n > 65535) throw hyselam::ParameterError("min_n", n, "1..65535 [words]");
  if (index_gram < 1 || index_gram > 4)
    throw hyselam::ParameterError("index_gram", index_gram, "1..4 [words]");
  if (index_bits < 4 || index_bits > 28)
    throw hyselam::ParameterError("index_bits", index_bits, "4..28");
}

Matcher::Matcher(const Text& text, const MatcherParams& params)
    : text_(text),
      params_(params),
      passes_(params.min_n.size()),
      gram_(gramOf(params)),
      index_(text, params.tolerance, gram_, params.index_bits),
      // An alternative word of the highest level L - 1 that ends at p starts after row p - L - 1.
      rows_(static_cast<std::size_t>(text.levels()) + 2) {
  if (passes_ != static_cast<std::size_t>(text.levels()))
    throw hyselam::ParameterError(
        "number of entries of min_n", passes_,
        "the number of levels of the text, " + std::to_string(text.levels()));
}

std::size_t Matcher::Row::find(Position end) const {
  if (end >= slot.size()) return kNone;
  const std::size_t i = slot[end];
  return i < ends.size() && ends[i] == end ? i : kNone;
}

const std::vector<Match>& Matcher::update() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) take(next_, true);
  return matches_;
}

void Matcher::skip() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) take(next_, false);
}

void Matcher::take(Position p, bool search) {
  ++counters_.positions;
  if (p > 0) {
    // The text has completed the words that end at the position before: so do we.
    const WordRange before = text_.endingAt(p - 1);
    Row& unfinished = row(p - 1);
    for (WordIndex w = before.begin + 1; search && w < before.end; ++w) {
      follow(w, unfinished, false);
      start(w, unfinished, false);
    }
    if (search) complete(p - 1, unfinished);
    for (WordIndex w = before.begin; w < before.end; ++w) index_.insert(w);
  }
  Row& fresh = row(p);
  fresh.ends.clear();
  fresh.lengths.clear();
  if (!search) return;
  const WordIndex newest = text_.realWord(p);
  follow(newest, fresh, true);
  start(newest, fresh, true);
}

/// Carries on the grams that ended just before `newer`.
void Matcher::follow(WordIndex newer, Row& target, bool report) {
  const Position first = text_.first(newer);
  if (text_.startsRun(first)) return;
  const Row& before = row(first - 1);
  for (std::size_t i = 0; i < before.ends.size(); ++i) {
    const Position begin = before.ends[i] + 1;
    if (begin >= first || text_.startsRun(begin)) continue;
    const std::uint16_t* lengths = &before.lengths[i * passes_];
    extend(newer, text_.realWord(begin), lengths, target, report);
    for (int level = 1; level < text_.levels(); ++level) {
      const Position end = begin + static_cast<Position>(level) + 1;
      if (end >= first) break;
      WordIndex older;
      if (text_.findEndingAt(end, level, &older)) extend(newer, older, lengths, target, report);
    }
  }
}

void Matcher::extend(WordIndex newer, WordIndex older, const std::uint16_t* before, Row& target,
                     bool report) {
  if (!match(newer, older)) return;
  ++counters_.live;
  Lengths lengths{};
  const auto from = static_cast<std::size_t>(std::max(text_.level(newer), text_.level(older)));
  for (std::size_t k = from; k < passes_; ++k) lengths[k] = oneMore(before[k]);
  enter(newer, older, lengths, target, report);
}

/// Finds the grams that have just become `gram_` words long.
void Matcher::start(WordIndex newer, Row& target, bool report) {
  const Position first = text_.first(newer);
  const Row* before = text_.startsRun(first) ? nullptr : &row(first - 1);
  candidates_.clear();
  index_.candidates(newer, [&](WordIndex older) {
    if (text_.last(older) >= first) return;
    const Position begin = text_.first(older);
    const bool followed =
        before != nullptr && !text_.startsRun(begin) && before->find(begin - 1) != kNone;
    if (!followed) candidates_.push_back(older);
  });
  std::sort(candidates_.begin(), candidates_.end());
  candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  for (WordIndex older : candidates_) {
    const Lengths lengths = lengthsFromScratch(newer, older, gram_);
    if (lengths[passes_ - 1] < gram_) continue;
    ++counters_.started;
    enter(newer, older, lengths, target, report);
  }
}

/// Lengths of the longest grams that end with this pair, up to `depth` words.
Matcher::Lengths Matcher::lengthsFromScratch(WordIndex newer, WordIndex older, int depth) {
  Lengths best{};
  if (!match(newer, older)) return best;
  if (depth > 1) {
    const WordRange before_newer = text_.predecessors(newer);
    const WordRange before_older = text_.predecessors(older);
    for (WordIndex a = before_newer.begin; a < before_newer.end; ++a)
      for (WordIndex b = before_older.begin; b < before_older.end; ++b) {
        if (text_.last(b) >= text_.first(a)) continue;
        const Lengths l = lengthsFromScratch(a, b, depth - 1);
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
void Matcher::complete(Position newer_end, Row& target) {
  const WordRange newer = text_.endingAt(newer_end);
  for (std::size_t i = 0; i < target.ends.size(); ++i) {
    std::uint16_t* lengths = &target.lengths[i * passes_];
    if (lengths[0] >= gram_) continue;
    const WordRange older = text_.endingAt(target.ends[i]);
    if (newer.size() == 1 && older.size() == 1) continue;
    for (WordIndex a = newer.begin; a < newer.end; ++a)
      for (WordIndex b = older.begin; b < older.end; ++b) {
        if (text_.last(b) >= text_.first(a)) continue;
        const Lengths l = lengthsFromScratch(a, b, gram_);
        for (std::size_t k = 0; k < passes_; ++k) lengths[k] = std::max(lengths[k], l[k]);
      }
  }
}

void Matcher::enter(WordIndex newer, WordIndex older, const Lengths& lengths, Row& target,
                    bool report) {
  const Position end = text_.last(older);
  std::size_t i = target.find(end);
  if (i == kNone) {
    i = target.ends.size();
    target.slot.grow(end + 1);
    target.slot[end] = static_cast<std::uint32_t>(i);
    target.ends.push_back(end);
    target.lengths.insert(target.lengths.end(), lengths.begin(),
                          lengths.begin() + static_cast<std::ptrdiff_t>(passes_));
  } else {
    for (std::size_t k = 0; k < passes_; ++k)
      target.lengths[i * passes_ + k] = std::max(target.lengths[i * passes_ + k], lengths[k]);
  }
  if (!report) return;
  for (std::size_t k = 0; k < passes_; ++k) {
    if (lengths[k] < params_.min_n[k]) continue;
    matches_.push_back({newer, older, static_cast<int>(k) + 1, lengths[k]});
    return;
  }
}

std::size_t Matcher::bytes() const {
  std::size_t sum = index_.bytes();
  for (const Row& r : rows_)
    sum += r.ends.capacity() * sizeof(Position) + r.lengths.capacity() * sizeof(std::uint16_t) +
           r.slot.bytes();
  return sum;
}

}  // namespace ngram_slam
