// Observations of one place by what they were matched with: a second look at the matches of a
// finished text. Not in the thesis.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "ngram_slam/matching/ngram_recognizer.hpp"

namespace ngram_slam {

/// Chosen on the buildings A, B and C of chapter 4 (Maffei 2017), kernel of 2.5 m.
struct SharedMatchesParams {
  int cell = 10;                 ///< observations in a row that are one unit, >= 1
  double min_probability = 0.2;  ///< of matches that are used, [0, 1]
  double density_scale = 0.06;   ///< a match goes on beyond its words while densities differ by
                                 ///< less, > 0
  double angle_scale = 0.5;      ///< and turns over two cells by less [rad], > 0
  double max_drop = 3.0;         ///< cells that do not fit after which it ends, >= 0
  double prior = 5.0;            ///< weight of matches that nobody shares, > 0
  double min_similarity = 0.1;   ///< of pairs that are told, above 0
  std::size_t separation = 100;  ///< observations between the two of a pair at least

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// `count` observations from `newer` on are where those from `older` on are, in reverse those from
/// `older` on backwards.
struct SimilarObservations {
  std::uint32_t newer = 0, older = 0, count = 0;
  Direction direction = Direction::kSame;
  double similarity = 0.0;  ///< 0 .. about 1
};

/// A match is weak evidence where a building repeats itself, but wrong ones do not agree: two
/// passes of one place are matched with the same other passes, two places are not.
///
/// Matches lay cells of observations over each other (links). From the surest match on, each is
/// carried on along both ways beyond its words, as long as densities and turns agree (seed and
/// extend, as in searches for sequences of genes). Then each cell is compared with all older ones
/// of its neighbours' neighbours: the similarity of two cells is the weight of the links that they
/// share, by the root of the product of the weights of all their links to cells before the newer
/// one (cosine similarity of rows of the graph of matches). A link weighs -ln(1 - probability), a
/// shared one by the product of both probabilities; a direct link counts as a shared one.
class SharedMatches {
 public:
  /// `recognizer` must outlive it, and its text must not change meanwhile.
  /// @throws hyselam::ParameterError
  explicit SharedMatches(const NgramRecognizer& recognizer, const SharedMatchesParams& params = {});

  /// Matches with a probability, of any order: all of them at once.
  std::vector<SimilarObservations> of(std::vector<NgramMatch> matches) const;

 private:
  using Cell = std::uint32_t;
  struct Link {
    Cell newer, older;
    Direction direction;
    float probability;
  };
  struct Neighbour {
    Cell cell;
    float probability, weight;
    double sum = 0.0;  // of the weights up to this one
  };
  using Links = std::array<std::unordered_map<std::uint64_t, float>, 2>;  // by direction
  using Rows = std::array<std::vector<std::vector<Neighbour>>, 2>;        // by direction, cell

  Cell cells() const { return static_cast<Cell>(begin_.size()); }
  /// Whether a walk along one run may step from one cell to the other.
  bool joined(std::int64_t from, std::int64_t to) const;
  bool apart(std::int64_t a, std::int64_t b) const;
  double fit(Cell newer, Cell older, Direction direction) const;
  Links linksOf(std::vector<NgramMatch> matches) const;
  Links extended(const Links& links) const;
  void extend(const Link& seed, int way, Links* links) const;
  Rows rowsOf(const Links& links) const;
  void compare(Cell newer, Direction direction, const Rows& rows, std::vector<double>* shared,
               std::vector<SimilarObservations>* pairs) const;

  const NgramRecognizer& recognizer_;
  SharedMatchesParams params_;
  std::vector<std::uint32_t> begin_, run_;  // of a cell: first observation, run
  std::vector<std::uint32_t> cell_of_;      // by observation
  std::vector<float> density_, turn_;       // of a cell: mean, change of heading from the cell
                                            // before to the one behind
};

}  // namespace ngram_slam
