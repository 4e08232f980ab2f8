// The words of which names of objects are made.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "hyselam_topo/grammar.hpp"

namespace hyselam_objects {

/// Keys are in lower case.
struct ObjectWords {
  std::string language;
  std::map<std::string, int> numbers;
  std::set<std::string> another;
  /// Word to (property, value): "crimson" to ("colour", "red").
  std::map<std::string, std::pair<std::string, std::string>> properties;
  std::map<std::string, std::string> plurals;
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
