#include "numbered_places.hpp"

#include <algorithm>
#include <utility>

#include "capture.hpp"
#include "clause.hpp"
#include "hyselam_common/numbers.hpp"
#include "matching_costs.hpp"

namespace hyselam_topo {
namespace language {

std::vector<FoundName> NumberedPlaces::find(std::size_t at, const NameType& type) {
  const auto& tokens = words_.tokens;
  std::size_t begin = at;
  if (type.definite.count(tokens[at].folded) != 0 && at + 1 < tokens.size()) ++begin;
  if (words_.matches.empty() || !mayBegin(begin, type)) return {};
  if (!run_) run_.emplace(&words_);
  std::vector<FoundName> found;
  for (const Automaton& pattern : type.numbered) {
    for (const PatternRun::End& end : run_->run(pattern, begin)) {
      const auto path = run_->path(end.at);
      Clause clause;
      if (!path || goesOn(end.at, type) || !capture(pattern, *path, &words_, &clause)) continue;
      FoundName place{end.at, 0, {}, {}};
      place.cost = kNameCost + kNameWordCost * static_cast<int>(end.at - begin) + end.cost;
      place.name.reference = kNumbered;
      for (const Slot& slot : clause.slots) {
        const auto number = hyselam::parseNumber(slot.word);
        if (slot.name == "nth" && number) place.name.number = static_cast<int>(*number);
        if (slot.name == "side") place.name.side = slot.word;
      }
      place.name.range = {tokens[begin].range.begin, tokens[end.at - 1].range.end};
      place.name.text = words_.textOf(place.name.range);
      const bool again = std::any_of(found.begin(), found.end(),
                                     [&](const auto& f) { return f.end == place.end; });
      const bool side = place.name.side == "left" || place.name.side == "right";
      if (!again && side && place.name.number != 0) found.push_back(std::move(place));
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.end < b.end; });
  return found;
}

bool NumberedPlaces::mayBegin(std::size_t at, const NameType& type) const {
  const auto& matches = words_.matches[at];
  return std::any_of(type.numbered.begin(), type.numbered.end(), [&](const Automaton& pattern) {
    const auto& first = pattern.first_words;
    return std::any_of(matches.begin(), matches.end(), [&](const auto& match) {
      return std::binary_search(first.begin(), first.end(), match.word);
    });
  });
}

bool NumberedPlaces::goesOn(std::size_t end, const NameType& type) const {
  return end < words_.tokens.size() && type.joiners.count(words_.tokens[end].folded) != 0;
}

}  // namespace language
}  // namespace hyselam_topo
