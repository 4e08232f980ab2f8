// What somebody has said, sentence by sentence: statements about the building, commands, questions,
// answers, and what was not understood, with the reason.
//
// Plain values. Numbers are in SI units, texts are UTF-8, ranges count bytes of the text parsed.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hyselam_topo {

/// Bytes [begin, end) of the text.
struct TextRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

enum class UtteranceKind { kStatement, kCommand, kQuestion, kAnswer, kNotUnderstood };

/// "statement", "command", "question", "answer", "not understood".
const char* toString(UtteranceKind kind);

/// A name as it was said, without article and quotes, spaces made single: "room I-109".
struct SaidName {
  std::string text;
  /// Instead of a name: the word of the grammar for "this place" ("here") or "it" ("it"); "" for a
  /// name.
  std::string reference;
  bool quoted = false;
  /// "my office": the person's who speaks; `text` is without "my".
  bool speaker = false;
  /// "Mary's", "o da Teresa": what kind of place it is was said before; `text` lacks that word.
  bool elliptic = false;
  /// Of a list: told to come behind the name before it ("then", "followed by").
  bool follows = false;
  TextRange range;
};

/// One thing that a pattern of the grammar captures.
struct Slot {
  std::string name;              ///< as in the pattern: {places:place+} has the name "places"
  std::string type;              ///< "place", "length", "count", or the word class: "side"
  std::vector<SaidName> names;   ///< of names: one, or those of a list in their order
  std::optional<double> number;  ///< of numbers and quantities, in SI units
  bool unit_assumed = false;     ///< no unit was said with the number
  std::string word;              ///< of word classes: the entry, e.g. "left"
  TextRange range;
};

/// A word that was taken for another one.
struct Spelling {
  std::string said;
  std::string taken_as;
};

/// A sentence or a part of one that stands for itself.
struct Utterance {
  UtteranceKind kind = UtteranceKind::kNotUnderstood;
  std::string intent;       ///< name in the grammar: "neighbours", "go_to"; "" not understood
  std::vector<Slot> slots;  ///< in the order said
  bool correction = false;  ///< "no, ...", "sorry, ...": replaces what was said before
  std::vector<Spelling> spelling;
  std::string text;  ///< what was said
  TextRange range;   ///< where it stands
  /// Not understood: why, as a sentence for people, and its code in the grammar or one of
  /// "no_pattern", "no_name", "ambiguous", "too_long", "question".
  std::string reason;
  std::string reason_code;
  TextRange culprit;  ///< the words that could not be understood
  /// Not understood: a sentence in the same language that is understood; "" if none was found.
  std::string suggestion;
  /// Whether the suggestion is what was said without some of its words, which the person should
  /// confirm; otherwise it is an example of how such things are said.
  bool suggests_meaning = false;
  /// Whether an example is of what the person named.
  bool suggests_own_words = false;
  /// What else may have been meant if it is not that, likeliest first.
  std::vector<std::string> alternatives;
  /// Understood: words left out, as an aside between commas ("which is far too small"); refused:
  /// those that `suggestion` does without, if they stand together.
  std::vector<std::string> left_out;
  /// Understood: what it says without words left out that may matter. The person should be asked
  /// whether that is meant before it is taken down; "" if nothing need be asked.
  std::string to_confirm;

  bool understood() const { return kind != UtteranceKind::kNotUnderstood; }
  /// nullptr if the slot was not filled.
  const Slot* find(const std::string& slot) const;
  /// The names of a slot; empty if it was not filled.
  std::vector<SaidName> names(const std::string& slot) const;
  std::optional<double> number(const std::string& slot) const;
  /// "" if the slot was not filled.
  std::string word(const std::string& slot) const;
};

bool operator==(const TextRange& a, const TextRange& b);
/// The same meaning: text, reference and quotes, not where it stood.
bool operator==(const SaidName& a, const SaidName& b);
bool operator==(const Slot& a, const Slot& b);

}  // namespace hyselam_topo
