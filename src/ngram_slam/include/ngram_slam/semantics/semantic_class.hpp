// The kinds of regions that indoor environments are made of (Maffei 2017, 6.2.1).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace ngram_slam {

enum class SemanticClass : std::uint8_t {
  kBifurcation,  ///< three or more passages meet
  kCorner,       ///< a corridor changes its direction abruptly
  kCorridor,     ///< a narrow way between two walls
  kDeadEnd,      ///< a dead end or a small room: one way in
  kHall          ///< a large entrance or room
};

constexpr std::size_t kSemanticClasses = 5;

/// In the order of the enumeration and of the confusion matrices of Fig. 6.9.
constexpr std::array<SemanticClass, kSemanticClasses> kAllSemanticClasses{
    SemanticClass::kBifurcation, SemanticClass::kCorner, SemanticClass::kCorridor,
    SemanticClass::kDeadEnd, SemanticClass::kHall};

constexpr std::size_t indexOf(SemanticClass c) {
  return static_cast<std::size_t>(c);
}

/// "bifurcation", "corner", "corridor", "dead-end", "hall".
inline const char* toString(SemanticClass c) {
  constexpr std::array<const char*, kSemanticClasses> names{"bifurcation", "corner", "corridor",
                                                            "dead-end", "hall"};
  return names[indexOf(c)];
}

/// The class of that name; nothing for any other word.
inline std::optional<SemanticClass> semanticClassFromString(const std::string& name) {
  for (const SemanticClass c : kAllSemanticClasses) {
    if (name == toString(c)) return c;
  }
  return std::nullopt;
}

}  // namespace ngram_slam
