#include "ngram_slam/matching/match_confidence.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/odds.hpp"
#include "ngram_slam/matching/ngram.hpp"

namespace ngram_slam {
namespace {

constexpr std::size_t kMaxCached = 1u << 16;  // pairs of words

/// The key of two words, which are below 2^31, and a direction.
std::uint64_t keyOf(WordIndex a, WordIndex b, Direction direction) {
  return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint64_t>(b) << 1 |
         (direction == Direction::kReverse ? 1u : 0u);
}

}  // namespace

void MatchConfidenceParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("bias", bias, Range::any(), "", "log odds of a match at chance 1 and misfit 1");
  visit("by_chance", by_chance, Range::any(), "", "log odds by -ln(chance)");
  visit("by_misfit", by_misfit, Range::any(), "", "log odds by ln(misfit + misfit_floor)");
  visit("misfit_floor", misfit_floor, Range::above(0.0), "", "added to the misfit of densities");
  visit("max_words", max_words, Range::atLeast(1), "words",
        "the newest ones of a match that are used");
}

void MatchConfidenceParams::validate() const {
  hyselam::checkParameters(*this);
  for (const double weight : {bias, by_chance, by_misfit}) {
    if (!std::isfinite(weight)) throw hyselam::ParameterError("weight", weight, "finite");
  }
}

MatchConfidence::MatchConfidence(const WordLattice& text, const ObservationStore& observations,
                                 const WordTolerance& tolerance, WordDensity density,
                                 const MatchConfidenceParams& params)
    : text_(text),
      observations_(observations),
      tolerance_(tolerance),
      params_((params.validate(), params)) {
  alignment_.density = density;
}

void MatchConfidence::learn(Position p) {
  const Syllables word = text_.syllables(text_.realWord(p));
  if (text_.startsRun(p)) {
    model_.add(word, nullptr);
    return;
  }
  const Syllables before = text_.syllables(text_.realWord(p - 1));
  model_.add(word, &before);
  // The words that end at the position before are complete now.
  const WordRange ending = text_.endingAt(p - 1);
  for (WordIndex w = ending.begin; w < ending.end; ++w) {
    const WordRange earlier = text_.predecessors(w);
    if (!earlier.empty()) model_.addPair(text_.syllables(earlier.begin), text_.syllables(w));
  }
}

void MatchConfidence::estimate(NgramMatch& match, bool with_probability) {
  const auto chain = longestNgram(text_, tolerance_, {match.newer, match.older}, match.levels,
                                  static_cast<std::size_t>(params_.max_words), match.direction);
  match.chance = chanceOf(chain, match.direction);
  if (!with_probability) return;
  const double odds =
      params_.bias - params_.by_chance * std::log(std::max(match.chance, 1e-300)) +
      params_.by_misfit * std::log(misfitOf(chain, match.direction) + params_.misfit_floor);
  match.probability = hyselam::probabilityOf(odds);
}

double MatchConfidence::chanceOf(const std::vector<WordPair>& chain, Direction direction) {
  if (chances_.size() > kMaxCached) chances_.clear();
  const bool reverse = direction == Direction::kReverse;
  const auto syllables = [&](WordIndex w) {
    return reverse ? reversed(text_.syllables(w)) : text_.syllables(w);
  };
  // In the order in which the older words stand in the text.
  double expected = static_cast<double>(std::max<std::uint64_t>(1, model_.words()));
  for (std::size_t k = 0; k < chain.size(); ++k) {
    const WordIndex word = chain[reverse ? chain.size() - 1 - k : k].newer;
    if (k == 0) {
      expected *= model_.chanceOfMatch(syllables(word), nullptr, tolerance_);
      continue;
    }
    const WordIndex before = chain[reverse ? chain.size() - k : k - 1].newer;
    const auto [at, fresh] = chances_.try_emplace(keyOf(before, word, direction));
    if (fresh) {
      const Syllables s = syllables(before);
      at->second = model_.chanceOfMatch(syllables(word), &s, tolerance_);
    }
    expected *= at->second;
  }
  return expected;
}

double MatchConfidence::misfitOf(const std::vector<WordPair>& chain, Direction direction) {
  if (misfits_.size() > kMaxCached) misfits_.clear();
  double squares = 0.0, terms = 0.0;
  for (const WordPair& words : chain) {
    const auto [at, fresh] = misfits_.try_emplace(keyOf(words.newer, words.older, direction));
    if (fresh) {
      const std::uint32_t s1 = text_.observationBegin(words.newer);
      const std::uint32_t begin2 = text_.observationBegin(words.older),
                          end2 = text_.observationEnd(words.older);
      const std::uint32_t n = std::min(text_.observationEnd(words.newer) - s1, end2 - begin2);
      if (const auto a = align(observations_, s1, direction == Direction::kSame ? begin2 : end2 - 1,
                               n, alignment_, direction)) {
        at->second = {static_cast<float>(a->rms * a->rms * a->terms), static_cast<float>(a->terms)};
      }
    }
    squares += static_cast<double>(at->second.squares);
    terms += static_cast<double>(at->second.terms);
  }
  return terms > 0.0 ? std::sqrt(squares / terms) : 1.0;
}

std::size_t MatchConfidence::bytes() const {
  return model_.bytes() + (chances_.size() + misfits_.size()) * 40;
}

}  // namespace ngram_slam
