// Sentences of a grammar's section `say` with values put in: articles, contractions, plurals.
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {

/// What stands in a sentence instead of a "{key}".
struct SaidValue {
  std::string key;
  std::string text;
  bool plural = false;   ///< "{is|are}" behind it becomes "are"
  bool is_name = false;  ///< begins with a name, which keeps its small letter
};

class SentenceWriter {
 public:
  /// `capitals`: whether sentences begin with one.
  explicit SentenceWriter(const Grammar& grammar, bool capitals = true)
      : grammar_(grammar), capitals_(capitals) {}

  /// The template of a key with its values. A preposition before a value grows together with its
  /// article where `say` has both ("de o": "do "). "{is|are}" follows the value before it, or the
  /// first one behind it. Begins with a capital, unless with a name.
  std::string sentence(const std::string& key, const std::vector<SaidValue>& values) const;
  /// The same without a capital.
  std::string phrase(const std::string& key, const std::vector<SaidValue>& values) const;

  /// The name, between quotation marks if it needs them; throws hyselam::InputError if it holds all
  /// kinds of them.
  std::string quoted(const std::string& name) const;
  /// A name with an article if it is a common noun; `another`: a second one of that name.
  SaidValue named(const std::string& key, const std::string& name, bool another = false) const;
  /// A place by its name, with an article if it is a common noun: "the living room", "another
  /// toilet", but "room A", "I-109".
  SaidValue place(const std::string& key, const DescribedBuilding& building, Id id) const;
  /// "the kitchen, room A and then room B"
  SaidValue list(const std::string& key, const DescribedBuilding& building,
                 const std::vector<Id>& ids) const;

 private:
  std::string filled(const std::string& key, const std::vector<SaidValue>& values,
                     bool* begins_with_name) const;

  Grammar grammar_;
  bool capitals_;
};

}  // namespace hyselam_topo
