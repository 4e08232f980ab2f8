// The second reader: where the grammar gives up, it reads what somebody seems to have stated from
// the words around the names, as learnt from annotated sentences (models/reader_*.txt). It never
// decides: its facts become sentences of the grammar's own, which are asked ("Did you mean ...?").
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"

namespace hyselam_topo {

/// One argument of a fact: a name as it stands in the text, or a reference.
struct FactArgument {
  std::string text;     ///< "red mug"; of references "HERE" (this place) or "IT" (said before)
  std::string article;  ///< as it stood before the name, in small letters; "" without
  TextRange range;      ///< empty for references

  bool isReference() const { return range.begin == range.end; }
};

/// One thing stated, asked or ordered: "left" of a place, "next" of two.
struct ReadFact {
  std::string relation;  ///< "left", "nth_left", "next", "between", "ask_where", ...
  std::vector<FactArgument> arguments;
  bool denied = false;
  bool asked = false;  ///< "is it so?"
  /// That names and relation are right, calibrated on people that the model has not been trained
  /// with.
  double probability = 0.0;
};

struct Reading {
  std::vector<ReadFact> facts;      ///< in the order of what they are told of
  std::vector<ReadFact> others;     ///< what might be meant instead or besides, likeliest first
  std::vector<TextRange> mentions;  ///< words that may name things, persons or values
  /// That all facts are right and none is missing, calibrated on people that the model has not
  /// been trained with.
  double probability = 0.0;
};

/// Immutable and cheap to copy.
class FactReader {
 public:
  /// `grammar` splits texts into words. Throws hyselam::InputError, naming `source` and the line,
  /// for a text that is no model, or one of another language.
  FactReader(const Grammar& grammar, const std::string& source, const std::string& model);
  /// The shipped model of the grammar's language; throws hyselam::InputError if there is none.
  static FactReader shipped(const Grammar& grammar);
  static bool isShipped(const std::string& language);

  /// Texts of any content. Nothing is read in those longer than 120 words or 4000 bytes: whether
  /// they state or name anything is not known then.
  std::optional<Reading> read(const std::string& text) const;

 private:
  struct Model;
  std::shared_ptr<const Model> model_;
};

}  // namespace hyselam_topo
