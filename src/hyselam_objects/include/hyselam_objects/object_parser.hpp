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

#include "hyselam_objects/object_map.hpp"
#include "hyselam_topo/topo_parser.hpp"

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
  bool correction = false;
  std::string text;
  std::string reason;  ///< why it was not understood
};

class ObjectParser {
 public:
  /// The shipped grammar of a language: "en". Throws hyselam::InputError for others.
  static ObjectParser shipped(const std::string& language = "en");
  /// From the texts of a grammar and of a list of words; throws hyselam::InputError for text that
  /// is none.
  ObjectParser(const hyselam_topo::GrammarSource& grammar,
               const hyselam_topo::GrammarSource& words);
  ~ObjectParser();
  ObjectParser(ObjectParser&&) noexcept;

  /// Never throws for what a text holds: what is not understood comes back with the reason.
  /// `expected`: intents of answers to a question that was asked.
  std::vector<ObjectStatement> parse(const std::string& text,
                                     const std::set<std::string>& expected = {}) const;
  const hyselam_topo::Grammar& grammar() const;
  /// "cups" is "cup" and `*plural`; words for the same thing become one.
  std::string kindOf(const std::string& noun, bool* plural = nullptr) const;

 private:
  struct Words;
  std::unique_ptr<const Words> words_;
  std::unique_ptr<const hyselam_topo::TopoParser> parser_;
};

}  // namespace hyselam_objects
