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
  std::size_t folds = 6;       ///< of writers, for calibration and evaluation
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
  std::map<std::string, ReaderScore> by_layer;
  struct Reading {
    double log_odds = 0.0;
    bool exact = false;
    bool any = false;  ///< anything was read
    const AnnotatedText* text = nullptr;
    std::string read;  ///< in words, for people
  };
  std::vector<Reading> readings;
};

ReaderEvaluation evaluateReader(const Grammar& grammar, const ReaderLexicon& lexicon,
                                const std::vector<const AnnotatedText*>& texts,
                                const ReaderTrainingParams& params);

/// Fits slope and offset so that readings of p = x are right in a share x.
void calibrate(const std::vector<ReaderEvaluation::Reading>& readings, ReaderModel* model);

}  // namespace language
}  // namespace hyselam_topo
