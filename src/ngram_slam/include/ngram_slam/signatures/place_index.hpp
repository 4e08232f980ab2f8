// Finds the places whose signatures are likeliest to be of the same place as a given one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ngram_slam/signatures/place_signature.hpp"

namespace ngram_slam {

/// Beside the signatures stands a grid over the values that tell places apart best: a search looks
/// into its cells from the nearest on, until it has seen enough places. Cost: with the places of
/// the cells that are looked into, bounded by kMaxSeen.
class PlaceIndex {
 public:
  struct Found {
    std::uint32_t place = 0;
    float score = 0.0F;  ///< SignatureModel::logRatio()
    bool operator<(const Found& o) const {
      return score != o.score ? score > o.score : place < o.place;
    }
  };
  /// Fewer places than this are all compared.
  static constexpr std::uint32_t kFew = 16384;
  /// Places that a search compares at most: of the last cell that it looks into, evenly old ones.
  static constexpr std::size_t kMaxSeen = 16384;

  /// `model` must outlive the index.
  explicit PlaceIndex(const SignatureModel& model);

  /// Returns its number, counted from 0.
  std::uint32_t add(const PlaceSignature& signature);
  std::uint32_t size() const { return static_cast<std::uint32_t>(at_.size()); }
  const PlaceSignature& operator[](std::uint32_t i) const {
    return cells_[at_[i].cell].signatures[at_[i].position];
  }

  /// The `count` best of the places below `end`, best first.
  std::vector<Found> search(const PlaceSignature& wanted, std::size_t count,
                            std::uint32_t end) const;
  /// The same, compared with all of them.
  std::vector<Found> searchAll(const PlaceSignature& wanted, std::size_t count,
                               std::uint32_t end) const;
  /// A signature made ready to be compared with many.
  struct Question {
    std::array<std::int16_t, PlaceSignature::kSize> weights;
    float constant, scale;
  };
  Question questionOf(const PlaceSignature& wanted) const;
  /// As SignatureModel::logRatio(), but for rounding.
  float score(const Question& question, std::uint32_t place) const;
  std::size_t bytes() const;

 private:
  static constexpr std::size_t kGridValues = 6, kLevels = 4, kCells = 4096;
  /// The places of a cell, rising; side by side, as they are compared one after the other.
  struct GridCell {
    std::vector<std::uint32_t> places;
    std::vector<PlaceSignature> signatures;
    std::vector<float> own;  // SignatureModel::own()
  };
  struct At {
    std::uint32_t position;
    std::uint16_t cell;
  };
  float score(const Question& question, const GridCell& cell, std::size_t position) const;
  static std::size_t cellOf(const PlaceSignature& signature);
  std::vector<std::uint16_t> nearestCells(const PlaceSignature& wanted) const;

  const SignatureModel* model_;
  std::vector<At> at_;  // of each place
  std::vector<GridCell> cells_;
};

}  // namespace ngram_slam
