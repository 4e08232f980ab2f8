// Facts that the second reader found as sentences of the grammar's own, to be asked for.
#pragma once

#include <string>

#include "building/sentence_writer.hpp"
#include "hyselam_language/reader/fact_reader.hpp"

namespace hyselam_topo {

class FactWriter {
 public:
  explicit FactWriter(const Grammar& grammar);

  /// By the keys fact_RELATION_COUNT of the grammar's section `say`, COUNT that of the arguments
  /// that are names ("fact_next_2"), with "not_" or "ask_" before it if it is denied or asked; ""
  /// if there is no such key or an argument is no name that can be said.
  std::string sentence(const ReadFact& fact) const;

 private:
  /// Without text for what is no name.
  SaidValue valueOf(const std::string& key, const FactArgument& argument) const;

  Grammar grammar_;
  SentenceWriter writer_;
};

}  // namespace hyselam_topo
