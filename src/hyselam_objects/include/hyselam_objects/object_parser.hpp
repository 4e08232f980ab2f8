// TextParser (dos Santos, section 3.2.4): what people say of objects, in the terms of the object
// map. The sentences are read by the engine of TopoParser with a grammar of objects; here names
// such as "two small red cups" are taken apart.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_objects/object_map.hpp"

namespace hyselam_objects {

/// "two small red cups", "the pen", "it".
struct ObjectPhrase {
  std::string kind;  ///< singular: "cup"; "" for a reference
  std::map<std::string, std::string> properties;
  int count = 1;
  bool count_said = false;  ///< a number, not an article
  bool plural = false;      ///< the noun
  bool definite = false;    ///< "the pen"; otherwise "a pen", "two pens", "pens"
  bool another = false;     ///< "another pen": none that is known
  std::string reference;    ///< "it", "them"; "" for a name
  std::string text;         ///< as it was said
};

struct ObjectStatement {
  hyselam_topo::UtteranceKind kind = hyselam_topo::UtteranceKind::kNotUnderstood;
  std::string intent;  ///< of the grammar: "exist", "is_at", "is_like", "where_is", ...
  std::vector<ObjectPhrase> objects;  ///< in the order said
  std::optional<RelationWord> relation;
  std::optional<ObjectPhrase> landmark;  ///< what the relation is to
  std::optional<hyselam_topo::SaidName> place;
  std::map<std::string, std::string> properties;  ///< of "is_like"
  std::optional<int> count;                       ///< of an answer to "how many?"
  bool correction = false;
  std::string language;
  std::string text;
  std::string reason;  ///< why it was not understood
};

/// The texts of a grammar and of its list of words.
struct ObjectLanguage {
  hyselam_topo::GrammarSource grammar;
  hyselam_topo::GrammarSource words;
};

class ObjectParser {
 public:
  /// The shipped grammar of a language: "en", "pt"; "": all, each text in the one that fits best.
  /// Throws hyselam::InputError for others.
  static ObjectParser shipped(const std::string& language = "");
  /// Throws hyselam::InputError for text that is none.
  explicit ObjectParser(const std::vector<ObjectLanguage>& languages);
  ~ObjectParser();
  ObjectParser(ObjectParser&&) noexcept;

  /// Never throws for what a text holds: what is not understood comes back with the reason.
  /// `expected`: intents of answers to a question that was asked; `preferred`: the language of what
  /// fits several equally well.
  std::vector<ObjectStatement> parse(const std::string& text,
                                     const std::set<std::string>& expected = {},
                                     const std::string& preferred = "") const;
  /// The first one for a language that is not known, as "".
  const hyselam_topo::Grammar& grammar(const std::string& language = "") const;
  /// The word for a colour or size of the map: "red", "vermelho".
  std::string propertyIn(const std::string& language, const std::string& value) const;
  /// In the first language: "cups" is "cup" and `*plural`; words for the same thing become one.
  std::string kindOf(const std::string& noun, bool* plural = nullptr) const;

 private:
  struct Words;
  std::size_t indexOf(const std::string& language) const;

  std::vector<std::unique_ptr<const Words>> words_;  ///< in the order of the grammars
  std::unique_ptr<const hyselam_topo::TopoParser> parser_;
};

}  // namespace hyselam_objects
