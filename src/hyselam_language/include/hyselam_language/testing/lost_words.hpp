// For tests: words of a text that tell something, change nothing of what was understood, and were
// not told as left out. Found by saying it again without them, from outside of the parser.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "hyselam_language/building/place_names.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"

namespace hyselam_topo {
namespace testing {

/// A word of a text, without the signs around it.
struct TextWord {
  std::size_t begin = 0, end = 0;
  std::string lower;
};

inline std::vector<TextWord> wordsOfText(const std::string& text) {
  const std::string signs = " \t\n.,;:!?()\"";
  std::vector<TextWord> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = text.find_first_not_of(signs, at);
    if (begin == std::string::npos) break;
    at = std::min(text.find_first_of(signs, begin), text.size());
    std::string lower = text.substr(begin, at - begin);
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) {
      return static_cast<char>(c < 128 ? std::tolower(c) : c);
    });
    words.push_back({begin, at, lower});
  }
  return words;
}

inline bool saysTheSame(const ParsedText& a, const ParsedText& b) {
  return a.utterances.size() == b.utterances.size() &&
         std::equal(a.utterances.begin(), a.utterances.end(), b.utterances.begin(),
                    [](const Utterance& x, const Utterance& y) {
                      return x.understood() && y.understood() && x.intent == y.intent &&
                             x.slots == y.slots && x.correction == y.correction;
                    });
}

/// Phrases as "after the fire door", each with the sentence that it was lost in.
inline std::vector<std::string> lostWords(const TopoParser& parser, const std::string& text,
                                          const std::string& language) {
  static const std::set<std::string> kBefore{"through", "past",  "after", "behind", "beyond",
                                             "before",  "via",   "near",  "beside", "opposite",
                                             "beneath", "above", "below", "depois", "antes",
                                             "atrás",   "junto", "perto", "frente"};
  static const std::set<std::string> kDoors{"door",  "doors",  "window", "wall",  "corner",
                                            "porta", "portas", "janela", "canto", "parede"};
  const PlaceNames places(parser.grammars());
  const auto isThing = [&](const std::string& word) {
    const auto kind = places.kindOf(word);
    return kDoors.count(word) != 0 || (kind && *kind != PlaceKind::kCorridor);
  };
  ParseOptions options;
  options.language = language;
  std::vector<std::string> lost;
  for (const Utterance& part : parser.parse(text, options).utterances) {
    if (!part.understood() || part.kind == UtteranceKind::kAnswer) continue;
    const ParsedText alone = parser.parse(part.text, options);
    if (alone.utterances.size() != 1 || alone.misunderstood() != 0) continue;
    const Utterance& said = alone.utterances.front();
    const auto words = wordsOfText(part.text);
    const auto isTaken = [&](const TextWord& word) {
      return std::any_of(said.slots.begin(), said.slots.end(), [&](const Slot& slot) {
        return slot.range.begin < word.end && word.begin < slot.range.end;
      });
    };
    for (std::size_t last = 0; last < words.size(); ++last) {
      if (!isThing(words[last].lower) || isTaken(words[last])) continue;
      bool tells = false;
      for (std::size_t first = last; first-- > 0 && last - first <= 5;) {
        if (isTaken(words[first])) break;
        tells = tells || kBefore.count(words[first].lower) != 0;
        if (!tells) continue;
        const std::string phrase =
            part.text.substr(words[first].begin, words[last].end - words[first].begin);
        const bool told =
            std::any_of(said.left_out.begin(), said.left_out.end(), [&](const std::string& each) {
              return each.find(words[last].lower) != std::string::npos;
            });
        std::string shorter = part.text.substr(0, words[first].begin);
        shorter.erase(shorter.find_last_not_of(" ,") + 1);
        shorter += part.text.substr(words[last].end);
        if (!told && saysTheSame(parser.parse(shorter, options), alone)) {
          lost.push_back("'" + phrase + "' of: " + part.text);
        }
      }
    }
  }
  return lost;
}

}  // namespace testing
}  // namespace hyselam_topo
