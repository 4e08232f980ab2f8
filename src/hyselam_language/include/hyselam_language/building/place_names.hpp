// When two names mean the same place: "room I-110", "I-110" and "i 110" do, "room 5" and "lab 5" do
// not.
//
// Names are compared without case, accents, articles, spaces and signs, possessive s and the
// words that join ("gabinete do Rui" is "gabinete de Rui") and the repetition of a title ("room
// room3"). If they are still different, titles ("room", "lab": word list of the grammar) in front
// of a code (a digit, one or two letters, a number word) may be missing on one side; purely generic
// titles ("room") in front of any name. "Kitchen" and "cozinha" are the same kind of place in two
// languages.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// What is compared of a name.
struct NameKey {
  std::string full;   ///< everything: "roomi110"
  std::string core;   ///< without titles: "i110"
  std::string title;  ///< "room"; "" without one
  /// Of the whole name, the same in all languages: "kitchen" of "cozinha"; "" without one.
  std::string kind;
  std::size_t language = 0;  ///< of the kind: number of the grammar
};

enum class SameName { kNo, kPerhaps, kYes };

/// kYes: equal in full; kPerhaps: equal but for a title that is missing on one side, or the same
/// kind of place in two languages.
SameName compare(const NameKey& a, const NameKey& b);

class PlaceNames {
 public:
  /// The word lists of all the grammars together.
  explicit PlaceNames(std::vector<Grammar> grammars, std::string type = "place");

  NameKey key(const std::string& name) const;
  /// Guessed from words such as "corridor" and "kitchen"; nothing without one.
  std::optional<PlaceKind> kindOf(const std::string& name) const;

  /// Whether a name is clearly one of a place, in any of the languages: its head word is a noun of
  /// places ("printer room", "sala de reuniões", "room Mozart"), it is a code (it holds digits or
  /// ends in a single letter: "I-109", "block B"), or the place of an owner ("Tom's", "gabinete do
  /// Rui").
  bool isOfPlace(const std::string& name) const;
  /// The noun at the head: "meeting room" of "the blue meeting room"; "" without one.
  std::string headOf(const std::string& name) const;
  /// Whether the head tells no more than that it is a room: "room 5", "I-109".
  bool isPlainRoom(const std::string& name) const;
  /// One of several: "meeting room" of "meeting rooms", "casa de banho" of "casas de banho"; the
  /// name itself if it is none of several.
  std::string singular(const std::string& name) const;

  /// For each list of names (of one place each): the index of those that `name` means. One that is
  /// equal in full goes before those that are equal but for a title; several: it is ambiguous.
  std::vector<std::size_t> find(const std::string& name,
                                const std::vector<std::vector<std::string>>& places) const;

 private:
  std::vector<Grammar> grammars_;
  std::string type_;
};

}  // namespace hyselam_topo
