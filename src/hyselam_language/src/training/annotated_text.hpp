// Sentences with what they state, written by people for the training of the second reader.
//
// A file has one JSON object a line: {"text", "lang", "layer", "role", "facts": [[relation,
// argument, ...], ...]}. Arguments are written as they stand in the text, or are "HERE" or "IT";
// "not " before a relation denies it, "ask is" before one asks whether it is so.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_language/reader/fact_reader.hpp"
#include "reader/fact_candidates.hpp"
#include "reader/heard_text.hpp"

namespace hyselam_topo {
namespace language {

struct AnnotatedText {
  std::string text;
  std::string language;
  std::string layer;
  std::string writer;           ///< one person, in many roles: the file
  std::vector<ReadFact> facts;  ///< arguments without ranges
};

/// Throws hyselam::InputError that names the file and the line.
std::vector<AnnotatedText> loadAnnotated(const std::string& path);

/// A fact of an annotation with the mentions that are its arguments.
struct GoldFact {
  std::string label;                       ///< see fact_labels.hpp
  std::optional<FactCandidate> candidate;  ///< nothing: of the whole text
  std::string modifier;                    ///< "plain", "denied", "asked"
};

struct GoldText {
  std::vector<Mention> mentions;
  std::vector<GoldFact> facts;
  std::size_t lost = 0;  ///< facts whose arguments are no words of the text
};

/// Which words of the text the annotation speaks of.
GoldText alignedWith(const HeardText& text, const AnnotatedText& annotated);

}  // namespace language
}  // namespace hyselam_topo
