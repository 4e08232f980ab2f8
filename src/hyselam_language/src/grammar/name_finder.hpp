// Which words of a sentence may be a name: a run of words that mean nothing else, without article,
// or a quotation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// A name that begins at some token.
struct FoundName {
  std::size_t end = 0;  ///< the token behind it
  int cost = 0;
  SaidName name;
  std::vector<SaidName> more;  ///< behind it: those of "rooms 101 to 106"
};

/// Why words are no name.
struct NameFailure {
  std::size_t at = 0;  ///< token
  std::string code;
  std::size_t end = 0;  ///< behind the last token
};

class NameFinder {
 public:
  NameFinder(const CompiledGrammar& grammar, const std::string& text,
             const std::vector<Token>& tokens);

  /// All names of a type that begin at token `at`, the shortest first.
  const std::vector<FoundName>& namesAt(std::size_t at, std::size_t type);
  /// The reasons met so far.
  const std::vector<NameFailure>& failures() const { return failures_; }

 private:
  struct Cached {
    bool known = false;
    std::vector<FoundName> names;
  };
  std::vector<FoundName> find(std::size_t at, const NameType& type);
  /// "rooms 1, 2 and 3": the end of the code at a token, 0 for none.
  std::size_t codeEnd(std::size_t at) const;
  /// "room", if the code at a token belongs to such a row; "" otherwise.
  std::string titleOfRow(std::size_t at, const NameType& type) const;
  std::optional<FoundName> inRow(std::size_t at, const NameType& type) const;
  /// "101 to 106": the rest of it behind the first code; does nothing for what is no such range.
  void addRange(const NameType& type, const std::string& title, FoundName* first) const;
  /// Of digits or of a word.
  std::optional<int> numberAt(std::size_t at) const;
  /// "rooms one to four", "dressing rooms 1 to 4", without the article.
  std::optional<FoundName> rangeInWords(std::size_t begin, const NameType& type) const;
  /// "Mary's", "da Teresa": the noun that was said before it in the sentence: "office"; "" for
  /// none.
  std::string nounBefore(std::size_t at, const NameType& type) const;
  std::string titleOfNumber(std::size_t begin, std::size_t end, const NameType& type) const;
  bool isOwnersAlone(std::size_t begin, const NameType& type) const;
  bool isElliptic(std::size_t begin, std::size_t end, const NameType& type) const;
  /// The bytes of an apostrophe behind a plural, "the boys'": 0 without one.
  std::size_t apostropheBehind(std::size_t at, const NameType& type) const;
  bool isPossessive(std::size_t at, const NameType& type) const;
  /// Whether no name goes on with this token.
  bool endsHere(std::size_t at, const NameType& type) const;
  bool tellsWhich(std::size_t begin, std::size_t end, const NameType& type) const;
  /// "mine", "the big one", "a grande": names whose noun was said before; `begin` is behind an
  /// article.
  std::optional<FoundName> withoutNoun(std::size_t at, std::size_t begin,
                                       const NameType& type) const;
  void complete(std::size_t begin, std::size_t end, const NameType& type, SaidName* name) const;
  /// "the door of the kitchen", "the kitchen door".
  bool isPart(std::size_t begin, std::size_t end, const NameType& type) const;
  /// "room i 110": a letter that is a word elsewhere.
  bool isNumberOfTitle(std::size_t at, const NameType& type) const;
  bool isLetterOfTitle(std::size_t begin, std::size_t at, const NameType& type) const;
  bool mayBeArticle(std::size_t at, const NameType& type) const;
  bool refuses(const Token& token) const;
  bool isCompassOfName(std::size_t begin, std::size_t at, const NameType& type) const;
  bool isSpeakers(std::size_t at, const NameType& type) const;
  bool beginsWithArticle(std::size_t begin, std::size_t at, const NameType& type) const;
  /// "" if tokens [begin, end) are a name.
  std::string whatIsWrong(std::size_t begin, std::size_t end, bool indefinite,
                          const NameType& type);
  bool beginsWithNoun(std::size_t begin, std::size_t end, const NameType& type) const;
  bool endsWithNoun(std::size_t begin, std::size_t end, const NameType& type) const;
  bool hasNoun(std::size_t begin, std::size_t end, const NameType& type) const;
  bool mayBeMisspelt(std::size_t at, const NameType& type) const;
  /// Whether it is a noun of places, or begins one: "living".
  bool isCommonNoun(const std::string& word) const;
  SaidName nameOf(std::size_t begin, std::size_t end) const;

  const CompiledGrammar& grammar_;
  const std::string& text_;
  const std::vector<Token>& tokens_;
  std::vector<Cached> cache_;
  std::vector<NameFailure> failures_;
};

}  // namespace language
}  // namespace hyselam_topo
