// What the second reader has learnt: five classifiers and the calibration of its confidence.
#pragma once

#include <string>

#include "linear_classifier.hpp"
#include "reader_lexicon.hpp"

namespace hyselam_topo {
namespace language {

struct ReaderModel {
  ReaderLexicon lexicon;
  LinearClassifier tagger;     ///< of words: which belong to mentions
  LinearClassifier of_one;     ///< of a mention: what is stated of it alone
  LinearClassifier of_two;     ///< of a pair of mentions
  LinearClassifier of_text;    ///< of a whole text: orders and answers without a name
  LinearClassifier modifiers;  ///< of a fact found: "plain", "denied" or "asked"
  /// The probability that a reading is right is 1 / (1 + exp(-(slope x + offset))), x the
  /// logarithm of the odds that all decisions are right, were they independent.
  double slope = 1.0;
  double offset = 0.0;

  /// Sections "[lexicon]" ... "[calibration]". Throws hyselam::InputError.
  static ReaderModel fromText(const std::string& source, const std::string& text);
  std::string toText() const;
};

/// What a classifier says of a candidate that states nothing.
inline const std::string kNoFact = "none";

}  // namespace language
}  // namespace hyselam_topo
