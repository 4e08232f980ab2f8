#include "ngram_slam/words/language_model.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/rng.hpp"

namespace ngram_slam {
namespace {
constexpr double kTurn = 2.0 * hyselam::kPi;
/// How many counts lie in a range, in bins; ranges wrap if `around`.
template <std::size_t N>
double within(const std::array<std::uint32_t, N>& bins, double from, double to, bool around) {
  double sum = 0.0;
  for (auto i = static_cast<long>(std::floor(from)); static_cast<double>(i) < to; ++i) {
    const double low = std::max(from, static_cast<double>(i)),
                 high = std::min(to, static_cast<double>(i) + 1.0);
    const long n = static_cast<long>(N);
    if (!around && (i < 0 || i >= n)) continue;
    sum += (high - low) * bins[static_cast<std::size_t>(((i % n) + n) % n)];
  }
  return sum;
}

/// Words whose weight the distribution over all classes has in that of one.
constexpr double kBackOff = 4.0;
/// Pairs whose weight the model of classes has in the sample.
constexpr double kPairBackOff = 2.0;

std::size_t classAt(const Syllables& w) {
  return static_cast<std::size_t>(w.density_class);
}
}  // namespace

LanguageModel::LanguageModel()
    : shapes_(kClasses), followers_(kClasses, 0.0), kinds_(kClasses, 0.0) {}

void LanguageModel::add(const Syllables& word, const Syllables* before) {
  Shape& shape = shapes_[classAt(word)];
  if (shape.count == 0.0) ++seen_classes_;
  const auto size = std::min(
      kSizeBins - 1, static_cast<std::size_t>(std::log(std::max(word.size, 1u)) / kSizeBin));
  const double turns = static_cast<double>(word.angle) / kTurn + 0.5;
  const auto angle =
      std::min(kAngleBins - 1, static_cast<std::size_t>(std::max(0.0, turns * double{kAngleBins})));
  for (Shape* s : {&shape, &all_}) {
    ++s->size[size];
    ++s->angle[angle];
    ++s->count;
  }
  ++words_;
  if (before == nullptr) return;
  if (after_.empty()) after_.assign(kClasses * kClasses, 0);
  std::uint32_t& n = after_[classAt(*before) * kClasses + classAt(word)];
  if (n == 0) ++kinds_[classAt(*before)];
  ++n;
  ++followers_[classAt(*before)];
}

double LanguageModel::classProbability(int c, const Syllables* before) const {
  const auto at = static_cast<std::size_t>(c);
  const double n = static_cast<double>(words_);
  // One class more than was seen: what is new is not impossible.
  const double alone = (shapes_[at].count + 1.0) / (n + seen_classes_ + 1.0);
  if (before == nullptr || after_.empty()) return alone;
  const double total = followers_[classAt(*before)], kinds = kinds_[classAt(*before)] + 1.0;
  return (after_[classAt(*before) * kClasses + at] + kinds * alone) / (total + kinds);
}

double LanguageModel::sizeWithin(const Syllables& word, double tolerance) const {
  const double middle = std::log(static_cast<double>(std::max(word.size, 1u))) / kSizeBin;
  const double half = -std::log1p(-tolerance) / kSizeBin;
  const double from = middle - half, to = middle + half;
  const Shape& s = shapes_[classAt(word)];
  const double flat = (to - from) / 50.0;  // sizes of 1 .. 150, all alike, count as one word
  const double any = (within(all_.size, from, to, false) + flat) / (all_.count + 1.0);
  return std::min(1.0, (within(s.size, from, to, false) + kBackOff * any) / (s.count + kBackOff));
}

double LanguageModel::angleWithin(const Syllables& word, double half_width) const {
  const Shape& s = shapes_[classAt(word)];
  const double bins = double{kAngleBins};
  const double middle = (static_cast<double>(word.angle) / kTurn + 0.5) * bins;
  const double half = half_width / kTurn * bins;
  const double any = (within(all_.angle, middle - half, middle + half, true) + 2.0 * half / bins) /
                     (all_.count + 1.0);
  return (within(s.angle, middle - half, middle + half, true) + kBackOff * any) /
         (s.count + kBackOff);
}

void LanguageModel::addPair(const Syllables& before, const Syllables& word) {
  ++pairs_;
  if (sample_.size() < kSample) {
    sample_.push_back({before, word});
    return;
  }
  // Every pair is kept with the same probability (reservoir sampling).
  const std::uint64_t at = hyselam::mix(kSample, pairs_) % pairs_;
  if (at < kSample) sample_[at] = {before, word};
}

double LanguageModel::chanceOfMatch(const Syllables& word, const Syllables* before,
                                    const WordTolerance& tolerance) const {
  const double alone = classProbability(word.density_class, before) *
                       sizeWithin(word, tolerance.size) * angleWithin(word, tolerance.angle);
  if (before == nullptr) return alone;
  double came = 0.0, followed = 0.0;
  for (const Pair& p : sample_) {
    if (!wordsMatch(p.before, *before, tolerance)) continue;
    ++came;
    followed += wordsMatch(p.word, word, tolerance) ? 1.0 : 0.0;
  }
  // One of them is the match that asks.
  came = std::max(0.0, came - 1.0);
  followed = std::max(0.0, followed - 1.0);
  return (followed + kPairBackOff * alone) / (came + kPairBackOff);
}

std::size_t LanguageModel::bytes() const {
  return sizeof(*this) + shapes_.capacity() * sizeof(Shape) +
         (followers_.capacity() + kinds_.capacity()) * sizeof(double) +
         after_.capacity() * sizeof(std::uint32_t) + sample_.capacity() * sizeof(Pair);
}

}  // namespace ngram_slam
