// What the second reader has learnt: five classifiers and the calibration of its confidence.
#pragma once

#include <string>

#include "linear_classifier.hpp"
#include "reader_lexicon.hpp"

namespace hyselam_topo {
namespace language {

/// log(p / (1 - p)), kept finite.
double logOdds(double probability);

/// How probable it is that something read is right, by a logistic regression over what the
/// classifiers say of it and of the whole text, were all their decisions independent.
struct Odds {
  double own = 1.0;
  double whole = 0.0;
  double offset = 0.0;

  double of(double own_log_odds, double whole_log_odds) const;
  double probability(double own_p, double whole_p) const;
};

/// What a model says of itself, each a line of its head.
struct ReaderOrigin {
  std::string language;
  std::string command;   ///< that made it
  std::string data;      ///< that it was learnt from
  std::string left_out;  ///< how it fares on writers whom it was not learnt from
};

struct ReaderModel {
  ReaderOrigin origin;
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
