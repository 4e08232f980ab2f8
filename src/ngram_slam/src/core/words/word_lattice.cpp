#include "ngram_slam/words/word_lattice.hpp"

#include <algorithm>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

WordLattice::WordLattice(int levels, AngleOf angle_of)
    : levels_(levels), angle_of_(std::move(angle_of)) {
  if (levels < 1 || levels > kMaxLevels) {
    throw hyselam::ParameterError("levels", levels, "1.." + std::to_string(kMaxLevels));
  }
}

void WordLattice::startRun() {
  starts_run_ = true;
}

void WordLattice::startRun(std::uint32_t first_observation) {
  starts_run_ = true;
  next_observation_ = first_observation;
}

Position WordLattice::push(const Syllables& word) {
  if (word.density_class < 0 || word.density_class >= kMaxClasses) {
    throw hyselam::ParameterError("density class", word.density_class,
                                  "0.." + std::to_string(kMaxClasses - 1));
  }
  if (word.size < 1) throw hyselam::ParameterError("word size", word.size, ">= 1 [observations]");
  if (blocks_.size() >= kMaxPositions ||
      words_.size() + static_cast<std::size_t>(levels_) >= (std::size_t{1} << 31)) {
    throw hyselam::InputError("text", "", "is full");
  }

  if (!starts_run_) writeAlternatives();
  const Position here = positions();
  Block block;
  block.begin = static_cast<std::uint32_t>(words_.size()) & 0x7fffffffu;
  block.starts_run = starts_run_;
  if (starts_run_) runs_.push_back(here);
  starts_run_ = false;
  blocks_.push_back(block);
  observations_.push_back(next_observation_);
  next_observation_ += std::min(word.size, kMaxSize);
  append(word, 0, here);
  return here;
}

void WordLattice::append(const Syllables& s, int level, Position last) {
  words_.push_back({s.angle,
                    static_cast<std::uint32_t>(s.density_class) << 24 |
                        static_cast<std::uint32_t>(level) << 20 | std::min(s.size, kMaxSize),
                    last});
}

void WordLattice::writeAlternatives() {
  const Position last = positions() - 1;
  const WordIndex real = realWord(last);
  for (int level = 1; level < levels_; ++level) {
    const auto span = static_cast<Position>(level) + 1;
    if (last < runs_.back() + span) return;  // the run is too short, and so for higher levels
    const Position first = last - span;
    Syllables s = syllables(realWord(first));
    if (s.density_class != syllables(real).density_class) continue;
    const std::uint32_t begin = observations_[first], end = observationEnd(real);
    s.size = end - begin;
    double angle = 0.0;
    if (angle_of_) {
      angle = angle_of_(begin, end);
    } else {
      for (Position p = first; p <= last; ++p) angle += syllables(realWord(p)).angle;
    }
    s.angle = static_cast<float>(hyselam::normalizeAngle(angle));
    append(s, level, last);
  }
}

DensityWord WordLattice::word(WordIndex i) const {
  return {syllables(i), level(i), first(i), last(i)};
}

bool WordLattice::findEndingAt(Position p, int level, WordIndex* found) const {
  const WordRange range = endingAt(p);
  for (WordIndex i = range.begin; i < range.end; ++i) {
    const int l = this->level(i);
    if (l < level) continue;
    *found = i;
    return l == level;
  }
  return false;
}

}  // namespace ngram_slam
