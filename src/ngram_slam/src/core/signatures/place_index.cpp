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
// Found places that wait to be sorted out.
constexpr std::size_t kSlack = 1024;

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
  const std::size_t number = cellOf(signature);
  GridCell& cell = cells_[number];
  at_.push_back(
      {static_cast<std::uint32_t>(cell.places.size()), static_cast<std::uint16_t>(number)});
  const auto place = static_cast<std::uint32_t>(at_.size() - 1);
  cell.places.push_back(place);
  cell.signatures.push_back(signature);
  cell.own.push_back(model_->own(signature));
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
  return score(q, cells_[at_[place].cell], at_[place].position);
}

float PlaceIndex::score(const Question& q, const GridCell& cell, std::size_t position) const {
  const PlaceSignature& s = cell.signatures[position];
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < PlaceSignature::kSize; ++i) {
    sum += q.weights[i] * static_cast<std::int16_t>(s.values[i]);
  }
  return q.constant + cell.own[position] + q.scale * static_cast<float>(sum);
}

std::vector<PlaceIndex::Found> PlaceIndex::searchAll(const PlaceSignature& wanted,
                                                     std::size_t count, std::uint32_t end) const {
  const Question q = questionOf(wanted);
  std::vector<Found> found;
  for (const GridCell& cell : cells_) {
    for (std::size_t i = 0; i < cell.places.size() && cell.places[i] < end; ++i) {
      found.push_back({cell.places[i], score(q, cell, i)});
      if (found.size() >= 4 * count + kSlack) keepBest(&found, count);
    }
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
  for (const std::uint16_t number : nearestCells(wanted)) {
    const GridCell& cell = cells_[number];
    const auto below = static_cast<std::size_t>(
        std::lower_bound(cell.places.begin(), cell.places.end(), end) - cell.places.begin());
    // Of a cell that holds more than may be seen, places of all ages: evenly from all of them.
    const std::size_t looks = std::min(below, kMaxSeen - seen);
    for (std::size_t k = 0; k < looks; ++k) {
      const std::size_t i = k * below / looks;
      found.push_back({cell.places[i], score(q, cell, i)});
    }
    seen += looks;
    if (seen >= kMaxSeen) break;
    if (found.size() >= 4 * count + kSlack) keepBest(&found, count);
  }
  keepBest(&found, count);
  std::sort(found.begin(), found.end());
  return found;
}

std::size_t PlaceIndex::bytes() const {
  std::size_t bytes = at_.capacity() * sizeof(At);
  for (const GridCell& cell : cells_) {
    bytes += sizeof(cell) + cell.places.capacity() * sizeof(std::uint32_t) +
             cell.signatures.capacity() * sizeof(PlaceSignature) +
             cell.own.capacity() * sizeof(float);
  }
  return bytes;
}

}  // namespace ngram_slam
