// Bigram model with back-off of the words of a text: estimates how often words match by chance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ngram_slam/words/density_word.hpp"

namespace ngram_slam {

/// Counts words and pairs of words that follow each other.
///
/// How often a word follows another one is estimated from a uniform sample of the text, with the
/// tolerances of the matcher: among the words whose predecessor matches, the share that matches
/// too. Where few predecessors match, it backs off to the distribution of sizes and angles of the
/// class and to the bigrams of classes (Witten and Bell 1991), and these again to all classes. A
/// query costs the same whatever the length of the text.
class LanguageModel {
 public:
  LanguageModel();

  /// Counts a real word; `before`: the real one before it in its run, if any.
  void add(const Syllables& word, const Syllables* before);
  /// Counts a word, real or alternative, that follows another one.
  void addPair(const Syllables& before, const Syllables& word);

  /// Real words counted.
  std::uint64_t words() const { return words_; }
  /// Probability that a word that follows a match of `before` (any word, if null) matches `word`,
  /// where one such pair is known and not counted.
  double chanceOfMatch(const Syllables& word, const Syllables* before,
                       const WordTolerance& tolerance) const;
  std::size_t bytes() const;

  static constexpr std::size_t kSample = 4096;  ///< pairs kept

 private:
  static constexpr std::size_t kClasses = 256;
  static constexpr double kSizeBin = 0.1;  // of the logarithm
  static constexpr std::size_t kSizeBins = 144, kAngleBins = 36;
  struct Shape {
    std::array<std::uint32_t, kSizeBins> size{};
    std::array<std::uint32_t, kAngleBins> angle{};
    double count = 0.0;
  };
  struct Pair {
    Syllables before, word;
  };
  double classProbability(int c, const Syllables* before) const;
  double sizeWithin(const Syllables& word, double tolerance) const;
  double angleWithin(const Syllables& word, double half_width) const;

  std::vector<Shape> shapes_;  // by class
  Shape all_;
  std::vector<double> followers_;     // by class: words after it
  std::vector<double> kinds_;         // and classes among them
  std::vector<std::uint32_t> after_;  // class before x class
  std::uint64_t words_ = 0;
  double seen_classes_ = 0.0;
  std::vector<Pair> sample_;
  std::uint64_t pairs_ = 0;
};

}  // namespace ngram_slam
