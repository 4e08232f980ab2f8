// TopoParser (dos Santos, section 5.1): parses sentences into statements, commands and questions.
// The thesis gives the work to the program Nooj; here a grammar of its own is read from a file and
// matched by a small engine.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"
#include "hyselam_language/reader/fact_reader.hpp"

namespace hyselam_topo {

struct ParseOptions {
  /// A language of the parser, or "auto": the one that parses most of the text; on a tie the one
  /// whose vocabulary has more of its words, then the first.
  std::string language = "auto";
  /// Of "auto": the language of what fits several equally well; "" for the first of the parser.
  std::string preferred;
  /// Intents of answers to a question that was asked: preferred where a sentence may mean several
  /// things, and needed for some, as "name_answer" for a bare "Kitchen.".
  std::set<std::string> expected;
  std::size_t max_bytes = 1u << 16;  ///< longer texts are not understood
};

struct ParsedText {
  std::string language;               ///< of the grammar that was used
  std::vector<Utterance> utterances;  ///< in the order said
  /// The number of those not understood.
  std::size_t misunderstood() const;
};

class TopoParser {
 public:
  /// All shipped languages, English first.
  TopoParser();
  /// Throws hyselam::ParameterError without a grammar.
  /// Languages for which a second reader is shipped have it: it suggests what may be meant where
  /// the grammar gives up.
  explicit TopoParser(std::vector<Grammar> grammars);

  /// Never throws for the content of a text: if it is not UTF-8, too long or not understood, the
  /// result is an utterance with the reason. Clear parts of a sentence are utterances of their own
  /// beside those that were not understood, never across doubt, choice or condition.
  /// Throws hyselam::ParameterError for an unknown language.
  ParsedText parse(const std::string& text, const ParseOptions& options = {}) const;

  const std::vector<Grammar>& grammars() const { return grammars_; }
  /// Throws hyselam::ParameterError for an unknown language.
  const Grammar& grammar(const std::string& language) const;

 private:
  void readAgain(const std::string& text, ParsedText* parsed) const;

  std::vector<Grammar> grammars_;
  std::vector<std::optional<FactReader>> readers_;  // of each grammar
};

}  // namespace hyselam_topo
