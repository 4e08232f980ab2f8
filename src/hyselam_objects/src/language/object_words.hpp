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
  /// "a couple", "half a dozen" to their number; 0: none is told ("a few"), -1: all there are.
  std::map<std::string, int> quantities;
  std::set<std::string> another;
  std::set<std::string> one_words;  ///< "the green one"
  /// Word to (property, value): "crimson" to ("colour", "red").
  std::map<std::string, std::pair<std::string, std::string>> properties;
  /// Value of a property to its words: "red", or "vermelho, vermelha, vermelhos, vermelhas".
  std::map<std::string, std::vector<std::string>> property_words;
  bool properties_after = false;   ///< "copo vermelho": they may stand behind the noun, too
  std::set<std::string> definite;  ///< words before a known object: "the"
  std::set<std::string> articles;  ///< all that may stand before a thing
  std::set<std::string> of;        ///< "bottles of water": the word before it is in the plural
  bool head_first = false;         ///< the first word of a name takes the plural
  std::set<std::string> tops;      ///< kinds that objects lie on where people say "in"
  std::set<std::string> hollows;   ///< kinds that objects lie in where people say "to"
  std::map<std::string, std::string> plurals;
  std::vector<std::pair<std::string, std::string>> plural_endings;  ///< the first that matches
  std::map<std::string, std::string> synonyms;  ///< word to the one that is kept
  /// Kind to the one of the English list that is the same: "garrafa" to "bottle".
  std::map<std::string, std::string> english;
  std::map<std::string, std::string> of_english;  ///< and back; of several the first
  std::vector<std::string> nouns;
  std::set<std::string> things;  ///< words of nouns, plurals and synonyms
  std::set<std::string> where;   ///< words before the place of a thing: "in"
  std::set<std::string> mass;    ///< nouns without article and number: "milk"
  std::set<std::string> always_plural;
  std::set<std::string> place_kinds;  ///< kinds of places: "changing room"
  std::set<std::string> nowhere;      ///< what things are said to be in that is no place: "mess"
  std::set<std::string> places_too;   ///< kinds of places that may as well be things: "shower"
  std::set<std::string> structure;    ///< parts of a building that things stand at: "wall"
  /// Words that name no thing, with the code of the reason: {"boy", "person"}.
  std::map<std::string, std::string> no_things;
  /// What a noun ends with to the forms of words that go with it: {"a", "f"}; the longest counts.
  std::map<std::string, std::string> form_endings;
  std::map<std::string, std::string> forms;         ///< of single nouns: {"mão", "f"}
  std::map<std::string, std::string> number_forms;  ///< {"2 f", "duas"}

  /// @throws hyselam::InputError for a text that is no list of words.
  static ObjectWords fromYaml(const hyselam_topo::GrammarSource& source);

  /// Kinds of places, of the grammar of places of the same language: none of them names a thing.
  /// @throws hyselam::InputError for a text that is no grammar.
  void addPlaces(const hyselam_topo::GrammarSource& grammar);

  /// The part of a grammar that follows from these words.
  hyselam_topo::GrammarSource grammar() const;

  /// "cups" is {"cup", true}.
  NounKind singular(const std::string& word) const;
  /// The same of a whole name: "bottles of water".
  NounKind kindOf(const std::string& noun) const;
  std::string pluralOf(const std::string& kind) const;
  std::string formOf(const std::string& kind) const;
  /// Which nouns an article, "meu" or "outra" goes with: "m" or "f"; "" where they have no forms.
  std::string articleForm(const std::string& word) const;
  bool isNoun(const std::string& kind) const;
  /// The word of a name that tells what it is.
  std::string headOf(const std::string& kind) const;
  /// "twenty-one"; 0: no number.
  int numberOf(const std::string& word) const;

 private:
  std::size_t headAt(const std::vector<std::string>& words) const;
  void index();
};

/// Letters in lower case, those with accents too.
std::string lowerCase(const std::string& text);
std::vector<std::string> splitWords(const std::string& text);

}  // namespace hyselam_objects
