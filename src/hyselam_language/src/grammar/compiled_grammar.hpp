// A grammar as the matcher uses it.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "automaton.hpp"
#include "example_sentences.hpp"
#include "hyselam_language/grammar/utterance.hpp"
#include "pattern_index.hpp"
#include "slip_index.hpp"
#include "tokens.hpp"
#include "urgent_phrases.hpp"

namespace hyselam_topo {
namespace language {

using Words = std::vector<std::string>;
/// Words that are looked up for every token.
using WordSet = std::unordered_set<std::string>;
using WordMeanings = std::unordered_map<std::string, std::string>;
/// Numbers of words of the vocabulary, one after another.
using Phrase = std::vector<int>;

/// All words of patterns, numbered; those long enough may be misspelt.
class Vocabulary {
 public:
  int add(const std::string& word);
  struct Match {
    int word = 0;
    int cost = 0;
  };
  /// The words that a token may stand for; `may_be_misspelt`: look for those one slip away.
  std::vector<Match> matches(const Token& token, bool may_be_misspelt) const;
  const std::string& text(int word) const { return entries_[static_cast<std::size_t>(word)].lower; }
  std::size_t size() const { return entries_.size(); }
  bool contains(const std::string& folded_word) const { return by_folded_.count(folded_word) != 0; }

 private:
  struct Entry {
    std::string lower;
    std::string folded;
  };
  std::vector<Entry> entries_;
  std::unordered_map<std::string, int> by_lower_;
  std::unordered_multimap<std::string, int> by_folded_;
  SlipIndex slips_;  ///< of those that may be misspelt
};

/// The phrases of a list by their first words.
class PhraseStarts {
 public:
  PhraseStarts() = default;
  explicit PhraseStarts(const std::vector<Phrase>& phrases);
  /// The numbers of those that begin with one of the words, ascending.
  std::vector<std::size_t> beginningWith(const std::vector<Vocabulary::Match>& words) const;

 private:
  std::vector<std::vector<std::size_t>> of_word_;
};

/// Phrases in small letters by their first words.
class WordPhrases {
 public:
  void add(const Words& phrase) { of_first_[phrase.front()].push_back(phrase); }
  /// Whether one of them stands at a token, before `end`.
  bool standAt(const std::vector<Token>& tokens, std::size_t at, std::size_t end) const;

 private:
  std::unordered_map<std::string, std::vector<Words>> of_first_;
};

/// What may be a name (of places, of objects, ...). Sets hold folded words.
struct NameType {
  std::string name;
  WordSet definite;
  WordSet indefinite;
  WordSet joiners;              ///< behind them an article may stand: "of the"
  WordSet stop;                 ///< never within a name
  bool of_speaker = false;      ///< all are the speaker's, without a word for it
  WordSet speaker;              ///< before what is the speaker's: "my"
  WordSet elliptic_suffix;      ///< "Mary's": the noun was said before
  WordSet elliptic_prefix;      ///< "o da Teresa": the same
  WordSet elliptic_after;       ///< what may stand before it: "ao", or an article
  WordSet elliptic_nouns;       ///< "the big one": the noun was said before
  WordSet elliptic_adjectives;  ///< may stand for a name with the noun of before
  WordSet speaker_alone;        ///< "mine": the speaker's of what was said before
  WordSet range_words;          ///< "rooms 101 to 106"
  WordSet generic;              ///< no name on their own: "room"
  WordSet heads;                ///< kinds of places, no name alone: "area"
  WordSet quantities;           ///< no name begins so: "several"
  WordMeanings forbidden;       ///< word -> code of the reason
  WordMeanings nouns;           ///< phrase -> kind: "dining hall" -> "room"
  WordMeanings titles;          ///< "lab" -> "lab", "laboratory" -> "lab"
  WordMeanings kinds;           ///< name -> what all languages call alike
  WordMeanings plurals;         ///< "rooms 1 and 2" are "room 1" and "room 2"
  WordSet between;              ///< words between the codes of such a row: "and"
  WordSet parts;                ///< "door": a door of a place is no place
  WordSet part_joiners;         ///< "of": what a part and its place stand around
  WordSet feminine;             ///< nouns with the second article when generating
  SlipIndex stop_slips;         ///< of the words of `stop`
  WordSet noun_beginnings;      ///< the first words of the nouns
  bool head_first = false;      ///< the first noun tells the kind, not the last
  bool needs_noun = false;
  bool only_elliptic = false;  ///< "Joe's", "da Ana": an owner's, without the noun
  bool silent = false;         ///< that words are no such name is no reason for a refusal
  bool indefinite_needs_noun = false;
  std::size_t max_words = 8;

