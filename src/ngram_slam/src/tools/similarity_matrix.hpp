// A similarity matrix (Fig. 4.11) of what is true and what was recognized, for
// scripts/plot_similarity.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "ngram_slam/matching/recognition_score.hpp"

namespace ngram_slam {

/// Marks cells of a matrix whose rows and columns stand for `step` observations each, so that a
/// run of years is drawn from a file of bounded size. Of what falls into one cell the kind that was
/// marked last counts.
class SimilarityMatrix {
 public:
  static constexpr std::uint32_t kMaxCells = 1000;  // rows, and columns
  enum Kind : std::uint8_t { kNone, kTrueReverse, kTrueSame, kSame, kReverse, kWrong };
  static constexpr std::array<const char*, 6> kNames{
      "", "true_reverse", "true_same", "recognized_same", "recognized_reverse", "wrong"};

  explicit SimilarityMatrix(std::uint32_t observations)
      : observations_(observations),
        step_((observations + kMaxCells - 1) / kMaxCells),
        cells_(observations == 0 ? 0 : (observations + step_ - 1) / step_),
        kinds_(static_cast<std::size_t>(cells_) * cells_, kNone) {}

  void mark(std::uint32_t newer, std::uint32_t older, Kind kind) {
    kinds_[static_cast<std::size_t>(newer / step_) * cells_ + older / step_] = kind;
  }
  /// {"observations", "step", "cells": {kind: [[row, column], …]}}
  nlohmann::json toJson() const {
    nlohmann::json j = {{"observations", observations_}, {"step", std::max(1u, step_)}};
    for (std::size_t kind = kTrueReverse; kind <= kWrong; ++kind) {
      j["cells"][kNames[kind]] = nlohmann::json::array();
    }
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
      if (kinds_[i] != kNone) j["cells"][kNames[kinds_[i]]].push_back({i / cells_, i % cells_});
    }
    return j;
  }

 private:
  std::uint32_t observations_, step_, cells_;
  std::vector<Kind> kinds_;
};

/// Rows: every observation; columns: those before it.
/// @throws hyselam::InputError if the file cannot be written.
inline void writeSimilarityMatrix(const std::string& path, const RecognitionScore& score) {
  const RecognitionTruth& truth = score.truth();
  SimilarityMatrix matrix(truth.size());
  for (const Direction direction : {Direction::kReverse, Direction::kSame}) {
    for (std::uint32_t i = 0; i < truth.size(); ++i) {
      for (std::size_t k = truth.passesBegin(i); k < truth.passesEnd(i); ++k) {
        const RecognitionTruth::Pass& pass = truth.passes()[k];
        if (pass.direction != direction) continue;
        for (std::uint32_t older = pass.first; older <= pass.last; ++older) {
          matrix.mark(i, older,
                      direction == Direction::kSame ? SimilarityMatrix::kTrueSame
                                                    : SimilarityMatrix::kTrueReverse);
        }
      }
    }
  }
  // Wrong ones last, so that none is hidden.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> wrong, reverse;
  score.forEachPair([&](std::uint32_t newer, std::uint32_t older, Direction direction) {
    if (!*truth.isTrue(newer, older, direction)) {
      wrong.emplace_back(newer, older);
    } else if (direction == Direction::kReverse) {
      reverse.emplace_back(newer, older);
    } else {
      matrix.mark(newer, older, SimilarityMatrix::kSame);
    }
  });
  for (const auto& [newer, older] : reverse) matrix.mark(newer, older, SimilarityMatrix::kReverse);
  for (const auto& [newer, older] : wrong) matrix.mark(newer, older, SimilarityMatrix::kWrong);
  hyselam::writeFileAtomically(path,
                               [&](std::ostream& out) { out << matrix.toJson().dump() << '\n'; });
}

}  // namespace ngram_slam
