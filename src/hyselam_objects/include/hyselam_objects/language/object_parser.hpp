// TextParser (dos Santos, section 3.2.4): what people say about objects, in the terms of the object
// map. Sentences are parsed by the engine of TopoParser with a grammar of objects; here names such
// as "two small red cups" are analyzed.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_objects/mapping/object_map.hpp"

namespace hyselam_objects {

/// "two small red cups", "the pen", "it".
struct ObjectPhrase {
  std::string kind;  ///< singular: "cup"; "" for a reference
  std::map<std::string, std::string> properties;
  int count = 1;
  bool has_count = false;   ///< with a number, not an article
  bool plural = false;      ///< of the noun
  bool definite = false;    ///< "the pen"; otherwise "a pen", "two pens", "pens"
  bool another = false;     ///< "another pen": none that is known
  bool other = false;       ///< "the other pen": not the one mentioned last
  bool some = false;        ///< "a few pens": no number
  bool one = false;         ///< "the green one": of the kind mentioned last; `kind` is ""
  std::string form;         ///< of "one", where words have forms: "f" of "a vermelha"
  bool known_noun = false;  ///< a word of the list of nouns
  bool bare = false;        ///< without article, number or owner
  bool capital = false;     ///< its first word is written like a person's name: "a Ana"
  /// "it", "them", "one_of_them", "same" (the objects of the statement before); "" for a name.
  std::string reference;
  std::vector<Id> chosen;  ///< objects that are meant: what "which one?" was answered with
  std::string text;        ///< as it was said
};

/// A further relation of a question: "in the box next to the lamp", "between the desk and the
/// door".
struct FurtherRelation {
  RelationWord word = RelationWord::kNear;
  ObjectPhrase landmark;
  bool of_landmark = false;  ///< it tells which landmark is meant, not which object
};

struct ObjectStatement {
  hyselam_topo::UtteranceKind kind = hyselam_topo::UtteranceKind::kNotUnderstood;
  std::string intent;  ///< of the grammar: "exist", "is_at", "is_like", "where_is", ...
  std::vector<ObjectPhrase> objects;  ///< in the order said
  std::optional<RelationWord> relation;
  std::optional<ObjectPhrase> landmark;        ///< what the relation is to
  std::optional<hyselam_topo::SaidName> room;  ///< instead of a landmark: "in front of room 3"
  std::optional<hyselam_topo::SaidName> place;
  std::vector<FurtherRelation> further;  ///< of a question, in the order said
  /// A statement with several relations is several statements: "the cup is on the tray on the
  /// table" tells where the tray is, and then the cup. All but the first continue the one before.
  bool continues = false;
  bool is_landmark = false;  ///< it tells where the landmark of the next statement is
  bool background =
      false;  ///< of a landmark of the statement that follows: "the tray on the table"
  std::map<std::string, std::string> properties;  ///< of "is_like"
  std::map<std::string, std::string> words;       ///< constants of the pattern: {"fetch", "yes"}
  std::string owner;                              ///< of "is_owned"; "speaker": who speaks
  std::optional<int> count;                       ///< of an answer to "how many?"
  bool correction = false;
  bool moved = false;  ///< it tells of a change, so what was known is replaced
  std::string language;
  std::string text;
  std::string reason;       ///< why it was not understood
  std::string reason_code;  ///< of Utterance, or "bare", "two_places"
  std::string suggestion;   ///< not understood: see Utterance
  bool suggests_meaning = false;
  bool suggests_own_words = false;
  std::vector<std::string> alternatives;
  std::vector<std::string> left_out;  ///< words of asides
};

/// "cups" is {"cup", true}.
struct NounKind {
  std::string kind;
  bool plural = false;
};

/// The texts of a grammar and of its list of words.
struct ObjectLanguage {
  hyselam_topo::GrammarSource grammar;
  hyselam_topo::GrammarSource words;
};

class ObjectParser {
 public:
  /// The shipped grammar of a language: "en", "pt"; "": all, each text in the best matching one.
  /// @throws hyselam::InputError for others.
  static ObjectParser shipped(const std::string& language = "");
  /// @throws hyselam::InputError for a text that is no grammar or list of words.
  explicit ObjectParser(const std::vector<ObjectLanguage>& languages);
  ~ObjectParser();
  ObjectParser(ObjectParser&&) noexcept;

  /// Never throws for the content of a text: a part that is not understood is returned with the
  /// reason. `expected`: intents of answers to a question that was asked; `preferred`: the language
  /// of a text that matches several equally well.
  std::vector<ObjectStatement> parse(const std::string& text,
                                     const std::set<std::string>& expected = {},
                                     const std::string& preferred = "") const;
  /// The first one for a language that is not known, as "".
  const hyselam_topo::Grammar& grammar(const std::string& language = "") const;
  /// The word for a color or size of the map, as it stands beside a noun: "red", "vermelhas".
  std::string propertyWord(const std::string& language, const std::string& value,
                           const std::string& kind = "", bool plural = false) const;
  /// Whether a text that no parser may understand is rather about things than about places: it has
  /// a known noun of a thing, and no kind of place comes before it save as where something is ("in
  /// the kitchen"). "The printer room" is a place.
  bool isAboutThings(const std::string& text) const;
  /// Which forms of words go with a kind: "m", "f" in Portuguese, "vowel" for "an" in English, or
  /// "".
  std::string formOf(const std::string& language, const std::string& kind) const;
  /// Whether a word for a kind has these forms: "a caneca" is kept as "copo".
  bool mayHaveForm(const std::string& language, const std::string& kind,
                   const std::string& form) const;
  /// "cups".
  std::string pluralOf(const std::string& language, const std::string& kind) const;
  /// The word for a small number: "two", "duas"; digits for others.
  std::string numberWord(const std::string& language, int number, const std::string& form) const;
  /// Whether two kinds are one, in whichever language each was said: "bottle" and "garrafa".
  bool isSameKind(const std::string& a, const std::string& b) const;
  /// What a kind is called in a language: "garrafa" for "bottle"; as it was said if no word is
  /// known.
  std::string kindIn(const std::string& language, const std::string& kind) const;
  /// "milk", "scissors": no article and number stand before it.
  bool isUncounted(const std::string& language, const std::string& kind) const;
  bool isAlwaysPlural(const std::string& language, const std::string& kind) const;
  /// Whether colors and sizes stand behind the noun.
  bool propertiesAfter(const std::string& language) const;
  /// A part of the building that things stand at, as a wall.
  bool isStructure(const std::string& kind) const;
  /// A thing that others lie on: what it "has" is on it.
  bool isTop(const std::string& kind) const;
  /// Kind and number of a noun of the first language; synonyms give the same kind.
  NounKind kindOf(const std::string& noun) const;

 private:
  struct Words;
  /// `shipped`: kinds of places are those of the shipped grammars of places as well.
  ObjectParser(const std::vector<ObjectLanguage>& languages, bool shipped);
  std::size_t indexOf(const std::string& language) const;
  std::string englishOf(const std::string& kind) const;

  std::vector<std::unique_ptr<const Words>> words_;  ///< in the order of the grammars
  std::unique_ptr<const hyselam_topo::TopoParser> parser_;
};

}  // namespace hyselam_objects