  bool isArticle(const std::string& word) const {
    return definite.count(word) != 0 || indefinite.count(word) != 0;
  }
};

struct Unit {
  double factor = 1.0;
  std::vector<Phrase> phrases;
};

struct Quantity {
  std::string name;
  double default_factor = 0.0;  ///< 0: a unit must be said
  std::vector<Unit> units;
};

struct IntentInfo {
  std::string name;
  UtteranceKind kind = UtteranceKind::kStatement;
  std::string refuse;            ///< code of the reason; "" for what is understood
  bool only_expected = false;    ///< tried only when asked for
  int cost = 0;                  ///< more than other intents, where two fit equally well
  bool only_correction = false;  ///< tried only behind a word like "sorry": "..., on the right"
  std::string as;                ///< the utterance gets this intent; "": its own name
  bool corrects_next = false;    ///< "no.": the next statement is a correction
  std::vector<std::string> examples;
  std::vector<Automaton> patterns;
};

/// "On the left", "on the other side", "across from it", "coming back".
struct TourWords {
  WordSet left, right, side, other, same, across, back;
  WordSet order;  ///< "after", "before", "past", ...
  WordSet and_;   ///< between clauses
};

struct CompiledGrammar {
  std::string language;
  std::string title;
  Vocabulary vocabulary;
  WordSet known_words;  ///< folded words that are never misspelt keywords
  std::vector<Phrase> fillers_before, fillers_after, corrections, clause_separators;
  PhraseStarts before_starts, after_starts, correction_starts, separator_starts;  ///< of these
  std::set<int> fillers_inner;
  /// Folded words of list separators that tell an order: "then".
  WordSet order_words;
  /// As said: behind these no list of a statement goes on ("logo a seguir à copa" is a relation).
  WordSet list_ends;
  /// Folded: "se" is no condition behind one of the second, as in "onde se guarda a roupa".
  WordSet reflexive, reflexive_after;
  /// Folded: "here"; "this", where one of the third stands behind it: "door".
  WordSet here_words, pointing_words, pointed_words;
  /// How somebody who shows the robot round speaks of the sides of a corridor (folded words).
  TourWords tour_words;
  /// Those before and after that have two words or more, by their first word.
  std::unordered_map<std::string, std::vector<Phrase>> long_fillers;
  /// Around a statement that ends with a question mark: "can you note that", "ok"; the longest
  /// first.
  std::vector<Words> told_before, told_after;
  /// Parts between commas that begin so say nothing of now: "which used to be".
  WordPhrases past_asides;
  /// ... and those that begin so change nothing told, though they deny: "you can't miss it".
  WordPhrases idle_asides;
  /// A clause may begin so where nothing separates it from the one before ("its", "there is"), not
  /// behind one of the second ("that", "because").
  WordPhrases clause_starts;
  WordSet no_clause_after;
  /// Folded: asides that begin so stand behind commas only ("with a door").
  WordSet only_behind_comma;
  /// Folded: what is denied of these is what follows them: "nobody says", "it is not true".
  WordSet saying_words;
  /// Folded: with a denial what is told is doubted, unless one of the second follows.
  WordSet doubt_words, asking_words;
  WordSet abbreviations;
  /// Words that mean something else in small letters, as they are written: "IT".
  WordSet acronyms;
  /// Ends of nouns of places that may be a verb: "'s" in "the library's on the left" is "is".
  std::map<std::string, std::string> contracted_verbs;
  /// Written without an apostrophe: "its" is "it is" before one of the second.
  std::map<std::string, Words> loose_contractions;
  WordPhrases loose_before;
  /// Phrases that are read as others: "last but one" as "penultimate".
  std::vector<std::pair<Words, Words>> same_words;
  std::unordered_map<std::string, Words> contractions;
  std::unordered_map<std::string, std::pair<double, bool>>
      number_words;  ///< value, is a multiple of ten
  WordSet number_joiners;
  std::vector<Phrase> halves;
  WordSet unit_words;
  std::vector<Quantity> quantities;
  std::vector<NameType> name_types;
  std::vector<IntentInfo> intents;
  PatternIndex index;               ///< of the patterns of all intents
  ExampleSentences examples;        ///< of all intents
  std::vector<std::string> values;  ///< entries of word classes
  UrgentPhrases urgent;
  WordMeanings refusing_words;
  WordSet placing_words;  ///< folded: tell where something is, or how large
  WordSet telling_words;  ///< folded: a part of a sentence with one is no aside
  std::map<std::string, std::string> reasons;
  std::map<std::string, std::string> say;

  const NameType* nameType(const std::string& name) const;
  /// Whether the folded word is a noun of any kind of names ...
  bool isNoun(const std::string& word) const;
  /// ... or a title before their codes: "room".
  bool isNounOrTitle(const std::string& word) const;
  TokenRules tokenRules() const;
  /// The reason of a code, with {word} put in.
  std::string reason(const std::string& code, const std::string& word = "") const;
};

/// Whether a phrase in small letters stands at a token.
bool standsAt(const Words& phrase, const std::vector<Token>& tokens, std::size_t at);

}  // namespace language
}  // namespace hyselam_topo
