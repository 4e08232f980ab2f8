// How far what was said may be from a pattern. The cheapest reading wins; two readings that cost
// the same and mean different things are ambiguous.
#pragma once

#include <cstddef>

namespace hyselam_topo {
namespace language {

constexpr int kAccentCost = 1;     ///< a keyword without its accents, or with others
constexpr int kSlipCost = 4;       ///< a keyword with one letter wrong
constexpr int kCommaCost = 1;      ///< a comma where the pattern has none
constexpr int kFillerCost = 1;     ///< a word without meaning around a clause
constexpr int kInnerCost = 2;      ///< the same within a clause
constexpr int kNameCost = 4;       ///< a name ...
constexpr int kNameWordCost = 2;   ///< ... and each of its words: keywords rather than names
constexpr int kClauseCost = 6;     ///< a clause: few clauses rather than many
constexpr int kExpectedBonus = 8;  ///< less for an answer that was asked for
constexpr int kSeparatorCost = 1;  ///< a word between clauses
constexpr int kRunOnCost = 4;      ///< nothing between them

// Of a proposal, which leaves out words that no pattern has a place for.
constexpr int kLeaveOutFiller = 1;
constexpr int kLeaveOutWord = 3;
constexpr int kLeaveOutTelling = 12;  ///< a side, a kind of place, a capitalised word
constexpr int kDoubtfulNameCost = 8;  ///< a name without a noun of places, number or capital

constexpr std::size_t kShortestMisspelt = 4;  ///< letters of a keyword that may be misspelt
constexpr std::size_t kShortestRunOn = 6;     ///< tokens of clauses that nothing separates
constexpr std::size_t kLongestRunOn = 60;
constexpr std::size_t kMaxTokens = 400;  ///< of a sentence
constexpr std::size_t kMaxNameBytes = 200;

}  // namespace language
}  // namespace hyselam_topo
