// The robot's sentences, as data: one file per language with texts whose words in braces are filled
// in. The files are share/hyselam_topo/dialogue/*.yaml; the library carries the shipped ones.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_language/building/described_building.hpp"

namespace hyselam_topo {

class Phrases {
 public:
  using Values = std::vector<std::pair<std::string, std::string>>;

  /// Throws hyselam::InputError, naming source, key and reason, for text that is no YAML, missing
  /// or unknown keys, and unknown words in braces.
  static Phrases fromYaml(const std::string& source, const std::string& yaml);
  static Phrases load(const std::string& path);
  /// "en" or "pt"; throws hyselam::InputError for other languages.
  static Phrases shipped(const std::string& language);
  static std::vector<std::string> shippedLanguages();

  const std::string& language() const { return language_; }

  /// The text with its words in braces filled in; a preposition before one grows together with its
  /// article ("de" and "a cozinha"). Throws std::out_of_range for an unknown key.
  std::string say(const std::string& key, const Values& values = {}) const;
  /// "A", "A and B", "A, B and C".
  std::string list(const std::vector<std::string>& items) const;
  /// With the language's decimal point.
  std::string number(double value, int decimals) const;
  const std::string& side(Side side) const;      ///< of the four sides
  const std::string& wall(WallKind kind) const;  ///< glass or virtual

 private:
  Phrases() = default;

  void append(const std::string& value, std::string* out) const;

  std::string language_;
  std::string decimal_point_, comma_, and_;
  std::map<std::string, std::string> sides_, walls_, phrases_;
  std::map<std::string, std::string> contractions_;  ///< "de a": "da"
};

}  // namespace hyselam_topo
