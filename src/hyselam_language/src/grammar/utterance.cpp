#include "hyselam_language/grammar/utterance.hpp"

#include <algorithm>
#include <array>
#include <tuple>

namespace hyselam_topo {

const char* toString(UtteranceKind kind) {
  constexpr std::array<const char*, 5> kNames{"statement", "command", "question", "answer",
                                              "not understood"};
  return kNames.at(static_cast<std::size_t>(kind));
}

const Slot* Utterance::find(const std::string& slot) const {
  const auto found = std::find_if(slots.begin(), slots.end(),
                                  [&slot](const Slot& each) { return each.name == slot; });
  return found == slots.end() ? nullptr : &*found;
}

std::vector<SaidName> Utterance::names(const std::string& slot) const {
  const Slot* found = find(slot);
  return found == nullptr ? std::vector<SaidName>{} : found->names;
}

std::optional<double> Utterance::number(const std::string& slot) const {
  const Slot* found = find(slot);
  return found == nullptr ? std::nullopt : found->number;
}

std::string Utterance::word(const std::string& slot) const {
  const Slot* found = find(slot);
  return found == nullptr ? "" : found->word;
}

bool operator==(const TextRange& a, const TextRange& b) {
  return a.begin == b.begin && a.end == b.end;
}

bool operator==(const SaidName& a, const SaidName& b) {
  const auto all = [](const SaidName& n) {
    return std::tie(n.text, n.reference, n.quoted, n.speaker, n.elliptic);
  };
  return all(a) == all(b);
}

bool operator==(const Slot& a, const Slot& b) {
  return std::tie(a.name, a.type, a.names, a.number, a.unit_assumed, a.word) ==
         std::tie(b.name, b.type, b.names, b.number, b.unit_assumed, b.word);
}

}  // namespace hyselam_topo
