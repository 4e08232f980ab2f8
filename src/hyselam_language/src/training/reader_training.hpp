// Training and evaluation of the second reader.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "annotated_text.hpp"
#include "hyselam_language/grammar/grammar.hpp"
#include "reader/reader_model.hpp"

namespace hyselam_topo {
namespace language {

struct ReaderTrainingParams {
  double cost = 3.0;           ///< liblinear's C: smaller gives fewer weights
  std::size_t least_seen = 1;  ///< features of fewer examples are left out
  std::size_t folds = 4;       ///< of writers, for calibration and evaluation
};

/// Without calibration.
ReaderModel trainReader(const Grammar& grammar, const ReaderLexicon& lexicon,
                        const std::vector<const AnnotatedText*>& texts,
                        const ReaderTrainingParams& params);

struct ReaderScore {
  std::size_t texts = 0;
  std::size_t exact = 0;  ///< texts whose facts are all right and complete
  std::size_t mentions = 0, mentions_found = 0, mentions_right = 0;
  std::size_t facts = 0, read = 0, right = 0;  ///< facts annotated, read, and both
};

/// How readings fare on writers that the model was not trained with.
struct ReaderEvaluation {
  /// Something read, before calibration.
  struct Guess {
    double own = 0.0, whole = 0.0;  ///< log odds: of itself, of all that was read in the text
    bool right = false;
  };
  std::vector<Guess> facts, others;  ///< see Reading; of texts that the grammar refuses
  std::map<std::string, ReaderScore> by_layer;
  struct Reading {
    Guess guess;       ///< right: all of it, and complete
    bool any = false;  ///< anything was read
    const AnnotatedText* text = nullptr;
    std::string read;  ///< in words, for people
  };
  std::vector<Reading> readings;  ///< of texts that the grammar refuses
};

ReaderEvaluation evaluateReader(const Grammar& grammar, const ReaderLexicon& lexicon,
                                const std::vector<const AnnotatedText*>& texts,
                                const ReaderTrainingParams& params);

/// Logistic regression by Newton's method.
Odds fittedOdds(const std::vector<ReaderEvaluation::Guess>& guesses);

/// Fits the odds so that of what is told as p = x a share x is right.
void calibrate(const ReaderEvaluation& evaluation, ReaderModel* model);

}  // namespace language
}  // namespace hyselam_topo
