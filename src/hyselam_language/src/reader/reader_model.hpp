// What the second reader has learnt: five classifiers and the calibration of its confidence.
#pragma once

#include <string>

#include "linear_classifier.hpp"
#include "model_text.hpp"
#include "odds.hpp"
#include "reader_lexicon.hpp"

namespace hyselam_topo {
namespace language {

struct ReaderModel {
  ModelOrigin origin;
  ReaderLexicon lexicon;
  LinearClassifier tagger;     ///< of words: which belong to mentions
  LinearClassifier of_one;     ///< of a mention: what is stated of it alone
  LinearClassifier of_two;     ///< of a pair of mentions
  LinearClassifier of_text;    ///< of a whole text: orders and answers without a name
  LinearClassifier modifiers;  ///< of a fact found: "plain", "denied" or "asked"
  Odds of_reading;             ///< that all facts are right and none is missing
  Odds of_fact;                ///< that a fact is right
  Odds of_other;               ///< that one is which was less likely than another, or than nothing

  /// The head: format with its version, and the lines of the origin; then the sections "[lexicon]"
  /// ... "[calibration]". Throws hyselam::InputError.
  static ReaderModel fromText(const std::string& source, const std::string& text);
  std::string toText() const;
};

}  // namespace language
}  // namespace hyselam_topo
