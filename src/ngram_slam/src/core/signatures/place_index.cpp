#include "ngram_slam/signatures/place_index.hpp"

#include <algorithm>
#include <cmath>

namespace ngram_slam {

namespace {

// The levels of a value, in its steps: a quarter of all places in each if they were normally
// distributed (a standard deviation has 127 / 4 steps).
constexpr std::array<int, 3> kBounds{-21, 0, 21};
// Cells farther than this from a signature are not looked into: half the square of the distance
// in standard deviations between visits.
constexpr float kMaxCellCost = 12.0F;
constexpr float kWeightRange = 16000.0F;

std::size_t levelOf(int value) {
  std::size_t level = 0;
  for (const int bound : kBounds) level += value >= bound ? 1 : 0;
  return level;
}

/// Steps from a value to a level of it, 0 within.
int gapTo(int value, std::size_t level) {
  if (level > 0 && value < kBounds[level - 1]) return kBounds[level - 1] - value;
  if (level < kBounds.size() && value >= kBounds[level]) return value - kBounds[level] + 1;
  return 0;
}

void keepBest(std::vector<PlaceIndex::Found>* found, std::size_t count) {
  if (found->size() > count) {
    std::nth_element(found->begin(), found->begin() + static_cast<std::ptrdiff_t>(count),
                     found->end());
    found->resize(count);
  }
}

}  // namespace

PlaceIndex::PlaceIndex(const SignatureModel& model) : model_(&model), cells_(kCells) {}

std::uint32_t PlaceIndex::add(const PlaceSignature& signature) {
  const std::uint32_t place = size();
  places_.push_back(signature);
  own_.push_back(model_->own(signature));
  cells_[cellOf(signature)].push_back(place);
  return place;
}

std::size_t PlaceIndex::cellOf(const PlaceSignature& signature) {
  std::size_t cell = 0;
  for (std::size_t i = 0; i < kGridValues; ++i) {
    cell = cell * kLevels + levelOf(signature.values[i]);
  }
  return cell;
}

PlaceIndex::Question PlaceIndex::questionOf(const PlaceSignature& wanted) const {
  // The products of the sum below must fit 32 bits.
  std::array<float, PlaceSignature::kSize> weights{};
  float largest = 1e-9F;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = model_->cross()[i] * static_cast<float>(wanted.values[i]);
    largest = std::max(largest, std::abs(weights[i]));
  }
  Question q{};
  q.scale = largest / kWeightRange;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    q.weights[i] = static_cast<std::int16_t>(std::lround(weights[i] / q.scale));
  }
  q.constant = model_->constant() + model_->own(wanted);
  return q;
}

float PlaceIndex::score(const Question& q, std::uint32_t place) const {
  const PlaceSignature& s = places_[place];
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < PlaceSignature::kSize; ++i) {
    sum += q.weights[i] * static_cast<std::int16_t>(s.values[i]);
  }
  return q.constant + own_[place] + q.scale * static_cast<float>(sum);
}

std::vector<PlaceIndex::Found> PlaceIndex::searchAll(const PlaceSignature& wanted,
                                                     std::size_t count, std::uint32_t end) const {
  const Question q = questionOf(wanted);
  std::vector<Found> found;
  end = std::min(end, size());
  for (std::uint32_t place = 0; place < end; ++place) {
    found.push_back({place, score(q, place)});
    if (found.size() >= 4 * count + 1024) keepBest(&found, count);
  }
  keepBest(&found, count);
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::uint16_t> PlaceIndex::nearestCells(const PlaceSignature& wanted) const {
  // Of the two halves of the values, then of their pairs.
  constexpr std::size_t kHalf = 64;
  std::array<std::array<float, kHalf>, 2> costs{};
  for (std::size_t half = 0; half < 2; ++half) {
    for (std::size_t code = 0; code < kHalf; ++code) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t value = 3 * half + i, level = code >> (2 * (2 - i)) & 3;
        const float gap =
            static_cast<float>(gapTo(wanted.values[value], level)) * model_->steps()[value];
        costs[half][code] += 0.25F * gap * gap;
      }
    }
  }
  std::vector<std::pair<float, std::uint16_t>> near;
  for (std::size_t a = 0; a < kHalf; ++a) {
    if (costs[0][a] > kMaxCellCost) continue;
    for (std::size_t b = 0; b < kHalf; ++b) {
      const float cost = costs[0][a] + costs[1][b];
      if (cost <= kMaxCellCost) near.emplace_back(cost, static_cast<std::uint16_t>(a * kHalf + b));
    }
  }
  std::sort(near.begin(), near.end());
  std::vector<std::uint16_t> cells;
  for (const auto& [cost, cell] : near) cells.push_back(cell);
  return cells;
}

std::vector<PlaceIndex::Found> PlaceIndex::search(const PlaceSignature& wanted, std::size_t count,
                                                  std::uint32_t end) const {
  if (std::min(end, size()) <= kFew) return searchAll(wanted, count, end);
  const Question q = questionOf(wanted);
  std::vector<Found> found;
  std::size_t seen = 0;
  for (const std::uint16_t cell : nearestCells(wanted)) {
    const std::vector<std::uint32_t>& places = cells_[cell];
    for (std::size_t i = 0; i < places.size() && places[i] < end && seen < kMaxSeen; ++i, ++seen) {
      if (i + 8 < places.size()) __builtin_prefetch(places_.data() + places[i + 8]);
      found.push_back({places[i], score(q, places[i])});
    }
    if (seen >= kMaxSeen) break;
    keepBest(&found, count);
  }
  keepBest(&found, count);
  std::sort(found.begin(), found.end());
  return found;
}

std::size_t PlaceIndex::bytes() const {
  std::size_t bytes = places_.capacity() * sizeof(PlaceSignature) + own_.capacity() * sizeof(float);
  for (const auto& cell : cells_) bytes += sizeof(cell) + cell.capacity() * sizeof(std::uint32_t);
  return bytes;
}

}  // namespace ngram_slam
