// Sentence patterns: "[there] (is|are) {places:place+} <side>" into automata.
//
//   word               that word
//   ( a | b )  [ a ]   one of them; perhaps
//   <name>             a macro or a word class
//   {slot:type}        a name, "count", "number", a quantity, or a word class, captured
//   {slot:type+}       a list of names
//   {slot=value}       the slot gets a value, nothing is said
//   {slot:type=it}     the same of a slot of names: a reference
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// What patterns may refer to.
struct PatternContext {
  /// Alternatives of each macro.
  std::map<std::string, std::vector<std::string>> macros;
  /// Entries of each word class with their alternatives.
  std::map<std::string, std::map<std::string, std::vector<std::string>>> classes;
  /// What stands between the names of a list.
  std::vector<std::string> list_separators;
  /// Patterns for references of a name type: type -> word ("here") -> alternatives.
  std::map<std::string, std::map<std::string, std::vector<std::string>>> references;
  /// Macros and word classes that were compiled already; nothing for what must be compiled in
  /// place. Holds for as long as nothing above changes.
  mutable std::map<std::string, std::optional<Automaton>> parts;
  /// Whether names hold a word, too, for as long as the types of names do not change: 1, 0, and -1
  /// for what was not asked yet.
  mutable std::vector<signed char> common_words;
};

/// Why a pattern cannot be compiled; grammar files add their name, line and key.
struct PatternError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// @throws PatternError with the reason. Adds words and values to the grammar.
Automaton compilePattern(const std::string& pattern, const PatternContext& context,
                         CompiledGrammar* grammar);

}  // namespace language
}  // namespace hyselam_topo
