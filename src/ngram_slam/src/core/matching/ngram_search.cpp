#include "ngram_slam/matching/ngram_search.hpp"

#include <algorithm>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::ParameterError;
using hyselam::Range;

void NgramMatcherParams::describe(hyselam::ParameterVisitor& visit) {
  visit("min_n", min_n, Range::between(1, 65535), 1, "words",
        "smallest number of words of a match, one number per level");
  visit.group("", tolerance);
  visit("index_gram", index_gram, Range::between(1, 4), "words", "of the grams of the index");
  visit("index_bits", index_bits, Range::between(4, 28), "", "2^index_bits lists of the index");
  visit("max_followed", max_followed, Range::between(1, 1e9), "",
        "old places followed at a time; of more, the newest");
}

void NgramMatcherParams::validate() const {
  hyselam::checkParameters(*this);
  if (min_n.size() > static_cast<std::size_t>(WordLattice::kMaxLevels)) {
    throw ParameterError("number of entries of min_n", min_n.size(), "1..16");
  }
}

NgramSearch::NgramSearch(const WordLattice& text, const NgramMatcherParams& params,
                         Direction direction)
    : text_(text),
      params_((params.validate(), params)),
      direction_(direction),
      passes_(params.min_n.size()),
      index_gram_(
          std::min(params.index_gram, *std::min_element(params.min_n.begin(), params.min_n.end()))),
      index_(text, params.tolerance, index_gram_, params.index_bits,
             direction == Direction::kReverse) {
  if (passes_ != static_cast<std::size_t>(text.levels())) {
    throw ParameterError("number of entries of min_n", passes_,
                         "the number of levels of the text, " + std::to_string(text.levels()));
  }
}

const std::vector<NgramMatch>& NgramSearch::update() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) addPosition(next_, true);
  return matches_;
}

void NgramSearch::skip() {
  matches_.clear();
  for (; next_ < text_.positions(); ++next_) addPosition(next_, false);
}

bool NgramSearch::wordsOfPairMatch(WordIndex newer, WordIndex older) {
  ++counters_.comparisons;
  const Syllables old = text_.syllables(older);
  return wordsMatch(text_.syllables(newer), direction_ == Direction::kReverse ? reversed(old) : old,
                    params_.tolerance);
}

NgramSearch::Lengths NgramSearch::lengthsFromScratch(WordIndex newer, WordIndex older, int depth,
                                                     int levels) {
  Lengths best{};
  if (text_.level(newer) >= levels || text_.level(older) >= levels) return best;
  if (text_.last(older) >= text_.first(newer)) return best;
  if (!wordsOfPairMatch(newer, older)) return best;
  if (depth > 1) {
    const WordRange before_newer = text_.predecessors(newer);
    for (WordIndex a = before_newer.begin; a < before_newer.end; ++a) {
      const auto extend = [&](WordIndex b) {
        const Lengths l = lengthsFromScratch(a, b, depth - 1, levels);
        for (std::size_t k = 0; k < passes_; ++k) best[k] = std::max(best[k], l[k]);
      };
      if (direction_ == Direction::kReverse) {
        text_.forEachSuccessor(older, levels, extend);
      } else {
        const WordRange before_older = text_.predecessors(older);
        for (WordIndex b = before_older.begin; b < before_older.end; ++b) extend(b);
      }
    }
  }
  const auto from = static_cast<std::size_t>(std::max(text_.level(newer), text_.level(older)));
  for (std::size_t k = 0; k < passes_; ++k) {
    best[k] = k < from ? std::uint16_t{0} : oneMore(best[k]);
  }
  return best;
}

void NgramSearch::reportMatch(WordIndex newer, WordIndex older, const std::uint16_t* lengths) {
  for (std::size_t k = 0; k < passes_; ++k) {
    if (lengths[k] < params_.min_n[k]) continue;
    matches_.push_back({newer, older, static_cast<int>(k) + 1, lengths[k], direction_});
    return;
  }
}

}  // namespace ngram_slam
