#include "here_words.hpp"

#include <algorithm>
#include <set>
#include <string>

namespace hyselam_topo {
namespace language {
namespace {

/// So many words may stand between "here", "this door" and the side.
constexpr std::size_t kNear = 4;

}  // namespace

bool isToldHere(const Clause& clause, std::size_t from, const SentenceWords& words) {
  const auto side = std::find_if(clause.slots.begin(), clause.slots.end(),
                                 [](const Slot& slot) { return slot.name == "side"; });
  if (side == clause.slots.end() || (side->word != "left" && side->word != "right")) return false;
  const auto& tokens = words.tokens;
  std::size_t begin = clause.begin, end = clause.end;
  while (begin < clause.end && tokens[begin].range.begin < side->range.begin) ++begin;
  while (end > begin && tokens[end - 1].range.end > side->range.end) --end;
  const auto isIn = [&](std::size_t at, const WordSet& all) {
    return all.count(tokens[at].folded) != 0;
  };
  for (std::size_t at = begin; at < end; ++at) {
    if (isIn(at, words.grammar.here_words)) return true;  // left out before the side's own words
  }
  // What stands before it, up to a name.
  bool door = false;
  for (std::size_t at = begin; at > from && at + kNear > begin;) {
    --at;
    const TextRange range = tokens[at].range;
    const bool named = std::any_of(clause.slots.begin(), clause.slots.end(), [&](const Slot& slot) {
      return !slot.names.empty() && range.begin >= slot.range.begin && range.end <= slot.range.end;
    });
    if (named) break;
    if (isIn(at, words.grammar.here_words)) return true;
    if (door && isIn(at, words.grammar.pointing_words)) return true;
    door = door || isIn(at, words.grammar.pointed_words);
  }
  // "On the left, right here": what stands behind it, over commas and one word.
  std::size_t passed = 0;
  for (; end < tokens.size() && passed < 2; ++end) {
    if (isIn(end, words.grammar.here_words)) return end < clause.end || passed == 0;
    passed += words.isComma(end) ? 0 : 1;
  }
  return false;
}

}  // namespace language
}  // namespace hyselam_topo
