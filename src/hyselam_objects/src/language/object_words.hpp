// The words of which names of objects are made.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_objects {

/// Keys are in lower case.
struct ObjectWords {
  std::string language;
  std::map<std::string, int> numbers;
  std::set<std::string> another;
  /// Word to (property, value): "crimson" to ("colour", "red").
  std::map<std::string, std::pair<std::string, std::string>> properties;
  std::map<std::string, std::string> said;  ///< the first word for each value of a property
  bool properties_after = false;            ///< "copo vermelho": they stand behind the noun, too
  std::set<std::string> definite;           ///< words before what is known: "the"
  std::set<std::string> of;                 ///< "bottles of water": the plural is before it
  bool head_first = false;                  ///< the first word of a name is made plural
  std::set<std::string> tops;  ///< kinds that things lie on where it is said that they are in
  std::map<std::string, std::string> plurals;
  std::vector<std::pair<std::string, std::string>> plural_endings;  ///< the first that fits
  std::map<std::string, std::string> same;  ///< word to the one that is kept
  std::vector<std::string> nouns;

  /// Throws hyselam::InputError for text that is no list of words.
  static ObjectWords fromYaml(const hyselam_topo::GrammarSource& source);

  /// The part of a grammar that follows from these words.
  hyselam_topo::GrammarSource grammar() const;

  /// "cups" is "cup" and `*plural`.
  std::string singular(const std::string& word, bool* plural) const;
};

/// ASCII letters in lower case.
std::string lowerCase(std::string text);

}  // namespace hyselam_objects
