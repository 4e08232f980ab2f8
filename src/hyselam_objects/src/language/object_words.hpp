// The words of names of objects.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_objects/language/object_parser.hpp"

namespace hyselam_objects {

/// Keys are in lower case.
struct ObjectWords {
  std::string language;
  std::map<std::string, int> numbers;
  std::set<std::string> another;
  /// Word to (property, value): "crimson" to ("colour", "red").
  std::map<std::string, std::pair<std::string, std::string>> properties;
  std::map<std::string, std::string> property_words;  ///< value of a property to its first word
  bool properties_after = false;   ///< "copo vermelho": they may stand behind the noun, too
  std::set<std::string> definite;  ///< words before a known object: "the"
  std::set<std::string> of;        ///< "bottles of water": the word before it is in the plural
  bool head_first = false;         ///< the first word of a name takes the plural
  std::set<std::string> tops;      ///< kinds that objects lie on where people say "in"
  std::map<std::string, std::string> plurals;
  std::vector<std::pair<std::string, std::string>> plural_endings;  ///< the first that matches
  std::map<std::string, std::string> synonyms;  ///< word to the one that is kept
  std::vector<std::string> nouns;
  std::set<std::string> things;  ///< words of nouns, plurals and synonyms, in lower case
  std::set<std::string> where;   ///< words before the place of a thing: "in"

  /// @throws hyselam::InputError for a text that is no list of words.
  static ObjectWords fromYaml(const hyselam_topo::GrammarSource& source);

  /// The part of a grammar that follows from these words.
  hyselam_topo::GrammarSource grammar() const;

  /// The nouns as they are written: singular, plural, synonyms.
  std::set<std::string> spelled() const;

  /// "cups" is {"cup", true}.
  NounKind singular(const std::string& word) const;
};

/// ASCII letters in lower case.
std::string lowerCase(std::string text);

}  // namespace hyselam_objects
